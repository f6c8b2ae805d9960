# SPDX-License-Identifier: GPL-3.0-or-later

"""Outputs that are up to date by the contents and settings stored in them are left alone."""

import gzip
from dataclasses import dataclass
from typing import Any

import numpy as np
import prefilter
import pytest
from command_files import fails, noise, run, write_picture, write_quad
from prefilter.shapes._svg.read.document import MAX_UNPACKED
from prefilter.workflows import mesh_files
from prefilter.workflows.files import png
from prefilter.workflows.up_to_date import (
    KEY,
    arrays_of,
    fingerprint_of,
    is_self_contained,
    is_up_to_date,
    stored_fingerprint,
)

oiio = pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")


@dataclass
class Pair:
    """Settings with an array and sets, to compute a fingerprint of."""

    name: str
    values: Any
    more: dict[str, set[int]]


@pytest.fixture
def photo(tmp_path):
    return write_picture(tmp_path / "photo.png", noise(12, 16, 4))


def is_made(capsys, out, *arguments):
    """Runs a command; returns whether it has written its file."""
    before = out.stat().st_ino if out.exists() else None
    capsys.readouterr()
    assert run(*arguments, "--skip-up-to-date") == 0
    made = out.stat().st_ino != before
    assert made != ("Up to date" in capsys.readouterr().out)
    return made


@pytest.mark.parametrize("kind", ["exr", "tif", "tx"])
def test_levels(photo, tmp_path, capsys, kind):
    quad, out = write_quad(tmp_path / "quad.obj"), tmp_path / f"out.{kind}"
    command = ("mipmaps", photo, quad, "-o", out)
    assert is_made(capsys, out, *command)
    assert not is_made(capsys, out, *command)
    assert not is_made(capsys, out, *command, "--threads", "1")
    assert is_made(capsys, out, *command, "--wrap", "clamp")
    write_picture(photo, noise(12, 16, 4, seed=2))
    assert is_made(capsys, out, *command, "--wrap", "clamp")
    level = oiio.ImageBuf(str(out), 0, 1).get_pixels("float")
    assert run("mipmaps", photo, quad, "-o", out, "--wrap", "clamp") == 0
    np.testing.assert_array_equal(oiio.ImageBuf(str(out), 0, 1).get_pixels("float"), level)
    assert stored_fingerprint(out) == ""
    assert is_made(capsys, out, *command, "--wrap", "clamp")


@pytest.mark.parametrize("kind", ["png", "exr"])
@pytest.mark.parametrize(
    ("command", "flags", "others"),
    [
        ("resize", ("--percent", "50"), ("--percent", "25")),
        ("resize", ("--height", "5"), ("--height", "5", "--data")),
        ("resample", ("--rotate", "90"), ("--rotate", "91")),
        ("resample", ("--scale", "2"), ("--scale", "3")),
        ("resample", ("--rectify", *"00101101"), ("--rectify", *"00101102")),
    ],
)
def test_pictures(photo, tmp_path, capsys, kind, command, flags, others):
    out = tmp_path / f"out.{kind}"
    assert is_made(capsys, out, command, photo, "-o", out, *flags)
    pixels = oiio.ImageBuf(str(out)).get_pixels("float")
    assert not is_made(capsys, out, command, photo, "-o", out, *flags)
    assert is_made(capsys, out, command, photo, "-o", out, *others)
    assert is_made(capsys, out, command, photo, "-o", out, *flags)
    assert run(command, photo, "-o", tmp_path / f"plain.{kind}", *flags) == 0
    plain = oiio.ImageBuf(str(tmp_path / f"plain.{kind}")).get_pixels("float")
    np.testing.assert_array_equal(pixels, plain)


def test_the_table_of_a_filter_counts(photo, tmp_path, capsys):
    table, out = tmp_path / "table.json", tmp_path / "out.png"
    command = (
        "resample",
        photo,
        "-o",
        out,
        "--scale",
        "0.5",
        "--method",
        "table",
        "--table",
        table,
    )
    for name in ("tent", "lanczos2"):
        small = ("--texels", "4", "--grid", "1", "--slices", "1")
        assert run("sampling-table", "-o", table, "--filter", name, *small) == 0
        assert is_made(capsys, out, *command)
        assert not is_made(capsys, out, *command)


@pytest.mark.parametrize("kind", ["ply", "obj", "stl", "glb"])
def test_meshes(tmp_path, capsys, kind):
    trimesh = pytest.importorskip("trimesh")
    source, out, plain = tmp_path / "box.ply", tmp_path / f"out.{kind}", tmp_path / f"plain.{kind}"
    trimesh.creation.box().export(source)
    command = ("voxelize", source, "-o", out, "--depth", "4")
    assert is_made(capsys, out, *command)
    assert not is_made(capsys, out, *command)
    assert not is_made(capsys, out, *command, "--threads", "1")
    assert run("voxelize", source, "-o", plain, "--depth", "4") == 0
    assert KEY.encode() not in plain.read_bytes()
    found, expected = (trimesh.load(path, force="mesh") for path in (out, plain))
    np.testing.assert_array_equal(found.vertices, expected.vertices)
    np.testing.assert_array_equal(found.faces, expected.faces)
    assert is_made(capsys, out, "voxelize", source, "-o", out, "--depth", "5")
    trimesh.creation.box((1, 1, 2)).export(source)
    assert is_made(capsys, out, "voxelize", source, "-o", out, "--depth", "5")
    assert not is_made(capsys, out, "voxelize", source, "-o", out, "--depth", "5")


@pytest.mark.parametrize("kind", ["png", "exr"])
def test_drawings(tmp_path, capsys, kind):
    drawing, out = tmp_path / "a.svg", tmp_path / f"a.{kind}"
    drawing.write_text(
        '<svg viewBox="0 0 4 4"><path id="a" d="M0 0h4L0 4z"/><use href="#a"/></svg>'
    )
    command = ("rasterize", drawing, "-o", out, "--side", "32")
    assert is_made(capsys, out, *command)
    assert not is_made(capsys, out, *command)
    assert is_made(capsys, out, *command, "--filter", "tent")
    drawing.write_text('<svg viewBox="0 0 4 4"><path d="M0 0h4L1 4z"/></svg>')
    assert is_made(capsys, out, *command)
    quad = write_quad(tmp_path / "quad.obj")
    assert is_made(capsys, out, "rasterize", quad, "-o", out, "--uv", "--side", "32")
    assert not is_made(capsys, out, "rasterize", quad, "-o", out, "--uv", "--side", "32")


@pytest.mark.parametrize(
    "inside",
    [
        '<text font-size="1">a</text>',
        '<s:text xmlns:s="http://www.w3.org/2000/svg">a</s:text>',
        '<image href="a.png"/>',
        "<image xlink:href = ' a.png'/>",
        "<style>@import 'a.css';</style>",
        "<style>@font-face { src: url( a.woff) }</style>",
        '<style>rect { fill: \\75rl("a.svg#b") }</style>',
        '<rect fill="url(b.svg#c)"/>',
    ],
)
def test_drawings_of_several_files_are_made_anew(tmp_path, inside):
    path = tmp_path / "a.svg"
    path.write_text(f"<svg>{inside}</svg>")
    assert not is_self_contained(path)
    path.write_bytes(gzip.compress(path.read_bytes()))
    assert not is_self_contained(path)
    path.write_bytes(f"<svg>{inside}</svg>".encode("utf-16"))
    assert not is_self_contained(path)


@pytest.mark.parametrize(
    "inside",
    [
        "",
        '<image href="data:image/png;base64,AAAA"/>',
        '<rect fill="url(#a)" filter="url( \'#b\' )"/><use xlink:href=" #a"/><use href=""/>',
        '<g id="text" class="texture"/><context/><desc>text</desc>',
    ],
)
def test_drawings_of_one_file_stand_alone(tmp_path, inside):
    path = tmp_path / "a.svg"
    path.write_text(f"<svg>{inside}</svg>")
    assert is_self_contained(path)
    path.write_bytes(gzip.compress(path.read_bytes()))
    assert is_self_contained(path)
    path.write_bytes(path.read_bytes()[:-9])
    assert not is_self_contained(path)


def test_a_drawing_that_is_large_when_unpacked_is_not_looked_through(tmp_path):
    path = tmp_path / "a.svg"
    path.write_bytes(gzip.compress(b"<svg>" + bytes(MAX_UNPACKED).replace(b"\0", b" ") + b"</svg>"))
    assert not is_self_contained(path)


def test_of_many_files_those_that_have_changed_are_made(tmp_path, capsys):
    pictures = [write_picture(tmp_path / f"{i}.png", noise(8, 8, seed=i)) for i in range(3)]
    (tmp_path / "out").mkdir()
    command = ("resize", *pictures, "-o", tmp_path / "out" / "{name}.png", "--percent", "50")
    assert run(*command, "--skip-up-to-date", "--task", "1/2") == 0
    capsys.readouterr()
    assert run(*command, "--skip-up-to-date") == 0
    told = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in told] == ["Up", "Resized", "Up"]


def test_targets_that_cannot_tell(photo, tmp_path, capsys):
    target = tmp_path / "out.dds"
    last = fails(capsys, 2, "mipmaps", photo, "-o", target, "--skip-up-to-date")
    assert "--skip-up-to-date" in last


def test_damaged_files_are_never_up_to_date(tmp_path):
    number = "0" * 64
    prefilter.write_exr(
        tmp_path / "a.exr", [np.ones((1, 1, 3), np.float32)], attributes={"b": "c", KEY: number}
    )
    (tmp_path / "a.png").write_bytes(
        png.encoded(np.zeros((1, 1, 3), np.uint8), is_srgb=True, texts={"b": "c", KEY: number})
    )
    paths = [tmp_path / "a.exr", tmp_path / "a.png"]
    corners = np.eye(3)
    triangle = mesh_files.NamedMesh("a", corners, np.array([[0, 1, 2]]), None)
    for kind in ("ply", "obj", "stl", "glb"):
        paths.append(tmp_path / f"a.{kind}")
        mesh_files.stage(paths[-1], [triangle], {KEY: number}).commit()
    for path in paths:
        assert is_up_to_date([path], number)
        assert not is_up_to_date([path], "1" * 64)
        data = path.read_bytes()
        end = data.index(number.encode()) + len(number)
        for size in range(end):
            path.write_bytes(data[:size])
            assert not is_up_to_date([path], number)
        path.write_bytes(data[:8] + b"\xff" * 30)
        assert not is_up_to_date([path], number)
    assert not is_up_to_date([tmp_path / "none.png"], number)
    assert not is_up_to_date([tmp_path], number)
    assert not is_up_to_date([], number)


def test_a_number_of_arrays_is_of_all_that_is_in_them():
    ones = np.ones((2, 6), np.float32)
    others = (
        [ones.reshape(3, 4)],
        [ones.view(np.int32)],
        [ones[:1], ones[1:]],
        [np.ones((2, 6), np.float64)],
        [ones[:0], ones],
        [],
    )
    numbers = {fingerprint_of(arrays, {"a": 1}) for arrays in ([ones], *others)}
    numbers.add(fingerprint_of([ones], {"a": 2}))
    assert len(numbers) == 8
    assert fingerprint_of([np.repeat(ones, 2, 1)[:, ::2]], {"a": 1}) in numbers


def test_numbers_of_what_was_read():
    def number(read):
        return fingerprint_of(arrays_of(read), {})

    pair = Pair("a", np.arange(4.0), {"x": {2, 1}})
    assert number(pair) == number(Pair("a", np.arange(4.0), {"x": {1, 2}}))
    others = [
        Pair("b", np.arange(4.0), {"x": {2, 1}}),
        Pair("a", np.arange(4.0, dtype=np.float32), {"x": {2, 1}}),
        Pair("a", np.arange(4.0).reshape(2, 2), {"x": {2, 1}}),
        Pair("a", np.arange(4.0)[::-1], {"x": {2, 1}}),
        Pair("a", np.arange(4.0), {"x": {2}}),
        Pair("a", np.arange(4.0), {"y": {2, 1}}),
        Pair("a", None, {"x": {2, 1}}),
        [pair],
        [[1, 2], [3]],
        [[1], [2, 3]],
        ["1", 2, 3],
        [],
    ]
    assert len({number(one) for one in [pair, *others]}) == 1 + len(others)
