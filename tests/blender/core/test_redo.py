# SPDX-License-Identifier: GPL-3.0-or-later

"""Adjust Last Operation, in a window that nobody sees: changing a setting changes the result."""

from pathlib import Path

import pytest

SESSION = Path(__file__).with_name("redo_session.py")


@pytest.mark.parametrize("operands", ["hide", "delete"])
def test_operation_of_a_boolean_changes(found, operands):
    told = found[operands]
    assert told["volume"] == pytest.approx(4.0, rel=0.1)
    assert told["operation"] in {"union", "intersection"}
    expected = {"union": 12.0, "intersection": 4.0}[told["operation"]]
    assert told["volume_after"] == pytest.approx(expected, rel=0.1)
    assert told["undone"] == {"First": 8, "Other": 8}


def test_depth_of_a_volume_changes(found):
    assert found["volume"] == [5, 6]


def test_slow_settings_wait_for_apply(found):
    told = found["apply"]
    assert told["waits"] == told["before"]
    assert told["running"] == ["PREFILTER_OT_voxelize"]
    assert told["while_running"] == told["before"]
    assert told["after"] > 2 * told["before"]
    assert told["depth"] == 6
    assert told["undone"] == 642


def test_esc_leaves_result_and_settings(found):
    told = found["esc"]
    assert told["after"] == told["before"]
    assert told["depth"] == 7
    assert told["operators"] == ["PREFILTER_OT_voxelize"]
    assert not told["staged"]


def test_bake_waits_for_apply(found):
    told = found["bake"]
    assert told["content"] == "data"
    assert told["waits"] == told["before"]
    assert told["after"] != pytest.approx(told["before"], rel=0.01)
    assert told["frame"] == 1


def test_esc_asks_where_much_would_be_lost(found):
    """Esc opens the question, a second one closes it, and the work goes on; Return ends it."""
    assert found["asks"][:2] == [["PREFILTER_OT_bake_mipmaps"]] * 2


def test_first_click_after_esc_counts(found):
    assert found["click_after_esc"] == ["PREFILTER_OT_bake_mipmaps"]
