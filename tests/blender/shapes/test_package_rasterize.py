# SPDX-License-Identifier: GPL-3.0-or-later

"""The package's command `rasterize` writes the same bytes as that in Blender."""

import re

import numpy as np
import pytest
from command_line import run
from prefilter.commands import program
from prefilter.workflows import mesh_files

TIME = re.compile(rb"\d{4}:\d\d:\d\d \d\d:\d\d:\d\d")
SVG = """<svg xmlns="http://www.w3.org/2000/svg" width="8" height="4">
<circle cx="4" cy="2" r="1.7" fill="#ff8000" opacity="0.7"/><path d="M0 0h3v4z"/></svg>"""


def same(source, folder, ending, *flags):
    """Makes a file with both commands; tells whether they are the same."""
    ours, theirs = folder / f"ours.{ending}", folder / f"theirs.{ending}"
    assert program.main(["rasterize", str(source), str(ours), *flags]) == 0
    result = run("rasterize", source, "-o", theirs, *flags)
    assert result.returncode == 0, result.stderr
    # OpenImageIO puts the time into files.
    first, second = (TIME.sub(b"", path.read_bytes()) for path in (ours, theirs))
    return first == second


@pytest.mark.parametrize("ending", ["png", "exr"])
@pytest.mark.parametrize(
    "flags",
    [
        ("--side", "60"),
        ("--density", "5", "--background", "#204060", "--filter", "mitchell"),
        ("--width", "40", "--height", "40", "--color", "mask"),
        ("--side", "33", "--pixel-type", "half", "--no-bleed", "--margin", "0"),
    ],
    ids=" ".join,
)
def test_svg(tmp_path, ending, flags):
    path = tmp_path / "logo.svg"
    path.write_text(SVG)
    assert same(path, tmp_path, ending, *flags)


def test_uv_map(tmp_path, monkeypatch):
    """Blender has no trimesh, which would read the file as this."""
    path = tmp_path / "quad.obj"
    path.write_text(
        "o Quad\nv 0 0 0\nv 3 0 0\nv 3 1 0\nv 0 1 0\n"
        "vt 0.1 0\nvt 0.7 0.2\nvt 0.9 0.9\nvt 0 0.6\nf 1/1 2/2 3/3 4/4\n"
    )
    uvs = np.array([[0.1, 0], [0.7, 0.2], [0.9, 0.9], [0, 0.6]])
    part = mesh_files.NamedMesh("Quad", np.eye(4)[:, :3], np.array([[0, 1, 2], [0, 2, 3]]), uvs)
    monkeypatch.setattr(mesh_files, "read", lambda *_: [part])
    assert same(path, tmp_path, "png", "--uv", "--side", "50", "--filter", "tent")
