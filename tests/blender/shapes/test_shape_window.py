# SPDX-License-Identifier: GPL-3.0-or-later

"""Panels, menus and modal operators of shapes, in a window that nobody sees."""

from pathlib import Path

SESSION = Path(__file__).with_name("shape_session.py")


def test_panels_and_modal_operators(found):
    assert found["tab"] == "Prefilter"
    assert found["started"] == found["started_again"] == ["RUNNING_MODAL"]
    assert found["made"] == {"Text": [64, 64]}
    chosen, made = found["redone"]
    assert chosen == made != "box"
    assert found["updated"] == [made]
    assert found["undone"] == {}
    assert found["works"]
    assert found["cancelled"] == {}
    assert found["svg"] == {"drawing": [32, 32]}
    assert found["shown"] == "drawing"


def test_an_image_beside_it_and_a_decal(found):
    assert found["shown beside"] == ["Text", 128, True]
    assert found["decal"] == ["Text.decal", False, "TEXTURE"]
    assert found["offset"]
    assert found["decal undone"] == ["Text"]


def test_a_dropped_file(found):
    """It gets the settings of the panel."""
    assert found["takes_drop"]
    assert found["dropped"] == [48, 40]
