# SPDX-License-Identifier: GPL-3.0-or-later

"""Style sheets in files have the same effect as rules in the drawing."""

import base64

import numpy as np
import prefilter
import pytest
from drawings import read, svg
from prefilter.shapes._svg.read import style_rules

BOX = '<rect width="100" height="100" class="a"/>'
GREEN, RED = ".a{fill:green}", ".a{fill:red}"


@pytest.fixture
def color(tmp_path):
    """Writes files, draws `d/drawing.svg`, and returns its color and warnings."""

    def found(files, before="", body=BOX):
        for name, text in {"d/drawing.svg": before + svg(body), **files}.items():
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(text if isinstance(text, bytes) else text.encode())
        result, warnings = prefilter.rasterize_svg(
            tmp_path / "d" / "drawing.svg", 4, 4, dtype=np.uint8
        )
        assert (result == result[0, 0]).all()
        names = {(255, 0, 0): "red", (0, 128, 0): "green", (0, 0, 0): "black", (0, 0, 255): "blue"}
        return names[tuple(result[0, 0, :3].tolist())], [str(each) for each in warnings]

    return found


def instruction(more='href="a.css"'):
    return f"<?xml-stylesheet {more}?>"


def imported(address, media=""):
    return f"<style>@import {address} {media};</style>{BOX}"


LINK = '<link xmlns="http://www.w3.org/1999/xhtml" rel="stylesheet" href="a.css" {}/>'


@pytest.mark.parametrize(
    ("before", "body"),
    [
        (instruction(), BOX),
        (instruction("type='text/css' href='a.css' media='screen'"), BOX),
        ("", LINK.format("") + BOX),
        ("", imported("url(a.css)")),
        ("", imported("'a.css'")),
        ("", imported('url("./a.css")', "screen, print")),
        ("", imported("url(%61.css)")),
        ("", imported("url(../d/a.css)")),
    ],
)
def test_linked_sheets_apply(color, before, body):
    assert color({"d/a.css": GREEN}, before, body) == ("green", [])


@pytest.mark.parametrize(
    ("before", "body"),
    [
        (instruction("href='a.css' media='print'"), BOX),
        (instruction("href='a.css' alternate='yes'"), BOX),
        (instruction("href='a.css' type='text/xsl'"), BOX),
        ("", LINK.format("media='print'") + BOX),
        ("", LINK.format("").replace('"stylesheet"', '"alternate stylesheet"') + BOX),
        ("", LINK.format("").replace('"stylesheet"', '"icon"') + BOX),
        ("", imported("url(a.css)", "print")),
        ("", imported("url(a.css)", "not screen")),
        # Instructions within the drawing are ignored.
        ("", instruction() + BOX),
    ],
)
def test_sheets_for_other_media_do_not_apply(color, before, body):
    assert color({"d/a.css": GREEN}, before, body) == ("black", [])


def test_later_sheets_take_precedence(color):
    both = f"<style>{RED}</style>{LINK.format('')}{BOX}"
    assert color({"d/a.css": GREEN}, "", both)[0] == "green"
    assert color({"d/a.css": GREEN}, "", f"{LINK.format('')}<style>{RED}</style>{BOX}")[0] == "red"
    assert color({"d/a.css": GREEN}, instruction(), f"<style>{RED}</style>{BOX}")[0] == "red"
    # Rules of the importing sheet follow those of the imported one.
    assert color({"d/a.css": f"@import 'b.css';{GREEN}", "d/b.css": RED}, instruction()) == (
        "green",
        [],
    )


def test_imports_are_relative_to_their_sheet(color):
    files = {
        "d/a.css": "@charset 'utf-8'; @import 'in/b.css';",
        "d/in/b.css": "@import url(../in/c.css);",
        "d/in/c.css": "\ufeff" + GREEN,
        "d/c.css": RED,
    }
    assert color(files, instruction()) == ("green", [])


def test_sheets_in_data_addresses(color):
    data = base64.b64encode(GREEN.encode()).decode()
    assert color({}, "", imported(f"url(data:text/css;base64,{data})")) == ("green", [])
    # Data addresses have no folder.
    inner = base64.b64encode(b"@import 'a.css';").decode()
    actual, (warning,) = color({"d/a.css": GREEN}, "", imported(f"url(data:;base64,{inner})"))
    assert actual == "black"
    assert "that has no folder" in warning


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("http://example.org/a.css", "neither in the file nor in its folder"),
        ("//example.org/a.css", "neither in the file nor in its folder"),
        (r"\\\\example.org\\a.css", "neither in the file nor in its folder"),
        ("%5C%5Cexample.org%5Ca.css", "neither in the file nor in its folder"),
        ("%2F%2Fexample.org/share/a.css", "neither in the file nor in its folder"),
        ("c:a.css", "neither in the file nor in its folder"),
        ("file:///etc/passwd", "neither in the file nor in its folder"),
        ("../a.css", "neither in the file nor in its folder"),
        ("in/../../a.css", "neither in the file nor in its folder"),
        ("%2e%2e/a.css", "neither in the file nor in its folder"),
        ("link.css", "neither in the file nor in its folder"),
        ("none.css", "no file 'none.css'"),
        ("in", "no file 'in'"),
        ("a%00.css", "damaged"),
        ("http://[", "damaged"),
        ("data:text/css", "damaged"),
        ("", "no style sheet"),
        ("#a", "no style sheet"),
    ],
)
def test_files_outside_the_folder_are_not_read(color, tmp_path, address, words):
    (tmp_path / "d" / "in").mkdir(parents=True)
    link = tmp_path / "d" / "link.css"
    link.symlink_to(tmp_path / "a.css")
    if address == link.name and not link.is_symlink():
        pytest.skip("Wine makes no links")
    actual, (warning,) = color({"a.css": RED}, "", imported(f'"{address}"'))
    assert actual == "black"
    assert warning.startswith("@import '")
    assert words in warning


def test_circular_imports_end(color):
    files = {"d/a.css": "@import 'b.css';" + GREEN, "d/b.css": "@import 'a.css';" + RED}
    actual, (warning,) = color(files, instruction())
    assert actual == "green"
    assert "imports itself" in warning
    chain = {f"d/{index}.css": f"@import '{index + 1}.css';" for index in range(100)}
    actual, (warning,) = color({**chain, "d/a.css": "@import '0.css';" + GREEN}, instruction())
    assert actual == "green"
    assert "import each other" in warning
    # Ten levels of sheets, each with forty imports of the next.
    many = {f"d/{index}.css": f"@import '{index + 1}.css';" * 40 for index in range(10)}
    actual, warnings = color({**many, "d/a.css": "@import '0.css';" + GREEN}, instruction())
    assert actual == "green"
    assert any("MiB together" in warning for warning in warnings)


def test_large_sheets_are_not_read(color, monkeypatch):
    monkeypatch.setattr(style_rules, "MAX_BYTES", 5000)
    actual, (warning,) = color({"d/a.css": GREEN + " " * 5000}, instruction())
    assert (actual, "larger than" in warning) == ("black", True)
    two = instruction() + instruction('href="b.css"')
    actual, (warning,) = color({"d/a.css": GREEN + " " * 3000, "d/b.css": RED + " " * 3000}, two)
    assert (actual, "together" in warning) == ("green", True)


@pytest.mark.parametrize(
    "data", [b"", b"\xff\xfe\x00", b"\x00" * 100, b"}}}{{{", b"@import", b"@import;", b"@media{"]
)
def test_odd_sheets_are_read(color, data):
    assert color({"d/a.css": data}, instruction(), f"<style>{GREEN}</style>{BOX}")[0] == "green"


def test_imports_after_rules_are_ignored(color):
    actual, (warning,) = color(
        {"d/a.css": GREEN}, "", f"<style>{RED} @import 'a.css';</style>{BOX}"
    )
    assert actual == "red"
    assert "follows other rules" in warning


def test_read_svg_reads_no_files(tmp_path):
    path = tmp_path / "drawing.svg"
    path.write_text(instruction() + svg(BOX))
    (tmp_path / "a.css").write_text(GREEN)
    drawing = prefilter.read_svg(path)
    assert drawing.shapes[0].color == (0.0, 0.0, 0.0, 1.0)
    (warning,) = drawing.warnings
    assert (warning.kind, warning.name) == ("unsupported", "xml-stylesheet 'a.css'")


@pytest.mark.parametrize(
    ("query", "expected"),
    [
        ("screen", "green"),
        ("all", "green"),
        ("ONLY Screen", "green"),
        ("print", "black"),
        ("not print", "green"),
        ("not all", "black"),
        ("print, screen", "green"),
        ("(prefers-color-scheme: light)", "green"),
        ("(prefers-color-scheme:dark)", "black"),
        ("screen and (prefers-color-scheme: dark)", "black"),
        ("not screen and (prefers-color-scheme: dark)", "green"),
        # The query is false, whatever the unknown feature is.
        ("print and (min-width: 1px)", "black"),
        ("screen, (min-width: 1px)", "green"),
    ],
)
def test_media(query, expected):
    body = f"<style>@media {query} {{ {GREEN} }}</style>{BOX}"
    drawing = read(body)
    assert drawing.warnings == ()
    assert drawing.shapes[0].color[1] == (128 / 255 if expected == "green" else 0.0)
    same = f'<style media="{query}">{GREEN}</style>{BOX}'
    assert read(same).shapes[0].color == drawing.shapes[0].color


@pytest.mark.parametrize(
    "query", ["(min-width: 1px)", "not (hover)", "screen (color)", "and", "not", "(", "1px", "a b"]
)
def test_unknown_media_cause_warnings(query):
    drawing = read(f"<style>@media {query} {{ {GREEN} }}</style>{BOX}")
    assert drawing.shapes[0].color == (0.0, 0.0, 0.0, 1.0)
    assert "@media" in drawing.warnings[0].name or drawing.warnings[0].kind == "broken"
