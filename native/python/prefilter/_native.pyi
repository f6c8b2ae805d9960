"""The native module. The package around it checks and converts arguments; call that."""

import numpy as np
import numpy.typing as npt

from .arguments import ProgressCallback

class Cancelled(Exception): ...  # noqa: N818

class Surface:
    def __init__(
        self,
        positions: npt.NDArray[np.float64],
        triangles: npt.NDArray[np.int64],
        uvs: npt.NDArray[np.float64],
    ) -> None: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def area(self) -> float: ...

def decode_srgb(image: npt.NDArray[np.float32], threads: int) -> npt.NDArray[np.float32]: ...
def encode_srgb(image: npt.NDArray[np.float32], threads: int) -> npt.NDArray[np.float32]: ...
def covered_share(
    alpha: npt.NDArray[np.float32],
    weights: npt.NDArray[np.float32],
    samples: int,
    threshold: float,
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> float: ...
def mipmaps(
    image: npt.NDArray[np.float32],
    surfaces: list[Surface],
    filter: str,
    wrap: tuple[str, str],
    low: float | None,
    high: float | None,
    levels: int,
    premultiplied: bool,
    reader: str,
    progress: ProgressCallback | None,
    threads: int,
) -> list[npt.NDArray[np.float32]]: ...
def mipmap_error(
    levels: list[npt.NDArray[np.float32]],
    image: npt.NDArray[np.float32],
    surfaces: list[Surface],
    mip_values: list[float],
    wrap: tuple[str, str],
    reader: str,
    progress: ProgressCallback | None,
    threads: int,
) -> list[float]: ...
def texel_weights(
    surfaces: list[Surface],
    width: int,
    height: int,
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float32]: ...
def fill_unused(
    image: npt.NDArray[np.float32],
    surfaces: list[Surface],
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float32]: ...
def lookup_means(
    normals: npt.NDArray[np.float32],
    roughness: npt.NDArray[np.float32],
    wrap: tuple[str, str],
    least_length: float,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float32]: ...
