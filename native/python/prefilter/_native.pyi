# SPDX-License-Identifier: GPL-3.0-or-later

"""The native module. The package around it checks and converts arguments; call that."""

from collections.abc import Sequence
from typing import Any, Final, overload

import numpy as np
import numpy.typing as npt

from ._border.arguments import ProgressCallback
from ._border.names import MipmapFilterName
from .points.reader import PointReader

VERSION: Final[str]

def available_memory() -> float: ...

MACHINE_DIGITS: Final[int]

def random_name() -> str: ...

class Cancelled(Exception): ...  # noqa: N818

class Surface:
    @overload
    def __init__(self, shared: Surface) -> None: ...
    @overload
    def __init__(
        self,
        positions: npt.NDArray[np.float64],
        triangles: npt.NDArray[np.int64],
        uvs: npt.NDArray[np.float64],
        weights: npt.NDArray[np.float64] | None,
        weights_of: str,
    ) -> None: ...
    def placed(self, matrices: npt.NDArray[np.float64]) -> Surface: ...
    def with_areas_of(self, other: Surface) -> Surface | None: ...
    def udim_tile(self, number: int) -> Surface | None: ...
    @property
    def triangle_count(self) -> int: ...
    @property
    def area(self) -> float: ...
    @property
    def positions(self) -> npt.NDArray[np.float64]: ...
    @property
    def triangles(self) -> npt.NDArray[np.int32]: ...
    @property
    def uvs(self) -> npt.NDArray[np.float64]: ...
    @property
    def areas(self) -> npt.NDArray[np.float64]: ...

class NearestPoints:
    def __init__(
        self,
        positions: npt.NDArray[np.floating],
        triangles: npt.NDArray[np.integer],
        progress: ProgressCallback | None,
        threads: int,
    ) -> None: ...
    def find(
        self, points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
    ) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...

class TableShape:
    def __init__(self) -> None: ...
    filter: str
    texels: int
    grid: int
    slices: int
    degree: int
    ramp_weight: float
    spectrum: str
    target: str

class SamplingTable:
    def __init__(self, shape: TableShape, sections: Sequence[tuple[np.ndarray, ...]]) -> None: ...
    @property
    def shape(self) -> TableShape: ...
    def section(
        self, levels: int
    ) -> tuple[
        npt.NDArray[np.int32],
        npt.NDArray[np.float64],
        npt.NDArray[np.float64],
        npt.NDArray[np.float64],
        npt.NDArray[np.float64],
    ]: ...
    def error_ratio(self, levels: int) -> float: ...
    def largest_jump(self, levels: int) -> float: ...

def build_sampling_table(
    shape: TableShape, certify: bool, progress: ProgressCallback | None, threads: int
) -> SamplingTable: ...

class SampleOptions:
    def __init__(self) -> None: ...
    wrap: tuple[str, str]
    threads: int

class AnisotropicOptions:
    def __init__(self) -> None: ...
    wrap: tuple[str, str]
    max_probes: int
    threads: int

class ExactOptions:
    def __init__(self) -> None: ...
    filter: str
    wrap: tuple[str, str]
    threads: int

class EllipticalOptions:
    def __init__(self) -> None: ...
    wrap: tuple[str, str]
    threads: int

class SamplingLevelsOptions:
    def __init__(self) -> None: ...
    filter: str
    wrap: tuple[str, str]
    levels: int
    premultiplied: bool
    threads: int

class ResampleOptions:
    def __init__(self) -> None: ...
    filter: str
    exact: bool
    max_probes: int
    wrap: tuple[str, str]
    premultiplied: bool
    threads: int

def sample(
    levels: Sequence[np.ndarray],
    table: SamplingTable | None,
    coordinates: npt.NDArray[np.float64],
    scales: npt.NDArray[np.float64],
    options: SampleOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...
def sample_exact(
    image: npt.NDArray[np.float32],
    coordinates: npt.NDArray[np.float64],
    scales: npt.NDArray[np.float64],
    options: ExactOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...
def sample_ewa(
    image: npt.NDArray[np.float32],
    coordinates: npt.NDArray[np.float64],
    jacobians: npt.NDArray[np.float64],
    options: EllipticalOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...
def sample_anisotropic(
    levels: Sequence[np.ndarray],
    table: SamplingTable | None,
    coordinates: npt.NDArray[np.float64],
    jacobians: npt.NDArray[np.float64],
    options: AnisotropicOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...
def sample_stochastic(
    levels: Sequence[np.ndarray],
    table: SamplingTable | None,
    bilinear: bool,
    coordinates: npt.NDArray[np.float64],
    scales: npt.NDArray[np.float64],
    numbers: npt.NDArray[np.float64],
    options: SampleOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...
def pick_texels(
    levels: Sequence[np.ndarray],
    table: SamplingTable | None,
    bilinear: bool,
    coordinates: npt.NDArray[np.float64],
    scales: npt.NDArray[np.float64],
    numbers: npt.NDArray[np.float64],
    options: SampleOptions,
    progress: ProgressCallback | None,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]: ...
def resample(
    image: npt.NDArray[np.float32],
    transform: npt.NDArray[np.float64],
    width: int,
    height: int,
    table: SamplingTable | None,
    options: ResampleOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...

class StrokeOptions:
    def __init__(self) -> None: ...
    width: float
    join: str
    cap: str
    miter_limit: float
    dashes: Sequence[float]
    dash_offset: float

class Outline:
    def __init__(self) -> None: ...
    def move_to(self, x: float, y: float) -> None: ...
    def line_to(self, x: float, y: float) -> None: ...
    def curve_to(self, points: npt.NDArray[np.float64]) -> None: ...
    def conic_to(self, x1: float, y1: float, weight: float, x2: float, y2: float) -> None: ...
    def close(self) -> None: ...
    def add_contour(self, points: npt.NDArray[np.float64], degree: int) -> None: ...
    def add_path(self, letters: str, numbers: npt.NDArray[np.float64]) -> None: ...
    def transformed(self, matrix: Sequence[float]) -> Outline: ...
    def pixels(self, fill_rule: str) -> Outline: ...
    def within(self, limit: float) -> Outline: ...
    def copy(self) -> Outline: ...
    def stroked(self, options: StrokeOptions, tolerance: float) -> tuple[Outline, bool]: ...
    def combined(
        self, fill_rule: str, other: Outline, other_rule: str, operation: str
    ) -> Outline: ...
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]] | None: ...
    @property
    def contour_count(self) -> int: ...

class Paint:
    @overload
    def __init__(
        self, constant: Sequence[float], along_x: Sequence[float], along_y: Sequence[float]
    ) -> None: ...
    @overload
    def __init__(
        self,
        is_radial: bool,
        start: tuple[float, float],
        start_radius: float,
        end: tuple[float, float],
        end_radius: float,
        stops: Sequence[tuple[float, Sequence[float]]],
        spread: str,
        matrix: Sequence[float],
    ) -> None: ...
    def transformed(self, matrix: Sequence[float]) -> Paint: ...

class PointSource:
    def __init__(self, reader: PointReader) -> None: ...
    @property
    def count(self) -> int | None: ...
    @property
    def has_normals(self) -> bool: ...
    @property
    def are_normals_directed(self) -> bool: ...
    @property
    def is_double(self) -> bool: ...
    @property
    def attributes(self) -> list[tuple[str, bool]]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def viewpoint(self) -> tuple[float, float, float] | None: ...

class ChosenPoints(PointSource):
    def __init__(
        self,
        source: PointSource,
        box: tuple[list[float], list[float]] | None,
        classes: list[int] | None,
        returns: str,
        name: str,
    ) -> None: ...

class MovedPoints(PointSource):
    def __init__(self, source: PointSource, matrix: npt.NDArray[np.float64]) -> None: ...

def moved(
    points: npt.NDArray[np.float64], matrix: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]: ...

class UnpackedFile:
    def __init__(self, packed: str) -> None: ...
    def write(self, bytes: bytes) -> None: ...

POINT_EXTENSIONS: Final[tuple[str, ...]]
RETURNS: Final[tuple[str, ...]]

def open_points(path: bytes) -> PointSource: ...
def open_ply(file: UnpackedFile) -> PointSource: ...
@overload
def read_range_grid(
    path: bytes, progress: ProgressCallback | None
) -> npt.NDArray[np.int64] | None: ...
@overload
def read_range_grid(
    file: UnpackedFile, progress: ProgressCallback | None
) -> npt.NDArray[np.int64] | None: ...
def read_ply_mesh(
    path: bytes, progress: ProgressCallback | None
) -> tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.int64],
    npt.NDArray[np.int64],
    npt.NDArray[np.float64] | None,
]: ...
@overload
def read_faces(path: bytes, progress: ProgressCallback | None) -> npt.NDArray[np.int64]: ...
@overload
def read_faces(file: UnpackedFile, progress: ProgressCallback | None) -> npt.NDArray[np.int64]: ...
def read_points(
    source: PointSource, most: int, progress: ProgressCallback | None
) -> tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.float32] | None,
    npt.NDArray[np.float32] | None,
    npt.NDArray[np.float64] | None,
    dict[str, npt.NDArray[np.uint8 | np.float32]],
    int,
]: ...
def corner_points(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    origins: npt.NDArray[np.int32],
    source_positions: npt.NDArray[np.floating],
    source_triangles: npt.NDArray[np.integer],
    labels: npt.NDArray[np.int32],
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[
    tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], npt.NDArray[np.float64]],
    npt.NDArray[np.int32],
]: ...
def measure_mesh(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[tuple[list[float], list[float]], float, float]: ...
def self_intersections(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.int64]: ...
def mesh_edges(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]: ...
def mesh_topology(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    welds: bool,
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[int, int, int, int | None, npt.NDArray[np.int32], npt.NDArray[np.int32]]: ...
def nearest_points(
    points: npt.NDArray[np.float64],
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.float64], npt.NDArray[np.float64]]: ...
def triangulate_polygons(
    positions: npt.NDArray[np.floating],
    corners: npt.NDArray[np.int64],
    sizes: npt.NDArray[np.int64],
    progress: ProgressCallback | None,
) -> npt.NDArray[np.int64]: ...
def uv_charts(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    uvs: list[npt.NDArray[np.float32]],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.int32]: ...

class PolygonMesh:
    def __init__(self) -> None: ...
    positions: npt.NDArray[np.float64]
    face_sizes: npt.NDArray[np.int64]
    face_vertices: npt.NDArray[np.int64]
    face_uvs: npt.NDArray[np.float64]
    crease_edges: npt.NDArray[np.int64]
    crease_sharpness: npt.NDArray[np.float64]
    corner_vertices: npt.NDArray[np.int64]
    corner_sharpness: npt.NDArray[np.float64]
    weights: npt.NDArray[np.float64] | None
    weights_of: str
    kept: npt.NDArray[np.bool_] | None

class SubdivisionOptions:
    def __init__(self) -> None: ...
    scheme: str
    boundary: str
    uv_smooth: str
    level: int

def subdivide(
    mesh: PolygonMesh, options: SubdivisionOptions, progress: ProgressCallback | None
) -> Surface: ...
def atan2(y: float, x: float) -> float: ...
def cos(x: float) -> float: ...
def hypot(x: float, y: float) -> float: ...
def powers(values: npt.NDArray[np.float64], exponent: float) -> npt.NDArray[np.float64]: ...
def sin(x: float) -> float: ...
def tan(x: float) -> float: ...
def from_spherical(points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]: ...
def decode_bytes(image: npt.NDArray[np.uint8], threads: int) -> npt.NDArray[np.float32]: ...
def decode_srgb(image: npt.NDArray[np.float32], threads: int) -> npt.NDArray[np.float32]: ...
def encode_srgb(image: npt.NDArray[np.float32], threads: int) -> npt.NDArray[np.float32]: ...
def sampling_levels(
    image: npt.NDArray[np.float32],
    options: SamplingLevelsOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.float32]]: ...
def pixel_filters() -> list[tuple[str, str, float, tuple[str, ...]]]: ...

class ResizeOptions:
    def __init__(self) -> None: ...
    filter: str
    constrained: bool
    ringing: str
    wrap: tuple[str, str]
    premultiplied: bool
    threads: int

def resize_bytes(
    image: npt.NDArray[np.uint8],
    srgb: bool,
    width: int,
    height: int,
    options: ResizeOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.uint8]: ...
def resize(
    image: npt.NDArray[np.float32],
    width: int,
    height: int,
    options: ResizeOptions,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32]: ...
def block_layouts() -> dict[str, tuple[int, int, int, bool]]: ...
def compress_blocks(
    rgba: npt.NDArray[np.uint8] | npt.NDArray[np.uint16],
    format: str,
    srgb: bool,
    weigh_by_alpha: bool,
    effort: str,
    progress: ProgressCallback | None,
    threads: int,
) -> bytes: ...
def supercompress(data: bytes, progress: ProgressCallback | None) -> bytes: ...
def decompress(frames: bytes, count: int) -> bytes: ...
def decode_blocks(
    blocks: bytes,
    format: str,
    srgb: bool,
    width: int,
    height: int,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.uint8] | npt.NDArray[np.uint16]: ...
def compress_etc1s(
    levels: Sequence[npt.NDArray[np.uint8]],
    quality: int,
    has_alpha: bool,
    is_color: bool,
    effort: str,
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[tuple[int, int, bytes, bytes, bytes], list[tuple[bytes, bytes]]]: ...
def decode_etc1s(
    codebooks: tuple[int, int, bytes, bytes, bytes],
    levels: Sequence[tuple[int, int, bytes, bytes]],
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.uint8]]: ...

EXR_TILE_SIDE: int

def exr_tiles(
    level: npt.NDArray[np.float32] | npt.NDArray[np.uint8],
    srgb: bool,
    number: int,
    first_row: int,
    row_count: int,
    half: bool,
    has_alpha: bool,
    multiplies: bool,
    threads: int,
) -> tuple[npt.NDArray[np.uint8], list[int]]: ...
def to_bytes(image: npt.NDArray[np.float32], srgb: bool, threads: int) -> npt.NDArray[np.uint8]: ...

class CoverageOptions:
    def __init__(self) -> None: ...
    threshold: float
    wrap: tuple[str, str]
    premultiplied: bool
    threads: int

def keep_coverage(
    levels: Sequence[npt.NDArray[np.float32]],
    surfaces: Sequence[Surface],
    options: CoverageOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.float32]]: ...
def mipmap_filters() -> list[tuple[MipmapFilterName, bool, bool]]: ...

class MipmapOptions:
    def __init__(self) -> None: ...
    filter: str
    wrap: tuple[str, str]
    bounds: tuple[float | None, float | None]
    levels: int
    premultiplied: bool
    reader: str
    seam_budget: float
    footprint: float
    threads: int

def coarser_levels(
    image: npt.NDArray[np.float32],
    surfaces: Sequence[Surface],
    options: MipmapOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.float32]]: ...
def coarser_byte_levels(
    image: npt.NDArray[np.uint8],
    srgb: bool,
    surfaces: Sequence[Surface],
    options: MipmapOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.uint8]]: ...
def coarser_float_levels_of_bytes(
    image: npt.NDArray[np.uint8],
    srgb: bool,
    surfaces: Sequence[Surface],
    options: MipmapOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.float32]]: ...
def mipmap_error(
    levels: Sequence[npt.NDArray[np.float32]],
    image: npt.NDArray[np.float32],
    surfaces: Sequence[Surface],
    mip_values: list[float],
    wrap: tuple[str, str],
    reader: str,
    progress: ProgressCallback | None,
    threads: int,
) -> list[float]: ...
def seam_contrast(
    levels: Sequence[npt.NDArray[np.float32]],
    surfaces: Sequence[Surface],
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
) -> list[float]: ...
def texel_weights(
    surfaces: Sequence[Surface],
    width: int,
    height: int,
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float32]: ...
def fill_transparent(
    image: npt.NDArray[np.float32],
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float32]: ...
def fill_unused(
    image: npt.NDArray[np.float32],
    surfaces: Sequence[Surface],
    wrap: tuple[str, str],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float32]: ...

class ViewFitOptions:
    def __init__(self) -> None: ...
    lookups: str
    wrap: tuple[str, str]
    bounds: tuple[float | None, float | None]
    premultiplied: bool
    steadiness: float
    effort: float
    threads: int

def fit_to_views(
    levels: Sequence[npt.NDArray[np.float32]],
    surfaces: Sequence[Surface],
    options: ViewFitOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.float32]]: ...

class NormalMipmapOptions:
    def __init__(self) -> None: ...
    filter: str
    wrap: tuple[str, str]
    footprint: float
    encoded: bool
    levels: int
    threads: int

def normal_mipmaps(
    normals: npt.NDArray[np.float32],
    roughness: npt.NDArray[np.float32] | None,
    surfaces: Sequence[Surface],
    options: NormalMipmapOptions,
    progress: ProgressCallback | None,
) -> tuple[list[npt.NDArray[np.float32]], list[npt.NDArray[np.float32]]]: ...
def mesh_normals(
    points: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float64]: ...
def grid_normals(
    points: npt.NDArray[np.float64],
    grid: npt.NDArray[np.int64],
    viewpoint: list[float] | None,
    progress: ProgressCallback | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float32]]: ...
def directed_normals(
    points: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float64],
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]: ...

SUBSAMPLING: Final[tuple[str, ...]]

def subsample(
    points: npt.NDArray[np.float64],
    spacing: float,
    method: str,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.int64]: ...
def find_outliers(
    points: npt.NDArray[np.float64],
    neighbours: int,
    factor: float,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.bool_]: ...
def align_scans(
    scans: list[tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]],
    reach: float | None,
    iterations: int,
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[npt.NDArray[np.float64], float, float, list[int]]: ...
def align_to_surface(
    scans: list[tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]],
    matrices: list[npt.NDArray[np.float64]],
    positions: npt.NDArray[np.float64],
    triangles: npt.NDArray[np.int32],
    reach: float | None,
    iterations: int,
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[npt.NDArray[np.float64], float, float, list[int]]: ...
def paint_texture(
    surface: Surface,
    points: npt.NDArray[np.float64],
    values: npt.NDArray[np.float32],
    width: int,
    height: int,
    wrap: tuple[str, str],
    smoothing: float,
    reach: float | None,
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[npt.NDArray[np.float32], int]: ...
def estimate_normals(
    points: npt.NDArray[np.float64],
    neighbours: int,
    viewpoints: npt.NDArray[np.float64],
    direction: str,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]: ...
def completed_normals(
    points: npt.NDArray[np.float64],
    normals: npt.NDArray[np.float64],
    neighbours: int,
    progress: ProgressCallback | None,
    threads: int,
) -> npt.NDArray[np.float64]: ...
def origin_role(
    points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
) -> str: ...
def float_step(points: npt.NDArray[np.float64]) -> float: ...
def is_height_field(points: npt.NDArray[np.float64], progress: ProgressCallback | None) -> bool: ...

MAX_DEPTH: Final[int]

class Octree:
    def __init__(self, shared: Octree) -> None: ...
    @property
    def volume(self) -> float: ...
    @property
    def root(self) -> float: ...
    @property
    def depth(self) -> int: ...
    @property
    def bounds(self) -> tuple[list[float], list[float]]: ...
    @property
    def node_count(self) -> int: ...
    @property
    def nbytes(self) -> int: ...

def dense_values(
    octree: Octree, depth: int, progress: ProgressCallback | None, threads: int
) -> npt.NDArray[np.float32]: ...
def values_at(
    octree: Octree, points: npt.NDArray[np.float64], threads: int
) -> npt.NDArray[np.float32]: ...
def classify(
    octree: Octree, points: npt.NDArray[np.float64], tolerance: float, threads: int
) -> npt.NDArray[np.int8]: ...
def box_occupancy(octree: Octree, box: tuple[list[float], list[float]]) -> float: ...
def combine(
    octree: Octree,
    other: Octree,
    operation: str,
    progress: ProgressCallback | None,
    threads: int,
) -> Octree: ...
def coarsened(octree: Octree, depth: int) -> Octree: ...
def levels_of(
    octree: Octree,
) -> list[tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]]: ...
def voxelize(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    depth: int,
    bounds: tuple[list[float], list[float]] | None,
    thickness: float,
    progress: ProgressCallback | None,
    threads: int,
) -> Octree: ...
def cube_around(
    box: tuple[list[float], list[float]], depth: int
) -> tuple[list[float], list[float]]: ...
def thin_triangles(
    octree: Octree,
    only_walls: bool,
) -> tuple[
    npt.NDArray[np.int64],
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
    npt.NDArray[np.float64],
]: ...

class SolidOptions:
    def __init__(self) -> None: ...
    cell: float
    weld: float
    gap: float
    thickness: float
    sheets: str
    threads: int

def as_solid(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    options: SolidOptions,
    progress: ProgressCallback | None,
) -> tuple[
    tuple[npt.NDArray[np.float64], npt.NDArray[np.int64], npt.NDArray[np.int64]] | None,
    tuple[int, int, int, int, int, int, int],
]: ...
def close_holes(
    positions: npt.NDArray[np.floating],
    triangles: npt.NDArray[np.integer],
    method: str,
    progress: ProgressCallback | None,
    threads: int,
) -> tuple[npt.NDArray[np.floating], npt.NDArray[np.integer], int, int, int]: ...
def make_octree(
    levels: Sequence[tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]],
    root: float,
    bounds: tuple[list[float], list[float]],
    depth: int,
) -> Octree: ...
def traced_contour(
    octree: Octree,
    sources: Sequence[
        tuple[npt.NDArray[np.floating], npt.NDArray[np.integer], npt.NDArray[np.int32]]
    ],
    options: ContourOptions,
    progress: ProgressCallback | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32], npt.NDArray[np.int64]]: ...

class ContourOptions:
    def __init__(self) -> None: ...
    interpolant: str
    isovalue: float
    cleanup: bool
    adaptivity: float
    threads: int

def contour_octree(
    octree: Octree,
    sources: Sequence[
        tuple[npt.NDArray[np.floating], npt.NDArray[np.integer], npt.NDArray[np.int32]]
    ],
    options: ContourOptions,
    progress: ProgressCallback | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]: ...
def contour_quads(
    octree: Octree,
    sources: Sequence[
        tuple[npt.NDArray[np.floating], npt.NDArray[np.integer], npt.NDArray[np.int32]]
    ],
    options: ContourOptions,
    progress: ProgressCallback | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32], npt.NDArray[np.int64]]: ...
def contour_grid(
    grid: npt.NDArray[np.float32],
    spacing: list[float],
    origin: list[float],
    options: ContourOptions,
    progress: ProgressCallback | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int32]]: ...
def contour_outlines(
    grid: npt.NDArray[np.float32],
    spacing: list[float],
    origin: list[float],
    options: ContourOptions,
    progress: ProgressCallback | None,
) -> list[npt.NDArray[np.float64]]: ...

class ReconstructOptions:
    def __init__(self) -> None: ...
    depth: int
    cell_size: float | None
    wavelet: str
    smooth: bool
    isovalue: float | str
    are_sides_known: bool
    check_normals: bool
    fit: bool
    watertight: bool
    trim: float | None
    adaptivity: float
    support: bool
    memory_limit: int
    folder: bytes
    threads: int

class ArrayPoints(PointSource):
    def __init__(
        self,
        positions: npt.NDArray[np.floating],
        normals: npt.NDArray[np.floating],
        weights: npt.NDArray[np.float32] | None,
        attributes: npt.NDArray[np.float32] | None,
        names: list[tuple[str, bool]],
        is_double: bool,
    ) -> None: ...

class JoinedPoints(PointSource):
    def __init__(self, sources: tuple[PointSource, ...], rows_a_share: int = ...) -> None: ...
    @property
    def share_count(self) -> int: ...
    def choose_share(self, share: int) -> None: ...

class TurnedPoints(PointSource):
    def __init__(
        self, source: PointSource, is_up: bool, viewpoints: npt.NDArray[np.float64]
    ) -> None: ...

def reconstruct(
    source: PointSource, options: ReconstructOptions, progress: ProgressCallback | None
) -> tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.int32],
    npt.NDArray[np.float32],
    dict[str, Any],
]: ...
def find_phantoms(
    points: npt.NDArray[np.float64], progress: ProgressCallback | None, threads: int
) -> list[tuple[tuple[float, float, float], int]]: ...
def trim(
    positions: npt.NDArray[np.float64],
    triangles: npt.NDArray[np.int32],
    attributes: npt.NDArray[np.float32],
    distance: float,
    hole: float,
    island: float,
    progress: ProgressCallback | None,
) -> tuple[
    npt.NDArray[np.float64],
    npt.NDArray[np.int32],
    npt.NDArray[np.float32],
    dict[str, Any],
]: ...
def reconstruct_file(
    source: PointSource,
    target: bytes,
    options: ReconstructOptions,
    progress: ProgressCallback | None,
) -> dict[str, Any]: ...

class StepFiles:
    def __init__(
        self,
        work: str,
        measures: list[bytes],
        counts: list[bytes],
        cells: bytes,
        parts: list[bytes],
    ) -> None: ...

def reconstruct_step(
    step: str,
    source: PointSource,
    number: int,
    files: StepFiles,
    options: ReconstructOptions,
    progress: ProgressCallback | None,
) -> None: ...
def join_steps(
    source: PointSource,
    files: StepFiles,
    target: bytes,
    options: ReconstructOptions,
    progress: ProgressCallback | None,
) -> dict[str, Any]: ...

class RasterOptions:
    def __init__(self) -> None: ...
    width: int
    height: int
    filter: str
    method: str
    depth: int
    background: Sequence[float]
    overlap: str
    threads: int

def rasterize(
    shapes: Sequence[tuple[Outline, str, Paint, bool]],
    options: RasterOptions,
    is_bytes: bool,
    progress: ProgressCallback | None,
) -> npt.NDArray[np.float32] | npt.NDArray[np.uint8]: ...
def read_path(text: bytes, most: int) -> tuple[bytes | None, bytes | None, bool]: ...
def read_numbers(text: bytes) -> tuple[list[float], bool]: ...
def drawn_box(
    letters: bytes | bytearray, numbers: npt.NDArray[np.float64]
) -> tuple[float, float, float, float] | None: ...

FILL_RULES: Final[tuple[str, ...]]
