# SPDX-License-Identifier: GPL-3.0-or-later

"""Numbers in reports."""

import pytest


def test_a_sentence_stores_its_template_and_values(addon):
    wording = addon("core.wording")
    found = wording.Sentence("{} in {}", wording.counted("ab", "file"), "'here {}'")
    assert found == "2 files in 'here {}'"
    assert (found.template, found.values[0].template) == ("{} in {}", "{} files")
    assert str(ValueError(found)).values == found.values


@pytest.mark.parametrize(
    ("number", "expected"),
    [
        (0, "0 triangles"),
        (1, "1 triangle"),
        (999_999, "999999 triangles"),
        (1_600_000, "1.6 million triangles"),
        (1.6e8, "160 million triangles"),
        (2.34e9, "2.34 billion triangles"),
    ],
)
def test_amounts_are_easy_to_read(addon, number: float, expected: str):
    assert addon("core.wording").amount(number, "triangle") == expected
