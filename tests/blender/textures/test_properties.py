# SPDX-License-Identifier: GPL-3.0-or-later

"""The settings that panels show."""

import dataclasses
from types import SimpleNamespace

import bpy
import pytest


class Layout(SimpleNamespace):
    """A stand-in for Blender's layout with all panels open; records the names of properties."""

    def __init__(self):
        super().__init__(shown=[], panels=[])

    def prop(self, data, name, **options):
        self.shown.append(name)

    def prop_search(self, data, name, *arguments):
        self.shown.append(name)

    def label(self, **options):
        pass

    def row(self, **options):
        return self

    column = row

    def panel(self, name, *, default_closed):
        assert default_closed
        self.panels.append(name)
        return self, self


def shown(settings):
    layout = Layout()
    settings.draw_in(layout)
    return layout.shown


@pytest.mark.parametrize(
    ("result", "file_format", "texture_format", "supercompression"),
    [
        ("images", "ktx2", False, False),
        ("preview", "dds", False, False),
        ("file", "exr", False, False),
        ("file", "png", False, False),
        ("file", "dds", True, False),
        ("file", "ktx2", True, True),
    ],
)
def test_the_dialog_shows_settings_of_the_format(
    result, file_format, texture_format, supercompression
):
    settings = bpy.context.scene.prefilter_bake
    settings.result, settings.file_format = result, file_format
    names = shown(settings)
    assert ("filepath" in names) == ("file_format" in names) == (result == "file")
    of_formats = {"texture_format", "effort", "use_multiples_of_4"}
    assert of_formats & set(names) == (of_formats if texture_format else set())
    assert ("supercompression" in names) == supercompression


def test_etc1s_has_a_quality_in_place_of_a_compression():
    settings = bpy.context.scene.prefilter_bake
    settings.result, settings.file_format = "file", "ktx2"
    for texture_format, present, absent in (
        ("etc1s", "quality", "supercompression"),
        ("uastc", "supercompression", "quality"),
    ):
        settings.texture_format = texture_format
        names = shown(settings)
        assert present in names
        assert absent not in names
    settings.texture_format, settings.file_format = "etc1s", "dds"
    assert "quality" not in shown(settings)
    settings.quality = 31
    assert settings.to_settings().quality == 31


def test_the_file_of_a_roughness_image():
    settings = bpy.context.scene.prefilter_bake
    settings.result, settings.content, settings.roughness = "file", "normal", "Rough"
    assert "roughness_filepath" in shown(settings)
    assert settings.to_settings().roughness_filepath.endswith("{name}.ktx2")
    settings.result = "images"
    assert "roughness_filepath" not in shown(settings)
    settings.result, settings.content = "file", "color"
    assert "roughness_filepath" not in shown(settings)
    assert settings.to_settings().roughness_filepath == ""


@pytest.mark.parametrize("name", ["prefilter_bake", "prefilter_model"])
def test_everything_is_shown_once(name):
    settings = getattr(bpy.context.scene, name)
    settings.result = "file"
    if name == "prefilter_bake":
        settings.content, settings.roughness = "normal", "Rough"
    names = shown(settings)
    assert len(names) == len(set(names))
    declared = {*type(settings).__annotations__, *dir(settings)} & set(names)
    own = {one.identifier for one in settings.bl_rna.properties if not one.is_hidden}
    missing = own - set(names) - {"rna_type", "name"}
    assert missing == ({"quality", "threshold"} if name == "prefilter_bake" else {"quality"})
    assert declared == set(names)


def test_panels_are_told_apart():
    """Blender remembers by the name which panels of a region are open."""
    names = []
    for group in ("prefilter_bake", "prefilter_model", "prefilter_voxelize", "prefilter_boolean"):
        layout = Layout()
        getattr(bpy.context.scene, group).draw_in(layout)
        names += layout.panels
    layout = Layout()
    bpy.context.scene.prefilter_reconstruct.draw_in(layout)
    bpy.context.scene.prefilter_rasterize.draw_in(layout, "curves")
    names += layout.panels
    assert len(names) == len(set(names)) > 10


def test_the_preview_shows_what_a_bake_of_all_images_makes(addon):
    """Both editors share the settings of levels; each has its own destination of results."""
    choices = addon("textures.choices")
    one, all_images = bpy.context.scene.prefilter_bake, bpy.context.scene.prefilter_model
    one.filter, one.wrap, one.importance, one.bounds = "box", "repeat", "Weight", "none"
    all_images.reader, all_images.seam_budget, all_images.use_frames = "srgb-after", 0.5, True
    _, made = all_images.to_settings()
    shown = one.to_settings()
    of_files = {"filepath", "texture_format", "effort", "supercompression", "quality"}
    own = {*choices.NOT_OF_MODELS, "use_images", "use_multiples_of_4", *of_files}
    fields = {field.name for field in dataclasses.fields(choices.Settings)} - own
    assert {name: getattr(made, name) for name in fields} == {
        name: getattr(shown, name) for name in fields
    }
    assert (made.filter, shown.reader, shown.seam_budget) == ("box", "srgb-after", 0.5)
