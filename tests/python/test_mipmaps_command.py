# SPDX-License-Identifier: GPL-3.0-or-later

"""The command `mipmaps`: its files of levels, against the package's functions."""

import os
import subprocess
import sys

import numpy as np
import prefilter
import pytest
from command_files import fails, noise, run, write_picture, write_quad
from prefilter.options.textures import FILTERS, TEXTURE_SPACE_FILTERS
from prefilter.workflows import mesh_files
from prefilter.workflows.up_to_date import fingerprint
from texture_readers import read_dds, read_ktx2

pytest.importorskip("OpenImageIO", reason="scripts/decoders.txt is not installed")

QUAD = prefilter.Surface(
    [[0, 0, 0], [3, 0, 0], [3, 1, 2], [0, 1, 0]],
    [[0, 1, 2], [0, 2, 3]],
    [[0, 0], [1, 0], [1, 1], [0, 1]],
)


@pytest.fixture
def texture(tmp_path):
    return write_picture(tmp_path / "paint.png", noise(8, 16))


@pytest.fixture
def quad(tmp_path):
    return write_quad(tmp_path / "quad.obj")


def pixels(path):
    """Returns a picture file's values, row 0 at the bottom."""
    import OpenImageIO as oiio

    return np.flipud(oiio.ImageBuf(str(path)).get_pixels("uint8"))


def test_the_levels_are_those_of_the_package(texture, quad, tmp_path, capsys):
    assert run("mipmaps", texture, quad, "-o", tmp_path / "out.png") == 0
    told = capsys.readouterr()
    assert "Baked 'paint.png' with PAM Bilinear over 1 object" in told.out
    assert "100 %" in told.err
    expected = prefilter.mipmaps(
        noise(8, 16)[::-1], QUAD, wrap=("repeat", "repeat"), encoding="srgb", bounds=(0, 1)
    )
    for number, level in enumerate(expected):
        found = pixels(tmp_path / f"out.{number:02d}.png")[..., :3]
        assert np.abs(found.astype(int) - level).max() <= (1 if number else 0)


def test_engines_get_levels_for_one_lookup(texture, quad, tmp_path):
    for name, lookups in (("auto.dds", ()), ("one.dds", ("--lookups", "one-lookup"))):
        assert run("mipmaps", texture, quad, "-o", tmp_path / name, *lookups) == 0
    assert (
        run("mipmaps", texture, quad, "-o", tmp_path / "many.dds", "--lookups", "supersampled") == 0
    )
    auto, one, many = ((tmp_path / f"{n}.dds").read_bytes() for n in ("auto", "one", "many"))
    assert auto == one != many


def test_without_a_mesh_least_squares(texture, tmp_path, capsys):
    assert run("mipmaps", texture, "-o", tmp_path / "a.ktx2") == 0
    assert "with Least Squares" in capsys.readouterr().out
    assert run("mipmaps", texture, "-o", tmp_path / "b.ktx2", "--filter", "ls-bilinear") == 0
    assert (tmp_path / "a.ktx2").read_bytes() == (tmp_path / "b.ktx2").read_bytes()
    assert len(read_ktx2(tmp_path / "a.ktx2").levels) == 5


def test_wrap_auto_is_repeat(texture, tmp_path):
    files = {}
    for wrap in ("auto", "repeat", "clamp"):
        files[wrap] = tmp_path / f"{wrap}.dds"
        assert run("mipmaps", texture, "-o", files[wrap], "--wrap", wrap) == 0
    assert files["auto"].read_bytes() == files["repeat"].read_bytes()
    assert files["auto"].read_bytes() != files["clamp"].read_bytes()


def test_blocks_by_content(texture, quad, tmp_path):
    out = tmp_path / "out.dds"
    options = ("--texture-format", "blocks")
    assert run("mipmaps", texture, quad, "-o", out, *options, "--content", "normal") == 0
    assert read_dds(out).format == "BC5_UNORM"
    assert run("mipmaps", texture, quad, "-o", out, *options) == 0
    assert read_dds(out).format == "BC7_SRGB"


def test_data_are_not_decoded(texture, tmp_path):
    assert (
        run("mipmaps", texture, "-o", tmp_path / "o.png", "--filter", "box", "--content", "data")
        == 0
    )
    mean = noise(8, 16).reshape(4, 2, 8, 2, 3).mean(axis=(1, 3))[::-1]
    found = pixels(tmp_path / "o.01.png")[..., :3].astype(float)
    assert np.abs(found - mean).max() <= 0.51


def test_roughness_of_a_normal_map(quad, tmp_path):
    rough = write_picture(tmp_path / "rough.png", np.full((8, 16, 3), 80, np.uint8))
    bumps = noise(8, 16)
    bumps[..., 2] = 255
    normal = write_picture(tmp_path / "normal.png", bumps)
    out = tmp_path / "rough.00.png"
    assert (
        run(
            *("mipmaps", normal, quad, "-o", tmp_path / "n.dds", "--content", "normal"),
            *("--roughness", rough, "--roughness-output", tmp_path / "r.png"),
        )
        == 0
    )
    assert not out.exists()
    assert pixels(tmp_path / "r.00.png")[..., :3].max() == 80
    assert pixels(tmp_path / "r.01.png")[..., :3].min() > 80


def test_chosen_objects(texture, tmp_path, capsys):
    pytest.importorskip("trimesh", reason="scripts/decoders.txt is not installed")
    path = tmp_path / "two.obj"
    path.write_text(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
        "o First\nf 1/1 2/2 3/3\no Second\nf 1/1 3/2 4/3\n"
    )
    out = tmp_path / "out.dds"
    assert run("mipmaps", texture, path, "-o", out) == 0
    assert "over 2 objects" in capsys.readouterr().out
    assert run("mipmaps", texture, path, "-o", out, "--object", "Second") == 0
    assert "over 1 object " in capsys.readouterr().out
    told = fails(capsys, 1, "mipmaps", texture, path, "-o", out, "--object", "Third")
    assert "no mesh 'Third'; there are 'First', 'Second'" in told


def test_numbers_are_those_that_blender_keeps(tmp_path):
    path = write_quad(tmp_path / "quad.obj")
    path.write_text(path.read_text().replace("v 3 0 0", "v 0.1 0 0").replace("vt 1 0", "vt 0.3 0"))
    (part,) = mesh_files.read("MESH", [str(path)])
    assert part.positions.dtype == np.float64
    assert np.float64(np.float32(0.1)) in part.positions
    assert np.float64(np.float32(0.3)) in part.uvs


def test_meshes_of_other_files(texture, quad, tmp_path):
    pytest.importorskip("PIL", reason="Pillow copies trimesh's materials")
    import trimesh

    expected = tmp_path / "expected.dds"
    assert run("mipmaps", texture, quad, "-o", expected) == 0
    mesh = trimesh.load_mesh(quad, process=False)
    for ending in ("glb", "ply"):
        other = tmp_path / f"quad.{ending}"
        visual = trimesh.visual.TextureVisuals(
            uv=mesh.visual.uv, material=trimesh.visual.material.PBRMaterial()
        )
        trimesh.Trimesh(mesh.vertices, mesh.faces, visual=visual, process=False).export(other)
        out = tmp_path / f"{ending}.dds"
        assert run("mipmaps", texture, other, "-o", out) == 0
        assert out.read_bytes() == expected.read_bytes()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (("--texture-format", "bc7"), "--texture-format: found 'bc7', which is for .dds and .ktx2"),
        (("--effort", "fast"), "--effort: found 'fast', which is for .dds and .ktx2 files"),
        (("--supercompression", "zstd"), "'zstd', which is for .ktx2 files"),
        (("--filter", "pam-box"), "--filter pam-box: needs a MESH; without: ls-bilinear"),
        (("--object", "A"), "--object: needs a MESH"),
    ],
)
def test_flags_that_do_not_go_together(texture, tmp_path, capsys, more, words):
    assert words in fails(capsys, 2, "mipmaps", texture, "-o", tmp_path / "out.exr", *more)


def test_no_output(texture, capsys):
    assert "give -o FILE" in fails(capsys, 2, "mipmaps", texture)


def test_what_cannot_be_read(texture, tmp_path, capsys):
    out = tmp_path / "out.dds"
    (tmp_path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nnothing")
    (tmp_path / "broken.glb").write_bytes(b"glTF")
    bare = write_quad(tmp_path / "bare.obj", has_uvs=False)
    for words, arguments in {
        "TEXTURE: there is no file": (tmp_path / "none.png",),
        "broken.png' cannot be read as a picture: ": (tmp_path / "broken.png",),
        "MESH: there is no file": (texture, tmp_path / "none.obj"),
        "broken.glb' cannot be read as a mesh: ": (texture, tmp_path / "broken.glb"),
        "no mesh has a UV map; found 'Quad'": (texture, bare),
    }.items():
        assert words in fails(capsys, 1, "mipmaps", *arguments, "-o", out)
    assert "allowed: .obj, .ply" in fails(capsys, 2, "mipmaps", texture, "a.blend", "-o", out)
    assert not out.exists()


def test_outputs_that_are_refused(texture, tmp_path, capsys):
    assert "there is no folder" in fails(capsys, 1, "mipmaps", texture, "-o", tmp_path / "a/b.dds")
    assert "use .exr" in fails(capsys, 1, "mipmaps", texture, "-o", tmp_path / "out.jpg")
    other = tmp_path / "paint.dds"
    texture.rename(other)
    before = other.read_bytes()
    assert "is read; choose another" in fails(capsys, 2, "mipmaps", other, "-o", other)
    assert other.read_bytes() == before


def test_a_failure_leaves_the_file_as_it_was(texture, tmp_path, capsys, monkeypatch):
    out = tmp_path / "out.ktx2"
    out.write_bytes(b"before")

    def full(*_, **__):
        raise OSError("no space left")

    monkeypatch.setattr("prefilter.files.staging.os.replace", full)
    assert "no space left" in fails(capsys, 1, "mipmaps", texture, "-o", out)
    assert out.read_bytes() == b"before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["out.ktx2", "paint.png"]


def test_missing_modules_are_named(texture, tmp_path, capsys, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "trimesh", None)
    (tmp_path / "part.stl").write_text("solid\nendsolid\n")
    told = fails(capsys, 1, "mipmaps", texture, tmp_path / "part.stl", "-o", tmp_path / "out.dds")
    assert "meshes need trimesh, which is missing: pip install 'prefilter[command]'" in told
    monkeypatch.setitem(sys.modules, "OpenImageIO", None)
    told = fails(capsys, 1, "mipmaps", texture, "-o", tmp_path / "out.dds")
    assert "pictures need OpenImageIO, which is missing: pip install" in told


def test_the_result_does_not_depend_on_threads(texture, quad, tmp_path):
    for count in (1, 3):
        out = tmp_path / f"{count}.ktx2"
        assert run("mipmaps", texture, quad, "-o", out, "--threads", count) == 0
    assert (tmp_path / "1.ktx2").read_bytes() == (tmp_path / "3.ktx2").read_bytes()


def test_filters_without_a_mesh_are_there():
    assert set(FILTERS) > TEXTURE_SPACE_FILTERS


def changed(path, data):
    """Changes a file's contents, but not its time."""
    time = path.stat().st_mtime_ns
    path.write_bytes(data)
    os.utime(path, ns=(time, time))


def test_what_is_up_to_date_is_skipped(texture, quad, tmp_path, capsys):
    out = tmp_path / "out.ktx2"
    command = ("mipmaps", texture, quad, "-o", out, "--skip-up-to-date")

    def is_made(*more):
        before = out.stat().st_ino if out.exists() else None
        capsys.readouterr()
        assert run(*command, *more) == 0
        told = capsys.readouterr().out
        made = out.stat().st_ino != before
        assert made == ("Baked" in told) != ("Up to date" in told)
        return made

    assert is_made()
    _, info = prefilter.read_ktx2(out)
    assert set(info.metadata) == {"KTXorientation", "KTXwriter", "PrefilterInputs"}
    assert not is_made()
    assert not is_made("--threads", 1)
    # Names and times do not count, contents and settings do.
    os.utime(texture, ns=(1, 1))
    assert not is_made()
    moved = texture.rename(tmp_path / "moved.png")
    command = ("mipmaps", moved, quad, "-o", out, "--skip-up-to-date")
    assert not is_made()
    assert is_made("--filter", "box")
    assert not is_made("--filter", "box")
    assert is_made("--wrap", "clamp")
    assert is_made()
    mesh = quad.read_bytes()
    changed(quad, mesh.replace(b"v 3 1 2", b"v 3 1 9"))
    assert is_made()
    assert not is_made()
    picture = write_picture(tmp_path / "other.png", noise(8, 16, seed=5)).read_bytes()
    changed(moved, picture)
    assert is_made()
    # Files written differently, or damaged, are written again.
    data = out.read_bytes()
    for other in (b"", data[:90], data.replace(b"PrefilterInputs", b"PrefilterOutputs")):
        out.write_bytes(other)
        assert is_made()
    out.unlink()
    assert is_made()
    plain = tmp_path / "plain.ktx2"
    assert run("mipmaps", moved, quad, "-o", plain) == 0
    found, _ = prefilter.read_ktx2(plain)
    made, _ = prefilter.read_ktx2(out)
    for one, other in zip(found, made, strict=True):
        np.testing.assert_array_equal(one, other)


def test_finding_all_up_to_date_loads_nothing_slow(texture, tmp_path):
    arguments = ["mipmaps", str(texture), "-o", str(tmp_path / "l.ktx2"), "--skip-up-to-date"]
    assert run(*arguments) == 0
    program = (
        f"import sys; from prefilter.commands import program; program.main({arguments})\n"
        "print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    said, loaded = done.stdout.splitlines()
    assert said.startswith("Up to date")
    assert not {"numpy", "OpenImageIO", "trimesh"} & set(loaded.split())


def test_roughness_counts_where_a_set_is_up_to_date(quad, tmp_path, capsys):
    rough = write_picture(tmp_path / "rough.png", np.full((8, 16, 3), 80, np.uint8))
    normal = write_picture(tmp_path / "normal.png", noise(8, 16))
    command = (
        *("mipmaps", normal, quad, "-o", tmp_path / "n.ktx2", "--content", "normal"),
        *("--roughness", rough, "--roughness-output", tmp_path / "r.ktx2", "--skip-up-to-date"),
    )
    for prepare, words in (
        (lambda: None, "Baked"),
        (lambda: None, "Up to date"),
        (lambda: (tmp_path / "r.ktx2").unlink(), "Baked"),
        (lambda: None, "Up to date"),
        (lambda: write_picture(rough, np.full((8, 16, 3), 81, np.uint8)), "Baked"),
    ):
        prepare()
        capsys.readouterr()
        assert run(*command) == 0
        assert words in capsys.readouterr().out


def test_the_buffers_of_gltf_files_count(texture, tmp_path):
    pytest.importorskip("PIL", reason="Pillow copies trimesh's materials")
    import trimesh

    mesh = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], process=False)
    mesh.visual = trimesh.visual.TextureVisuals(uv=[[0, 0], [1, 0], [0, 1]])
    model = tmp_path / "model.gltf"
    for name, data in mesh.export(file_type="gltf").items():
        (tmp_path / name).write_bytes(data)
    numbers = [fingerprint([texture, model], {})]
    buffer = min(tmp_path.glob("*.bin"))
    data = buffer.read_bytes()
    changed(buffer, data[:-1] + bytes([data[-1] ^ 1]))
    numbers.append(fingerprint([texture, model], {}))
    numbers.append(fingerprint([model, texture], {}))
    numbers.append(fingerprint([texture, model], {"filter": "box"}))
    assert len(set(numbers)) == 4


@pytest.mark.parametrize("name", ["out.dds", "out.png"])
def test_other_files_cannot_tell_that_they_are_up_to_date(texture, tmp_path, capsys, name):
    line = fails(capsys, 2, "mipmaps", texture, "-o", tmp_path / name, "--skip-up-to-date")
    assert name in line
    assert "only .ktx2, .exr, .tif, .tiff, .tx files" in line
    assert not (tmp_path / name).exists()
