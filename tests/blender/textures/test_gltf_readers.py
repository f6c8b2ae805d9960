# SPDX-License-Identifier: GPL-3.0-or-later

"""Small exports of every role, in odd sizes, as other programs read them that are installed.

bench/textures/exports.py makes forty more, and bench/textures/check_exports.py reads them.
"""

import io
import os
import shutil
import sys
from pathlib import Path

import prefilter
import pytest

ROOT = Path(__file__).resolve().parents[3]
sys.path.append(str(ROOT))

from bench.textures import check_exports, exports  # noqa: E402

MODULES = Path(os.environ.get("PREFILTER_NODE_MODULES", "node_modules"))
SIZES = [(1, 1), (3, 5), (18, 7), (16, 4)]


def case(number, role):
    return exports.Case(
        role,
        SIZES[number % len(SIZES)],
        ("uastc", "etc1s")[number % 2],
        ("zstd", "none")[number // 2 % 2],
        ("picture", "none")[number // 3 % 2],
        ("GLB", "GLTF_SEPARATE")[number % 3 % 2],
        draco=number == 4,
    )


CASES = [case(number, role) for number, role in enumerate(exports.ROLES)]


@pytest.fixture(params=CASES, ids=lambda case: case.name)
def exported(request, tmp_path):
    """An export, and its KTX 2 files."""
    path = tmp_path / request.param.name
    exports.make(request.param, tmp_path)
    exports.export(request.param, path)
    return request.param, path, list(check_exports.ktx2_files(path))


def test_all_textures_are_whole(exported):
    case, _, files = exported
    assert len(files) == {"normal": 2, "udim": 2, "both": 2}.get(case.role, 1)
    formats, encodings = set(), set()
    for data in files:
        levels, info = prefilter.read_ktx2(io.BytesIO(data))
        formats.add(info.format)
        height, width = levels[0].shape[:2]
        assert [width, height] == [side + -side % 4 for side in case.size]
        assert len(levels) == max(width, height).bit_length()
        encodings.add(info.encoding)
    colors, data = {"color", "emission", "cutout", "udim"}, {"linear", "srgb"}
    is_both = case.role == "both"
    assert encodings == (data if is_both else {"srgb" if case.role in colors else "linear"})
    assert case.texture_format in formats


def test_gltf_validator_and_gltf_transform_accept_it(exported):
    if shutil.which("node") is None:
        pytest.skip("node is not installed")
    if not (MODULES / "gltf-validator").is_dir() or not (MODULES / "@gltf-transform").is_dir():
        pytest.skip("PREFILTER_NODE_MODULES names no folder with gltf-validator, @gltf-transform")
    case, path, _ = exported
    (found,) = check_exports.read_by_node(MODULES, [path])["found"]
    assert found["validator"]["errors"] == 0, found["validator"]["messages"]
    assert "refused" not in found, found
    shown = {one["mimeType"]: one["resolution"] for one in found["textures"]}
    width, height = (side + -side % 4 for side in case.size)
    assert shown["image/ktx2"] == f"{width}x{height}"
    assert ("image/png" in shown) == (case.fallback == "picture")


def test_ktx_validate_accepts_it(exported):
    ktx = shutil.which("ktx")
    if ktx is None:
        pytest.skip("Khronos' ktx is not installed")
    for data in exported[2]:
        assert check_exports.validated(ktx, data) == []
