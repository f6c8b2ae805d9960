# SPDX-License-Identifier: GPL-3.0-or-later

"""The page of the paths has the measured numbers, and no path takes more clicks than allowed."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "docs" / "paths"))

import page  # noqa: E402


def test_the_page_is_what_was_measured():
    # Otherwise, docs/paths/page.py writes it anew.
    assert page.PAGE.read_text(encoding="utf-8") == page.text(page.read())


@pytest.mark.parametrize("name", page.WHO)
def test_every_path_was_walked_in_both(name):
    walked = {*page.read()[name], *(version for left, version in page.NOT_IN if left == name)}
    assert walked == set(page.VERSIONS)


@pytest.mark.parametrize("name", page.WHO)
def test_no_path_takes_more_clicks(name):
    *_, most = page.WHO[name]
    for version, took in page.read()[name].items():
        assert took["clicks"] <= most, version
        assert took["steps"]
        assert took["keys"] + took["clicks"] + took["drags"] >= len(took["steps"]) - 1
