# SPDX-License-Identifier: GPL-3.0-or-later

"""Damaged files: one line of our own that names the file, and no messages of other libraries."""

import gzip
import json
import os
import struct
import sys

import numpy as np
import pytest
from command_files import noise, run, write_picture, write_quad

pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")
pytest.importorskip("trimesh", reason="scripts/decoders.txt is not installed")

DRAWING = b'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 4 4"><path d="M0 0h4v3z"/></svg>'
GLTF = {
    "asset": {"version": "2.0"},
    "scene": 0,
    "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
}
# Parts of messages of libraries and of Python.
FOREIGN = (
    *(
        "Traceback",
        "codec",
        "Error -3",
        "OpenImageIO",
        "libpng",
        "EXR_ERR",
        "TIFF",
        "requested size",
    ),
    *("NoneType", "Expecting", "argument", "unexpected failure", "index", "keyword", "unpack"),
)


def damages(data):
    """Yields damaged contents of a file: truncated, and overwritten."""
    yield from (b"", b"\0" * 100, b"hello\n", bytes(range(256)) * 2, b"{}", b"x" * 85)
    yield from (data[:count] for count in (1, 5, 20, 84, len(data) // 2, len(data) - 3))
    random = np.random.default_rng(1)
    for _ in range(8):
        damaged = bytearray(data)
        for place in random.integers(0, min(len(data), 300), 5):
            damaged[place] = random.integers(256)
        yield bytes(damaged)


def seeds(folder):
    write_picture(folder / "a.png", noise(9, 9))
    write_quad(folder / "a.obj")
    cloud = "".join(f"{x} {y} 0 0 0 1\n" for x in range(6) for y in range(6))
    (folder / "a.xyz").write_text(cloud)
    (folder / "a.svg").write_bytes(DRAWING)
    (folder / "z.svg").write_bytes(gzip.compress(DRAWING))
    (folder / "a.gltf").write_text(json.dumps(GLTF))
    triangle = struct.pack("<12fH", *range(12), 0)
    (folder / "a.stl").write_bytes(bytes(80) + struct.pack("<I", 4) + triangle * 4)
    assert run("sampling-table", "-o", folder / "a.json", "--filter", "tent", "--texels", "2") == 0


COMMANDS = {
    "png": ["resize {} -o o.png --percent 50", "mipmaps {} -o o.exr"],
    "jpg": ["resize {} -o o.png --percent 50"],
    "exr": ["resample {} -o o.png --rotate 30"],
    "tif": ["mipmaps {} -o o.dds"],
    "obj": ["voxelize {} -o o.ply --depth 3", "rasterize {} -o o.png --uv --side 8"],
    "ply": ["voxelize {} -o o.ply --depth 3", "boolean {} {} -o o.ply --depth 3"],
    "stl": ["voxelize {} -o o.ply --depth 3"],
    "off": ["voxelize {} -o o.ply --depth 3"],
    "glb": ["voxelize {} -o o.ply --depth 3", "mipmaps a.png {} -o o.exr"],
    "gltf": ["voxelize {} -o o.ply --depth 3"],
    "svg": ["rasterize {} -o o.png --side 40"],
    "json": ["sampling-table -o o.glsl --table {}"],
    "xyz": ["reconstruct {} -o s.ply --depth 3"],
}


@pytest.mark.parametrize("kind", COMMANDS)
def test_one_line_says_what_is_wrong(tmp_path, monkeypatch, capfd, kind):
    monkeypatch.chdir(tmp_path)
    seeds(tmp_path)
    own = [path for path in tmp_path.iterdir() if path.suffix == f".{kind}"]
    if kind in ("jpg", "exr", "tif"):
        own = [write_picture(tmp_path / f"a.{kind}", noise(9, 9))]
    if kind in ("ply", "off", "glb"):
        assert run("voxelize", "a.obj", "-o", "a.ply", "--depth", "3") == 0
        trimesh = sys.modules["trimesh"]
        own = [tmp_path / f"a.{kind}"]
        trimesh.load("a.ply").export(own[0])
    for path in own:
        for data in damages(path.read_bytes()):
            (tmp_path / f"bad.{kind}").write_bytes(data)
            for command in COMMANDS[kind]:
                capfd.readouterr()
                status = run(*command.replace("{}", f"bad.{kind}").split())
                told = [line for line in capfd.readouterr().err.splitlines() if "%" not in line]
                assert status in (0, 1), told
                assert all(line.startswith("prefilter: ") for line in told)
                if status:
                    assert told[-1].startswith("prefilter: error: ")
                    assert sum("error: " in line for line in told) == 1
                foreign = [word for word in FOREIGN if told and word in told[-1]]
                assert not foreign, told[-1]


def test_an_empty_file_is_said_to_be_empty(tmp_path, capfd):
    for kind in ("png", "obj", "stl", "glb"):
        path = tmp_path / f"a.{kind}"
        path.write_bytes(b"")
        command = ("resize", "--percent", "50") if kind == "png" else ("voxelize", "--depth", "3")
        target = tmp_path / ("o.png" if kind == "png" else "o.ply")
        assert run(command[0], path, "-o", target, *command[1:]) == 1
        told = capfd.readouterr().err
        assert f"'{path}'" in told
        assert "it is empty" in told or kind in ("obj", "stl")


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are text elsewhere")
def test_names_that_are_no_text(tmp_path, capfd):
    odd = os.fsdecode(b"x\xff")
    write_picture(tmp_path / "a.png", noise(8, 8))
    (tmp_path / "a.png").rename(tmp_path / f"{odd}.png")
    (tmp_path / odd).mkdir()
    write_quad(tmp_path / "a.obj")
    for target in ("o.png", f"{odd}o.png", f"{odd}/o.exr", "{name}.exr", f"{odd}/o.tif"):
        command = ["mipmaps"] if target.endswith("tif") else ["resize", "--percent", "50"]
        assert run(*command, tmp_path / f"{odd}.png", "-o", tmp_path / target) == 0
        assert (tmp_path / target.replace("{name}", "x_")).stat().st_size
    assert run("resize", tmp_path / f"{odd}.png", "-o", tmp_path / "a.png", "--percent", "50") == 0
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "o.png").read_bytes()
    (tmp_path / "a.obj").rename(tmp_path / f"{odd}.obj")
    for target in ("o.ply", "o.glb", f"{odd}/o.obj"):
        assert (
            run("voxelize", tmp_path / f"{odd}.obj", "-o", tmp_path / target, "--depth", "3") == 0
        )
    assert "Resized 'x\\udcff.png'" in capfd.readouterr().out


def test_details_for_those_who_debug(tmp_path, capfd, monkeypatch):
    monkeypatch.setenv("PREFILTER_DEBUG", "1")
    (tmp_path / "a.png").write_bytes(b"none")
    assert run("resize", tmp_path / "a.png", "-o", tmp_path / "o.png", "--percent", "50") == 1
    assert "Traceback" in capfd.readouterr().err
