# SPDX-License-Identifier: GPL-3.0-or-later

"""Labels and menus' choices fit into a sidebar of Blender's default width."""

import dataclasses
import importlib

import blf
import pytest
from conftest import PACKAGE

translations = importlib.import_module(f"{PACKAGE}.core.translations")
POINTS = 11
"""The size of Blender's letters at a scale of 1."""
LABEL_ROOM, CHOICE_ROOM = 90, 112
"""Pixels beside and in a menu of a sidebar that is 266 wide, measured on photographs."""


@pytest.fixture
def options(addon):
    """Returns all options that a user sees, with the names of their fields."""
    declared, found = addon("core.options").declared, []
    for subject in importlib.import_module(PACKAGE).SUBJECTS:
        choices = addon(f"{subject}.choices")
        for settings in vars(choices).values():
            if dataclasses.is_dataclass(settings) and any(
                "option" in field.metadata for field in dataclasses.fields(settings)
            ):
                found += [(name, default, one) for name, default, one in declared(settings)]
    assert len(found) > 100
    return [one for one in found if one[2].label]


def width(text):
    blf.size(0, POINTS)
    return blf.dimensions(0, text)[0]


def spoken(text):
    """Returns a text in all languages."""
    tables = map(translations.table, translations.LANGUAGES)
    return {text, *(table.get(text) or text for table in tables)}


def test_labels_beside_values_fit(options):
    # Switches have theirs where others have their values, and colors take a whole row.
    beside = {
        label
        for _, default, one in options
        for label in spoken(one.label)
        if not isinstance(default, bool) and one.subtype != "COLOR"
    }
    assert not {label for label in beside if width(label) > LABEL_ROOM}


def test_menu_entries_fit(options):
    labels = {
        label
        for _, _, one in options
        for choice in one.choices.values()
        for label in spoken(choice.label)
    }
    assert not {label for label in labels if width(label) > CHOICE_ROOM}


def test_a_label_that_is_cut_is_known():
    assert width("Minimum Thickness") > LABEL_ROOM
    assert width("Lanczos 3, Covered Texels") > CHOICE_ROOM
