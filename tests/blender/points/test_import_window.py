# SPDX-License-Identifier: GPL-3.0-or-later

"""Importing points by the file browser, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("import_session.py")


def test_a_file_of_the_browser(found):
    assert found["not_imported"] == {}
    assert found["imported"] == {"Torus": False}
    assert found["undone"] == {}


def test_import_and_reconstruct_at_once(found):
    assert found["surface"] == {"Torus": True, "Torus.surface": False}
    assert found["adjusted"] == "PREFILTER_OT_reconstruct"


def test_dropped(found):
    """One press more makes an object, or a surface."""
    assert found["takes_I"]
    assert found["dropped_I"] == {"Torus": False}
    assert found["dropped_R"] == {"Torus": True, "Torus.surface": False}


def test_esc(found):
    assert found["works"]
    assert found["cancelled"] == found["dropped_R"]


def test_colors_are_shown(found):
    """Views change only for points that have colors, and if that is wanted."""
    assert found["plain"] == found["colored_False"] == ["SOLID", "MATERIAL"]
    assert found["colored_True"] == ["MATERIAL", "MATERIAL"]
    assert found["surface_colored"] == ["SOLID", "VERTEX"]
