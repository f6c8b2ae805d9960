# SPDX-License-Identifier: GPL-3.0-or-later

"""Every operator is in a menu of an editor's header, where a search (F3) finds it."""

from collections import Counter
from types import SimpleNamespace

import bpy
import pytest


class Layout:
    """Records the entries of a menu."""

    def __init__(self):
        self.operators = []
        self.made = []
        self.menus = []

    def operator(self, name, **_):
        self.operators.append(name)
        self.made.append(SimpleNamespace())
        return self.made[-1]

    def menu(self, name, **_):
        self.menus.append(name)

    def separator(self, **_):
        pass


def drawn(menu, seen=()):
    """Returns the add-on's entries in a menu of Blender, and in its own menus within.

    Skips menus in `seen`, as a search does, and appends those that are drawn.
    """
    layout = Layout()
    shown = getattr(bpy.types, menu).draw
    for draw in getattr(shown, "_draw_funcs", [shown]):
        if "prefilter" in draw.__module__:
            draw(SimpleNamespace(layout=layout), bpy.context)
    for inner in layout.menus:
        if inner in seen:
            continue
        if isinstance(seen, list):
            seen.append(inner)
        layout.operators += drawn(inner, seen)
    return layout.operators


def internal(name):
    """Tells whether an operator is a part of others, such as the menu of presets, and not found."""
    return "INTERNAL" in getattr(bpy.types, f"PREFILTER_OT_{name}").bl_options


def label(name):
    return getattr(bpy.ops.prefilter, name.partition(".")[2]).get_rna_type().name


@pytest.mark.parametrize(
    "menu",
    [
        "VIEW3D_MT_object",
        "VIEW3D_MT_object_context_menu",
        "IMAGE_MT_image",
        "TOPBAR_MT_file_import",
        "TOPBAR_MT_file_export",
    ],
)
def test_each_operator_once(menu):
    assert set(Counter(drawn(menu)).values()) == {1}


def test_the_menu_is_in_sight():
    """At the top of Object, whose end is below the edge of small screens."""
    draws = bpy.types.VIEW3D_MT_object.draw._draw_funcs
    assert "prefilter" in draws[0].__module__
    assert sum("prefilter" in draw.__module__ for draw in draws) == 1


def test_the_images_of_a_material(addon):
    material = bpy.data.materials.new("Wood")
    layout = Layout()
    addon("textures.menus")._draw_material_menu(
        SimpleNamespace(layout=layout), SimpleNamespace(material=material, scene=bpy.context.scene)
    )
    assert layout.operators == ["prefilter.bake_model"]
    assert (layout.made[0].material, layout.made[0].objects) == ("Wood", "scene")
    assert "prefilter.bake_model" not in drawn("MATERIAL_MT_context_menu")


def test_every_operator_is_found():
    found = {
        *drawn("VIEW3D_MT_object"),
        *drawn("IMAGE_MT_image"),
        *drawn("TOPBAR_MT_file_import"),
        *drawn("TOPBAR_MT_file_export"),
    }
    assert found == {f"prefilter.{name}" for name in dir(bpy.ops.prefilter) if not internal(name)}


@pytest.mark.parametrize(
    ("menu", "words"),
    [
        (
            "VIEW3D_MT_object",
            ["mip", "voxel", "boolean", "reconstruct", "texture cache", "rasterize"],
        ),
        (
            "IMAGE_MT_image",
            [
                *("mip", "texel", "preview", "plot", "weights", "fill", "texture cache"),
                *("resize", "rasterize", "svg", "update"),
            ],
        ),
        ("TOPBAR_MT_file_import", ["point cloud", "svg"]),
        ("TOPBAR_MT_file_export", ["export mipmaps", "export all"]),
    ],
)
def test_words_that_users_search_for(menu, words):
    labels = [label(name).lower() for name in drawn(menu)]
    for word in words:
        assert any(word in found for found in labels), word
