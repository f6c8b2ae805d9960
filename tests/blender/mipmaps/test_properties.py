# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings, by what of them is shown."""

from types import SimpleNamespace

import bpy
import pytest


class Layout(SimpleNamespace):
    """Stands for a layout of Blender's, and keeps the names of what it is to show."""

    def __init__(self):
        super().__init__(shown=[])

    def prop(self, data, name, **options):
        self.shown.append(name)

    def prop_search(self, data, name, *arguments):
        self.shown.append(name)

    def separator(self):
        pass

    def row(self, **options):
        return self

    column = row


@pytest.mark.parametrize(
    ("filepath", "is_shown"),
    [("", False), ("//out.exr", False), ("//out.png", False), ("//a.DDS", True), ("b.ktx2", True)],
)
def test_the_texture_format_shows_where_it_matters(filepath, is_shown):
    settings = bpy.context.scene.prefilter_bake
    settings.filepath = filepath
    layout = Layout()
    settings.draw_in(layout)
    assert "filepath" in layout.shown
    assert ("texture_format" in layout.shown) == is_shown


@pytest.mark.parametrize(
    ("filepath", "is_shown"), [("", False), ("//a.dds", False), ("b.KTX2", True)]
)
def test_supercompression_shows_for_ktx2(filepath, is_shown):
    settings = bpy.context.scene.prefilter_bake
    settings.filepath = filepath
    layout = Layout()
    settings.draw_in(layout)
    assert ("supercompression" in layout.shown) == is_shown


def test_the_texture_format_of_a_roughness_file():
    settings = bpy.context.scene.prefilter_bake
    settings.content = "normal"
    settings.roughness = "Rough"
    settings.roughness_filepath = "//rough.dds"
    layout = Layout()
    settings.draw_in(layout)
    assert "texture_format" in layout.shown
    settings.content = "color"
    layout = Layout()
    settings.draw_in(layout)
    assert "texture_format" not in layout.shown
