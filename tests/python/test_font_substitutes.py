# SPDX-License-Identifier: GPL-3.0-or-later

"""Generic and missing families are replaced as by fontconfig, according to `fc-match`."""

import json
import os
import shutil
import subprocess
import sys

import pytest
from box_fonts import make_font
from prefilter.shapes._fonts import substitutes

pytest.importorskip("tinycss2", reason="the packages that read SVG are not installed")

NAMES = ("sans-serif", "serif", "monospace", "cursive", "fantasy", "system-ui", "Sans", "Serif")
NAMES += ("Monospace", "Arial", "Helvetica", "Times New Roman", "Courier New", "Nowhere", "A-B:c")
FAMILIES = ("Plain", "Feet", "Even", "Pen", "Castle", "Window", "Liberation Sans", "Dash-ed, name")
CONFIGURATION = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "urn:fontconfig:fonts.dtd">
<fontconfig>
  <dir>{fonts}</dir>
  <cachedir>{cache}</cachedir>
  {aliases}
</fontconfig>
"""
ALIASES = {
    **{"sans-serif": "Plain", "serif": "Feet", "monospace": "Even", "cursive": "Pen"},
    **{"fantasy": "Castle", "system-ui": "Window", "Arial": "Liberation Sans"},
    **{"sans": "Plain", "A-B:c": "Dash-ed, name"},
}
# Draws a letter in each family, and prints its width and the warnings.
PROGRAM = """
import json, sys, prefilter
found = {}
def quoted(name):
    return f"'{name}'" if ":" in name else name
for name in json.loads(sys.argv[1]):
    source = (
        '<svg xmlns="http://www.w3.org/2000/svg" width="40" height="40">'
        f'<text y="30" font-size="40" font-family="{quoted(name)}">A</text></svg>'
    )
    shapes = prefilter.read_svg(source)
    (shape,) = shapes.shapes_for(40, 40)
    width = round((shape.bounds[1][0] - shape.bounds[0][0]) * 25)
    found[name] = width, [str(warning) for warning in shapes.warnings]
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """Fonts of a system of its own: each draws A in another width."""
    if sys.platform in ("win32", "darwin") or shutil.which("fc-match") is None:
        pytest.skip("there is no fontconfig")
    folder = tmp_path_factory.mktemp("fontconfig")
    (folder / "fonts").mkdir()
    for number, family in enumerate(FAMILIES):
        path = folder / "fonts" / f"{number}.ttf"
        make_font(path, family=family, widths={"A": 200 + 50 * number}, kerning=False)
    aliases = "".join(
        f'<match><test name="family"><string>{name}</string></test><edit name="family" '
        f'mode="prepend" binding="strong"><string>{family}</string></edit></match>'
        for name, family in ALIASES.items()
    )
    text = CONFIGURATION.format(fonts=folder / "fonts", cache=folder / "cache", aliases=aliases)
    (folder / "fonts.conf").write_text(text)
    # Hides the folders that are searched by default.
    places = {"HOME": str(folder), "XDG_DATA_HOME": str(folder), "XDG_DATA_DIRS": str(folder)}
    return os.environ | places | {"FONTCONFIG_FILE": str(folder / "fonts.conf")}


def widths(environment, names):
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, json.dumps(names)],
        env=environment | {"PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def matched(environment, name):
    """Returns the width of the letter in the font that `fc-match` picks for a family."""
    words = ["fc-match", "--format", "%{family}", f":family={name}".replace("A-B:c", "A-B\\:c")]
    done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
    family = done.stdout
    return 200 + 50 * FAMILIES.index(family), family


def test_families_are_those_of_fontconfig(environment):
    found = widths(environment, NAMES)
    for name in NAMES:
        width, family = matched(environment, name)
        assert found[name][0] == width, name
        warned = any(f"font '{name}': drawn in {family}" in one for one in found[name][1])
        assert warned == (
            name not in substitutes.GENERIC and name.lower() not in substitutes.GENERIC
        )
    assert found["sans-serif"][0] == 200
    assert found["Arial"][0] == 200 + 50 * FAMILIES.index("Liberation Sans")


def test_a_list_of_families(environment):
    """If a family is missing the next one counts, unless fontconfig has an equivalent."""
    found = widths(
        environment, ["Nowhere, Castle", "Arial, Castle", "Nowhere, serif", "Even, Arial"]
    )
    names = {name: width for name, (width, _) in found.items()}
    assert names == {
        "Nowhere, Castle": 200 + 50 * FAMILIES.index("Castle"),
        "Arial, Castle": 200 + 50 * FAMILIES.index("Liberation Sans"),
        "Nowhere, serif": 200 + 50 * FAMILIES.index("Feet"),
        "Even, Arial": 200 + 50 * FAMILIES.index("Even"),
    }


def test_the_real_system_agrees():
    """Uses the installed fonts, whichever they are."""
    if sys.platform in ("win32", "darwin") or shutil.which("fc-match") is None:
        pytest.skip("there is no fontconfig")
    for name in ("sans-serif", "serif", "monospace", "Sans", "Arial"):
        words = ["fc-match", "--format", "%{file}", f":family={name}"]
        done = subprocess.run(words, capture_output=True, text=True, check=True)
        answers = list(substitutes.from_fontconfig(name))
        if not done.stdout:
            assert not answers
        else:
            assert str(answers[0][0]) == done.stdout


def test_without_fontconfig(monkeypatch):
    monkeypatch.setattr(substitutes.shutil, "which", lambda name: None)
    substitutes._query_fontconfig.cache_clear()
    assert list(substitutes.from_fontconfig("sans-serif")) == []
    substitutes._query_fontconfig.cache_clear()
    for platform, first in (("win32", "consolas"), ("darwin", "menlo"), ("linux", "courier new")):
        monkeypatch.setattr(sys, "platform", platform)
        assert substitutes.generic_families("monospace")[0] == first


@pytest.mark.parametrize(
    "name", ["", "-v", "--help", "a\0b", "x" * 10_000, "\\", ":", "a\nb", "\udcff"]
)
def test_odd_names_do_no_harm(name):
    for path, index in substitutes.from_fontconfig(name):
        assert path.name
        assert index >= 0
