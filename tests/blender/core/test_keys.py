# SPDX-License-Identifier: GPL-3.0-or-later

"""Keys at first, and keys that users assign to buttons, in a window that nobody sees."""

import sys
from pathlib import Path

import bpy
from conftest import PACKAGE

SESSION = Path(__file__).with_name("keys_session.py")


def test_keys_clash_with_none_of_blenders(found):
    """Compares with all keymaps that come with Blender."""
    assert found["keys"] == 9
    assert found["clashes"] == {}


def test_a_key_has_the_settings_of_the_panel(found):
    assert found["pressed"] == ["PREFILTER_OT_voxelize", 4]
    assert found["pressed_again"] == ["PREFILTER_OT_voxelize", 3]


def test_keys_are_assigned_in_the_context_menus_of_buttons(found):
    assert found["removed"] == found["assigned_ESC"] == []
    assert found["assigned_K"] == ["Shift Ctrl K"]


def test_buttons_with_settings_of_their_own(found):
    """Blender does not find their keys, and the add-on shows and changes them."""
    assert found["changed"] == ["A"]
    assert "elect All" in found["rivals"][0]
    assert found["taken"] == []


def test_keys_are_in_the_preferences(found):
    assert found["drawn"] == ["PREFERENCES"]


def test_every_key_is_of_an_operator():
    keys = [key for one in sys.modules[PACKAGE]._packages for key in getattr(one, "KEYS", ())]
    assert len({(key.letter, key.keymap) for key in keys}) == len(keys)
    assert {key.operator for key in keys} <= set(dir(bpy.ops.prefilter))
