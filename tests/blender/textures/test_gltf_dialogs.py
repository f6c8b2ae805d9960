# SPDX-License-Identifier: GPL-3.0-or-later

"""The panels in the dialogs of Blender's glTF exporter and importer."""

import importlib
import sys
from pathlib import Path

import addon_utils
import bpy
import pytest
from conftest import PACKAGE

sys.path.append(str(Path(__file__).resolve().parents[3] / "docs" / "pictures" / "windows"))

import drawn

SESSION = Path(__file__).with_name("gltf_dialog_session.py")


def test_the_panels_take_clicks(found):
    """A setting clicked in each dialog takes effect on a file."""
    assert "KHR_texture_basisu" in found["extensions"]
    assert found["images"]


@pytest.fixture
def exporter():
    """Returns the exporter's module, with the add-on enabled at the end as at the beginning."""
    yield importlib.import_module("io_scene_gltf2")
    assert addon_utils.enable(PACKAGE, default_set=True) is not None


def drawn_rows(draw):
    rows = []
    draw(bpy.context, drawn.Layout(rows))
    return str(rows)


def test_the_exporter_and_the_importer_draw_them(exporter):
    """Draws the panels as the dialogs do, in either way of registering them."""
    assert "use_mipmaps" in drawn_rows(exporter.export_panel_user_extension)
    assert "Prefilter Mipmaps" in drawn_rows(exporter.import_panel_user_extension)


def test_panels_go_with_the_add_on(exporter):
    addon_utils.disable(PACKAGE, default_set=True)
    assert "use_mipmaps" not in drawn_rows(exporter.export_panel_user_extension)
    assert "Prefilter Mipmaps" not in drawn_rows(exporter.import_panel_user_extension)


def test_an_exporter_enabled_later_has_the_panels(exporter, addon):
    exporter.exporter_extension_layout_draw.clear()
    menus = addon("textures.menus")
    menus._draw_export(type("Menu", (), {"layout": drawn.Layout([])}), bpy.context)
    assert drawn_rows(exporter.export_panel_user_extension).count("use_mipmaps") == 1
