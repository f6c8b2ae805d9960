# SPDX-License-Identifier: GPL-3.0-or-later

"""Bad input is reported with the reason, and neither images nor files are made.

Each row is a change that breaks a good scene, and a text that the message must contain. The tests
of each function have more invalid values; here is one of each kind, as users see it.
"""

from dataclasses import dataclass, field

import bpy
import numpy as np
import pytest
import scenes
from command_line import assert_fails, run

NAN = float("nan")


@dataclass
class Row:
    """A change to a good scene or to the options of a bake; the message has to name the problem."""

    words: list[str]
    options: dict[str, object] = field(default_factory=dict)
    change: object = None
    named: str = "Paint"
    operator: str = "bake_mipmaps"


def without_uvs(quad):
    quad.data.uv_layers.remove(quad.data.uv_layers[0])


def without_faces(quad):
    quad.data.clear_geometry()


def without_material(quad):
    quad.data.materials.clear()


def of_no_area(quad):
    quad.scale = (0, 0, 0)


def not_selected(quad):
    quad.select_set(False)
    bpy.context.scene.prefilter_bake.objects = "selected"


def of_no_user(quad):
    quad.hide_set(True)


def with_a_broken_vertex(quad):
    quad.data.vertices[1].co.x = NAN


def with_a_broken_uv(quad):
    quad.data.uv_layers[0].uv[2].vector.y = NAN


def of_no_file(quad):
    image = bpy.data.images["Paint"]
    image.unpack(method="REMOVE")
    image.source, image.filepath = "FILE", "//gone.png"
    image.reload()


def of_a_sequence(quad):
    bpy.data.images["Paint"].source = "SEQUENCE"


def of_a_broken_texel(quad):
    values = scenes.noise(8, 8)
    values[2, 3, 1] = NAN
    image = bpy.data.images.new("Light", 8, 8, float_buffer=True)
    image.pixels.foreach_set(values.ravel())
    quad.data.materials[0] = scenes.material("Light", image)


def of_no_importance(quad):
    quad.data.attributes.new("Care", "FLOAT", "POINT")


def with_a_small_roughness(quad):
    scenes.image("Rough", scenes.noise(4, 4), colorspace="Non-Color")


ROWS = {
    "no name": Row(["image: no name is given"], change=without_material, named=""),
    "another name": Row(["image: ", "no image named 'Pain'", "'Paint'"], named="Pain"),
    "no object": Row(
        ["image 'Paint'", "no object is selected"], {"objects": "selected"}, change=not_selected
    ),
    "no user": Row(["image 'Paint'", "no visible object uses it"], change=of_no_user),
    "no material": Row(
        ["image 'Paint'", "no material on a face of a mesh uses it", "'Quad' (mesh)"],
        {"objects": "selected"},
        change=without_material,
    ),
    "no faces": Row(["image 'Paint'", "no surface to bake for", "'Quad'"], change=without_faces),
    "no area": Row(["object 'Quad'", "area of 0 in all", "positive"], change=of_no_area),
    "broken vertex": Row(
        ["object 'Quad'", "positions: vertex 1", "nan", "finite"], change=with_a_broken_vertex
    ),
    "broken UV": Row(["object 'Quad'", "uvs: triangle", "nan", "finite"], change=with_a_broken_uv),
    "missing image file": Row(
        ["image 'Paint'", "found no pixels", "is its file missing?"], change=of_no_file
    ),
    "sequence": Row(
        ["image 'Paint'", "sequence", "a single still image is needed"], change=of_a_sequence
    ),
    "broken texel": Row(
        ["image: the texel in row 2, column 3 holds nan", "finite"],
        change=of_a_broken_texel,
        named="Light",
    ),
    "no folder": Row(["there is no folder", "nowhere"], {"filepath": "nowhere/out.exr"}),
    "folder": Row(["folder.exr", "is a folder"], {"filepath": "folder.exr"}),
    "read-only file": Row(["kept.exr", "is read-only"], {"filepath": "kept.exr"}),
    "importance of 0": Row(
        ["Importance: 'Care' is 0 wherever", "'Quad'"],
        {"importance": "Care"},
        change=of_no_importance,
    ),
    "roughness of another size": Row(
        ["Roughness: 'Rough' has 4 x 4 texels", "8 x 8"],
        {"content": "normal", "roughness": "Rough"},
        change=with_a_small_roughness,
    ),
    **{
        f"{operator} without {what}": Row(["Paint", words], change=change, operator=operator)
        for operator in ("preview_levels", "plot_error", "show_weights", "fill_unused")
        for what, change, words in (
            ("object", not_selected, "no object is selected"),
            ("UVs", without_uvs, "has no UV map"),
            ("picture", of_no_file, "is its file missing?"),
        )
    },
}


@pytest.fixture
def folder(tmp_path):
    """Returns a folder with a file that is read-only, a folder that is named like a file."""
    (tmp_path / "kept.exr").write_bytes(b"kept")
    (tmp_path / "kept.exr").chmod(0o444)
    (tmp_path / "folder.exr").mkdir()
    return tmp_path


def state(folder):
    """Returns all images with hashes of their pixels, all texts, and all files."""
    images = {one.name: hash(np.array(one.pixels).tobytes()) for one in bpy.data.images}
    return images, sorted(text.name for text in bpy.data.texts), files(folder)


def files(folder):
    """Returns the contents of a folder's files, by name."""
    return {path.name: path.is_file() and path.read_bytes() for path in folder.rglob("*")}


@pytest.mark.parametrize("name", ROWS)
def test_operator(name, folder):
    row = ROWS[name]
    quad = scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    if row.change is not None:
        row.change(quad)
    bpy.context.view_layer.update()
    options = {
        key: str(folder / value) if key.endswith("filepath") else value
        for key, value in row.options.items()
    }
    before = state(folder)
    with pytest.raises(RuntimeError) as caught:
        getattr(bpy.ops.prefilter, row.operator)(image=row.named, **options)
    message = str(caught.value)
    for word in row.words:
        assert word in message
    assert "Traceback" not in message
    assert state(folder) == before


@pytest.mark.parametrize(
    ("arguments", "words", "status"),
    [
        (["bake"], ["FILE"], 2),
        (["bake", "scene.blend"], ["nothing to write", "--output", "--save"], 2),
        (["bake", "scene.txt", "--save"], ["FILE: found 'scene.txt'", ".blend"], 2),
        (["bake", "quad.obj", "--save"], ["--save: needs a .blend", "quad.obj"], 2),
        (["bake", "none.blend", "--save"], ["FILE: there is no file", "none.blend"], 1),
        (["bake", "broken.blend", "--save"], ["FILE: cannot load", "broken.blend"], 1),
        (["bake", "scene.blend", "--save", "--filter", "best"], ["--filter", "'best'"], 2),
        (["bake", "scene.blend", "--save", "--image", "Pain"], ["'Pain'", "'Paint'"], 1),
        (["bake", "scene.blend", "--save", "--object", "Qua"], ["'Qua'", "'Quad'"], 1),
        (["bake", "scene.blend", "--save", "--levels", "9"], ["Levels: found 9", "1 to 4"], 1),
        (["bake", "quad.obj", "--output", "out.exr"], ["--image: needed", "no image"], 1),
        (["bake", "scene.blend", "--output", "no/out.exr"], ["there is no folder"], 1),
        (["bake", "scene.blend", "--output", "kept.exr"], ["kept.exr", "read-only"], 1),
        (["bake-cache", "quad.obj"], ["FILE: found 'quad.obj'", ".blend"], 2),
    ],
)
def test_command(arguments, words, status, saved):
    before = files(saved)
    assert_fails(run(*arguments, cwd=saved), *words, status=status)
    assert files(saved) == before


@pytest.fixture
def saved(folder):
    """Returns the folder with a .blend file of a good scene, and two others."""
    scenes.textured_quad(scenes.image("Paint", scenes.noise(8, 8)))
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "scene.blend"))
    (folder / "broken.blend").write_bytes(b"BLENDER?")
    (folder / "quad.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")
    return folder
