# SPDX-License-Identifier: GPL-3.0-or-later

"""The photographs of panels in docs/ agree with the present panels."""

import os
import sys
from pathlib import Path

import bpy
import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "docs" / "pictures" / "windows"))

import drawn  # noqa: E402
import pictures  # noqa: E402

VERSION = bpy.app.version[:2]
# A label that changed fails no shorter run: photographs are taken again before a release.
for_all_tests = pytest.mark.skipif(
    not os.environ.get("PREFILTER_TEST_ALL"), reason="compared with PREFILTER_TEST_ALL only"
)
PANELS = [name for name, shown in pictures.CROPPED.items() if shown.since <= VERSION]


def nearest(name):
    """Returns the photograph of a panel in this Blender, or in the latest one before."""
    taken = (pictures.FOLDER / "panels").glob(f"{name}-*.png")
    versions = {
        pictures.version_of(path): path for path in taken if path.stem.rpartition("-")[0] == name
    }
    before = [version for version in versions if version <= VERSION]
    return versions[max(before)] if before else None


@for_all_tests
@pytest.mark.parametrize("name", PANELS)
def test_panels_draw_what_their_photograph_shows(name):
    picture = nearest(name)
    if picture is None:
        pytest.skip("there is no photograph of this Blender or one before")
    compare(picture, pictures.CROPPED[name])


@for_all_tests
@pytest.mark.parametrize("name", pictures.WHOLE)
def test_panels_draw_what_photographs_of_windows_show(name):
    picture = pictures.FOLDER / f"{name}.png"
    taken = tuple(map(int, pictures.read_text(picture)["blender"].split(".")))
    if taken > VERSION:
        pytest.skip("the photograph is of a later Blender")
    compare(picture, pictures.WHOLE[name])


def compare(picture, shown):
    # Where they differ, docs/pictures/windows/photograph takes it again.
    told = pictures.read_text(picture)["drawn"]
    assert drawn.as_text(drawn.drawn(shown.panels)) == drawn.as_text(told), picture


def test_photographs_are_known_and_in_docs():
    text = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs").glob("*.md"))
    for picture in (pictures.FOLDER / "panels").glob("*.png"):
        assert picture.stem.rpartition("-")[0] in pictures.CROPPED, picture
        assert f"pictures/panels/{picture.name}" in text, picture


def test_a_changed_label_is_found():
    before = drawn.drawn(["PREFILTER_PT_bake"])
    label = bpy.types.PREFILTER_PT_bake.bl_label
    changed = [one | {"label": f"{label}s"} for one in before]
    assert drawn.as_text(changed) != drawn.as_text(before)
    assert any(row[0] == "button" for row in before[0]["rows"])
    assert any(row[0] == "setting" and row[1] == "filter" for row in before[0]["rows"])
