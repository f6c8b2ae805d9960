# SPDX-License-Identifier: GPL-3.0-or-later

"""The file that a command writes, and the files that it leaves alone."""

import os
import subprocess
import sys

import pytest
from command_files import fails, noise, run, write_picture, write_quad
from prefilter.workflows.files import patterns

pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

HALF = ("--percent", "50")
CUBE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Two pictures in the current folder."""
    monkeypatch.chdir(tmp_path)
    for name in ("1", "2"):
        write_picture(tmp_path / f"{name}.png", noise(8, 8, seed=int(name)))
    return tmp_path


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_two_files_of_a_pattern_stay_as_they_are(folder, capsys):
    before = contents(folder)
    told = fails(capsys, 2, "resize", "1.png", "2.png", *HALF)
    assert "'2.png' exists" in told
    assert "-o '2.png'" in told
    assert contents(folder) == before
    assert run("resize", "1.png", "2.png", *HALF, "--overwrite") == 0
    assert contents(folder)["1.png"] == before["1.png"]
    assert contents(folder)["2.png"] != before["2.png"]


def test_one_file_needs_no_flag(folder):
    assert run("resize", "1.png", "3.png", *HALF) == 0
    assert run("resize", "1.png", *HALF, "4.png") == 0
    assert run("resize", *HALF, "1.png", "-o", "5.png") == 0
    assert run("resize", "1.png", "--output", "5.png", *HALF) == 0
    files = contents(folder)
    assert files["3.png"] == files["4.png"] == files["5.png"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["1.png"], ["nothing to write", "-o OUTPUT"]),
        (["1.png", "2.png", "3.png"], ["found 3 files without -o", "{name}"]),
        (["1.png", "2.png", "half/{nam}.png"], ["found 3 files without -o", "{name}"]),
        (["1.png", "{nam}.png"], ["{nam}", "allowed: {name}"]),
        (["1.png", "-o", "{nam}.png"], ["{nam}", "allowed: {name}"]),
        (["1.png", "-o", "{name}{}.png"], ["{}", "allowed: {name}"]),
        (["1.png", "-o", "{Name}.png"], ["{Name}", "allowed: {name}"]),
        (["1.png", "2.png", "-o", "{nam}.png"], ["{nam}", "allowed: {name}"]),
        (["1.png", "2.png", "-o", "{{name}}.png"], ["{name} is needed"]),
    ],
)
def test_what_is_unclear_is_refused(folder, capsys, arguments, words):
    before = contents(folder)
    told = fails(capsys, 2, "resize", *arguments, *HALF)
    for word in words:
        assert word in told
    assert contents(folder) == before


def test_braces_may_be_written(folder):
    assert run("resize", "1.png", "-o", "{{{name}}}.png", *HALF) == 0
    assert "{1}.png" in contents(folder)


def test_what_is_read_is_replaced_if_asked(folder, capsys):
    (folder / "link.png").symlink_to("1.png")
    os.link("1.png", "hard.png")
    before = contents(folder)
    for name in ("1.png", f"../{folder.name}/1.png", "link.png", "hard.png"):
        assert "is read" in fails(capsys, 2, "resize", "1.png", "-o", name, *HALF)
    assert "is read" in fails(capsys, 2, "resize", "link.png", "-o", "1.png", *HALF)
    assert "is read" in fails(capsys, 2, "resize", "1.png", "1.png", *HALF)
    assert "is read" in fails(capsys, 2, "resize", "1.png", "2.png", "-o", "{name}.png", *HALF)
    assert contents(folder) == before
    assert run("resize", "1.png", "2.png", "-o", "{name}.png", *HALF, "--overwrite") == 0
    assert contents(folder)["2.png"] != before["2.png"]


def test_names_that_differ_in_their_letters_alone(folder, capsys):
    """Names that differ in case are one file on case-insensitive systems."""
    (folder / "1.png").rename("caf\u00e9.png")
    for name in ("CAF\u00c9.PNG", "cafe\u0301.png"):
        assert "is read" in fails(capsys, 2, "resize", "caf\u00e9.png", "-o", name, *HALF)
    assert run("resize", "caf\u00e9.png", "-o", "x-{name}.png", *HALF) == 0
    (folder / "caf\u00e9.png").rename("cafe\u0301.png")
    assert run("resize", "cafe\u0301.png", "-o", "y-{name}.png", *HALF) == 0
    assert {"x-caf\u00e9.png", "y-caf\u00e9.png"} <= contents(folder).keys()


def test_a_file_is_never_read_after_another_became_it(folder, capsys):
    """Refused even where files may be replaced."""
    (folder / "2.png").rename("1_2.png")
    arguments = ("resize", "1.png", "1_2.png", "-o", "{name}_2.png", *HALF, "--overwrite")
    assert "'1_2.png' is read" in fails(capsys, 2, *arguments)


def test_names_become_those_that_every_system_has(folder):
    for name in ("aux", "a:b", "Com1.x", "x "):
        (folder / f"{name}.png").write_bytes((folder / "1.png").read_bytes())
    names = ("aux.png", "a:b.png", "Com1.x.png", "x .png")
    assert run("resize", *names, "-o", "{name}.exr", *HALF) == 0
    made = {name for name in contents(folder) if name.endswith(".exr")}
    assert made == {"aux_.exr", "a_b.exr", "Com1_.x.exr", "x_.exr"}


def test_meshes_and_tables(folder, capsys):
    for name in ("a.obj", "b.obj"):
        (folder / name).write_text(CUBE)
    cloud = "".join(f"{x} {y} 0 0 0 1\n" for x in range(9) for y in range(9))
    for name in ("a.xyz", "a.ply"):
        (folder / name).write_text(cloud)
    (folder / "t.json").write_text("{}")
    before = contents(folder)
    for arguments, words in (
        (("voxelize", "a.obj", "b.obj"), "'b.obj' exists"),
        (("voxelize", "a.obj", "b.obj", "-o", "b.obj"), "{name} is needed"),
        (("voxelize", "a.obj", "-o", "a.obj"), "is read"),
        (("voxelize", "a.obj", "-o", "{nme}.ply"), "{nme}"),
        (("boolean", "a.obj", "b.obj", "-o", "b.obj"), "is read"),
        (("boolean", "a.obj", "b.obj", "-o", "{name}.obj"), "allowed: none"),
        (("reconstruct", "a.xyz", "a.ply", "--depth", "3"), "'a.ply' exists"),
        (("reconstruct", "a.ply", "-o", "a.ply", "--depth", "3"), "is read"),
        (("reconstruct", ".", "-o", "a.ply", "--depth", "3"), "is read"),
        (("reconstruct", "a.xyz", "b.xyz", "c.ply", "--depth", "3"), "without -o"),
        (("reconstruct", "a.xyz", "-o", "{name}.ply", "--depth", "3"), "allowed: none"),
        (("rasterize", "a.obj", "1.png", "--uv"), "'1.png' exists"),
        (("mipmaps", "1.png", "-o", "{nam}.exr"), "{nam}"),
        (("mipmaps", "1.png", "a.obj", "-o", "a.obj"), "is read"),
        (("sampling-table", "t.json"), "'t.json' exists"),
        (("sampling-table", "-o", "t.json", "--table", "t.json"), "is read"),
        (("sampling-table",), "nothing to write"),
        (("resample", "1.png", "-o", "{n}.png"), "{n}"),
    ):
        assert words in fails(capsys, 2, *arguments)
    assert contents(folder) == before


def test_the_name_of_a_texture(folder):
    assert run("mipmaps", "1.png", "-o", "levels-{name}.ktx2") == 0
    assert "levels-1.ktx2" in contents(folder)
    quad = write_quad(folder / "quad.obj")
    assert run("mipmaps", "1.png", "-o", "b.ktx2", quad) == 0


def test_a_level_that_is_read(folder, capsys):
    (folder / "1.png").rename("x.01.png")
    assert "is read" in fails(capsys, 2, "mipmaps", "x.01.png", "-o", "x.png")
    assert run("mipmaps", "x.01.png", "-o", "x.png", "--overwrite") == 0


def test_unknown_words_are_named():
    patterns.check("-o", "a{name}b{{c}}.png", ("name",))
    assert patterns.filled("a{name}b{{c}}.png", {"name": "N"}) == "aNb{c}.png"
    assert patterns.filled(patterns.literal("{name}{{"), {"name": "N"}) == "{name}{{"
    assert not patterns.has("{{name}}", "name")
    with pytest.raises(ValueError, match=r"placeholder \{nme\} in 'a\{nme\}'; allowed: \{name\}"):
        patterns.check("-o", "a{nme}", ("name",))


def test_a_shell_that_fills_in_names(folder):
    """The case as reported: a pattern that matches two files, and no other argument."""
    if os.name == "nt":
        pytest.skip("its shell leaves patterns alone")
    before = contents(folder)
    words = f"'{sys.executable}' -m prefilter resize *.png --percent 50"
    done = subprocess.run(["sh", "-c", words], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert contents(folder) == before


def test_a_pattern_behind_several_files_is_what_they_become(folder):
    arguments = ("resize", "1.png", "2.png", "small-{name}.png", *HALF)
    for _ in range(2):
        assert run(*arguments) == 0
    assert all((folder / f"small-{name}.png").exists() for name in "12")


def test_a_file_whose_name_has_the_placeholder_is_no_pattern(folder, capsys):
    (folder / "{name}.png").write_bytes((folder / "1.png").read_bytes())
    told = fails(capsys, 2, "resize", "1.png", "2.png", "{name}.png", *HALF)
    assert "found 3 files without -o" in told
