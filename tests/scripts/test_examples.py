# SPDX-License-Identifier: GPL-3.0-or-later

"""The installed C++ library is found by CMake, and examples/ uses it as docs/cpp.md says."""

import re
import shutil
import subprocess
from itertools import pairwise
from pathlib import Path

import header_tables
import numpy as np
import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
PUBLIC = CHECKOUT / "native/include/prefilter"
PAGE = (CHECKOUT / "docs/cpp.md").read_text()
LIBRARY = CHECKOUT / "build/release/native/prefilter/libprefilter.a"


def run(*command: str | Path) -> str:
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not LIBRARY.is_file() or shutil.which("ninja") is None:
        pytest.skip("build/release has no library, or there is no Ninja")
    folder = tmp_path_factory.mktemp("examples")
    run(CHECKOUT / "scripts/examples", folder)
    return folder


@pytest.fixture(scope="module")
def programs(built: Path) -> Path:
    return built / "programs"


def test_what_is_installed(built: Path) -> None:
    found = {path.relative_to(built / "installed") for path in built.glob("installed/**/*.h")}
    public = {path.relative_to(PUBLIC.parent) for path in PUBLIC.rglob("*.h")}
    assert found == {Path("include") / path for path in public}
    texts = built / "installed/share/doc/prefilter"
    assert (texts / "LICENSE").read_bytes() == (CHECKOUT / "LICENSE").read_bytes()
    table = (CHECKOUT / "scripts/sources.toml").read_text()
    linked = re.findall(r'^\["(.*)-.*"\]$', table, re.MULTILINE)
    assert linked
    assert [name for name in linked if not list((texts / name).glob("LICENSE*"))] == []


def test_what_is_installed_names_no_folder_of_the_build(built: Path) -> None:
    for path in built.glob("installed/lib*/**/*.cmake"):
        assert str(CHECKOUT) not in path.read_text(), path


def test_mipmaps(programs: Path) -> None:
    """A globe of brightness s^2, s the sine of the latitude; s is uniform over its area."""
    mean = 1 / 3
    variance = 1 / 5 - mean**2
    # A texel of the image is a mean over latitudes, which are uniform in the image.
    expected = {"box": (1 / 2, (variance + (1 / 2 - mean) ** 2) ** 0.5)}
    expected["pam-bilinear"] = (mean, variance**0.5)
    printed = run(programs / "mipmaps")
    lines = printed.splitlines()
    errors: dict[str, list[float]] = {}
    for name, (last_texel, last_error) in expected.items():
        found = [line for line in lines if line.startswith(name + " ")]
        errors[name] = [float(line.split()[-1]) for line in found[:-1]]
        assert float(found[-1].split()[-1]) == pytest.approx(last_texel, abs=1e-3)
        assert errors[name][-1] == pytest.approx(last_error, abs=1e-3)
    assert len(errors["box"]) == 8
    pairs = zip(errors["pam-bilinear"], errors["box"], strict=True)
    assert all(aware < blind for aware, blind in pairs)


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Positions and triangles of a PLY file as the library writes it, without attributes."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode()
    vertices, triangles = map(int, re.findall(r"element (?:vertex|face) (\d+)", header))
    kind = "<f8" if "property double x" in header else "<f4"
    positions = np.frombuffer(data, kind, 3 * vertices, end).reshape(-1, 3)
    row = np.dtype([("count", "u1"), ("corners", "<u4", 3)])
    faces = np.frombuffer(data, row, triangles, end + positions.nbytes)
    assert np.all(faces["count"] == 3)
    assert end + positions.nbytes + faces.nbytes == len(data)
    return positions.astype(np.float64), faces["corners"].astype(np.int64)


def volume(positions: np.ndarray, triangles: np.ndarray) -> float:
    return float(np.linalg.det(positions[triangles]).sum() / 6)


def assert_closed(triangles: np.ndarray) -> None:
    """Each edge has two triangles, in opposite directions."""
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    once, counts = np.unique(edges, axis=0, return_counts=True)
    assert np.all(counts == 1)
    assert np.array_equal(once, np.unique(edges[:, ::-1], axis=0))


def test_voxelize(programs: Path, tmp_path: Path) -> None:
    printed = dict(
        line.split(": ") for line in run(programs / "voxelize", tmp_path / "both.ply").splitlines()
    )
    # The boxes have a cube of side 1/2 in common.
    expected = 1.0 + 0.8**3 - 0.5**3
    assert float(printed["volume"]) == pytest.approx(expected, rel=1e-3)
    positions, triangles = read_ply(tmp_path / "both.ply")
    assert len(triangles) == int(printed["triangles"])
    assert_closed(triangles)
    assert volume(positions, triangles) == pytest.approx(expected, rel=1e-3)
    assert positions.min(axis=0) == pytest.approx([0, 0, 0], abs=2e-3)
    assert positions.max(axis=0) == pytest.approx([1.3, 1.3, 1.3], abs=2e-3)


def test_reconstruct(programs: Path, tmp_path: Path) -> None:
    """Points of a sphere of radius 2 around (1, 2, 3), spread along a spiral."""
    count = 5000
    heights = 1 - (2 * np.arange(count) + 1) / count
    angles = np.pi * (3 - 5**0.5) * np.arange(count)
    across = np.sqrt(1 - heights**2)
    normals = np.stack([across * np.cos(angles), across * np.sin(angles), heights], axis=1)
    center = np.array([1.0, 2.0, 3.0])
    np.savetxt(tmp_path / "ball.xyzn", np.hstack([center + 2 * normals, normals]))
    printed = run(programs / "reconstruct", tmp_path / "ball.xyzn", tmp_path / "ball.ply")
    positions, triangles = read_ply(tmp_path / "ball.ply")
    assert printed.splitlines() == [
        f"points: {count}",
        f"vertices: {len(positions)}",
        f"triangles: {len(triangles)}",
    ]
    assert_closed(triangles)
    cell = 4 / 64
    distances = np.linalg.norm(positions - center, axis=1) - 2
    assert np.abs(distances).max() < cell / 2
    assert volume(positions - center, triangles) == pytest.approx(4 / 3 * np.pi * 8, rel=0.01)


def test_a_refusal_is_told(programs: Path, tmp_path: Path) -> None:
    command = (programs / "reconstruct", tmp_path / "none.ply", tmp_path / "out.ply")
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1
    assert "none.ply" in done.stderr


def heart() -> np.ndarray:
    """The path of examples/rasterize.cpp as lines."""
    source = (CHECKOUT / "examples/rasterize.cpp").read_text()
    calls = re.findall(r"path\.(move_to|curve_to)(.*);", source)
    points = [re.findall(r"\{([\d.]+), ([\d.]+)\}", arguments) for _, arguments in calls]
    begin, *curves = (np.array(each, float) for each in points)
    t = np.linspace(0, 1, 65)[1:, None]
    lines = [begin]
    for a, b, c in curves:
        p, s = lines[-1][-1], 1 - t
        lines.append(s**3 * p + 3 * s**2 * t * a + 3 * s * t**2 * b + t**3 * c)
    return np.concatenate(lines)


def test_rasterize(programs: Path, tmp_path: Path) -> None:
    """Each pixel is the mean of 8 x 8 points, whose colors distance and winding tell."""
    run(programs / "rasterize", tmp_path / "heart.ppm")
    data = (tmp_path / "heart.ppm").read_bytes()
    assert data.startswith(b"P6\n160 160\n255\n")
    found = np.frombuffer(data, np.uint8, offset=len(b"P6\n160 160\n255\n")).reshape(160, 160, 3)
    corners = heart()
    fine = (np.arange(160 * 8) + 0.5) / 8
    is_inside = np.zeros((fine.size, fine.size), bool)
    near = np.full((fine.size, fine.size), np.inf)
    for (ax, ay), (bx, by) in pairwise(corners):
        rows = (fine < ay) != (fine < by)
        crossing = ax + (fine[rows] - ay) * (bx - ax) / (by - ay)
        is_inside[rows] ^= fine < crossing[:, None]
        # A segment is short: only pixels around it can be under its stroke.
        x = slice(*np.searchsorted(fine, [min(ax, bx) - 4, max(ax, bx) + 4]))
        y = slice(*np.searchsorted(fine, [min(ay, by) - 4, max(ay, by) + 4]))
        along = np.array([bx - ax, by - ay])
        px, py = fine[None, x] - ax, fine[y, None] - ay
        t = np.clip((px * along[0] + py * along[1]) / (along @ along), 0, 1)
        distance = np.hypot(px - t * along[0], py - t * along[1])
        near[y, x] = np.minimum(near[y, x], distance)
    light = np.where(is_inside[..., None], [0.8, 0.05, 0.1], [1.0, 1.0, 1.0])
    light[near < 2.5] = [0.1, 0.0, 0.02]
    means = light.reshape(160, 8, 160, 8, 3).mean(axis=(1, 3))[::-1]
    stored = found / 255
    linear = np.where(stored > 0.04045, ((stored + 0.055) / 1.055) ** 2.4, stored / 12.92)
    # Points miss half the distance between them at most, and bytes less than a hundredth of light.
    assert np.abs(linear - means).max() < 1 / 16 + 0.01
    assert np.abs(linear - means).mean() < 1e-3


def test_the_page_shows_the_examples() -> None:
    sources = [path.read_text() for path in (CHECKOUT / "examples").glob("*.*")]
    shown = re.findall(r"^```(?:cpp|cmake)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)
    assert len(shown) >= 8
    assert [code for code in shown if not any(code in source for source in sources)] == []


def test_the_page_lists_the_public_headers() -> None:
    # Otherwise, scripts/header_tables.py writes the tables anew.
    assert header_tables.rewritten(PAGE) == PAGE
    listed = re.findall(r"^\| `(\w+/\w+\.h)` \| .* \|$", PAGE, re.MULTILINE)
    assert sorted(listed) == sorted(str(path.relative_to(PUBLIC)) for path in PUBLIC.rglob("*.h"))
