# SPDX-License-Identifier: GPL-3.0-or-later

"""The files that docs/architecture.md names exist."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
# Paths on the page are below one of these.
FOLDERS = (
    *(".", "native/prefilter", "native/python/prefilter", "addon", "addon/textures", "native"),
    *("addon/points", "native/prefilter/points/scan", "native/prefilter/textures/blocks"),
)
PATHS = sorted(set(re.findall(r"`([\w./]+\.(?:py|pyi|h|cpp|toml|txt))`", PAGE)))


@pytest.mark.parametrize("path", PATHS)
def test_files_on_the_page_exist(path):
    assert any((ROOT / folder / path).is_file() for folder in FOLDERS), path


def test_the_page_names_files():
    assert len(PATHS) > 50
