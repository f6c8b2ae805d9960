# SPDX-License-Identifier: GPL-3.0-or-later

"""The tables of options in docs/ agree with the declarations."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "scripts"))

import option_tables  # noqa: E402


def test_tables_are_up_to_date():
    count = 0
    for page in (ROOT / "docs").glob("*.md"):
        text = page.read_text(encoding="utf-8")
        expected, found = option_tables.rewritten(text)
        count += found
        # Otherwise, scripts/option_tables.py writes them anew.
        assert text == expected, page
    assert count >= 9
