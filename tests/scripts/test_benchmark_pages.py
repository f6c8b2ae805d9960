# SPDX-License-Identifier: GPL-3.0-or-later

"""Benchmarks: results are data, and the pages follow from them."""

import fnmatch
import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from bench import pages, report  # noqa: E402

RESULTS = sorted(pages.RESULTS.glob("*.json"))
TEXT = {path: path.read_text(encoding="utf-8") for path in pages.pages()}


@pytest.mark.parametrize("page", TEXT, ids=lambda page: str(page.relative_to(pages.DOCS)))
def test_pages_are_what_follows_from_the_results(page):
    # Otherwise, bench/pages.py writes them anew.
    assert pages.rewritten(TEXT[page]) == TEXT[page]


def test_marks_are_closed():
    for page, text in TEXT.items():
        found = re.findall(r"<!-- (?:result|commands|criteria|verdicts)\b", text)
        assert len(found) == len(pages.MARK.findall(text)), page


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.stem)
def test_every_result_is_on_a_page(path):
    """Each table is on a page, or a page names its file."""
    whole = "".join(TEXT.values())
    found = report.decoded(path.read_text(encoding="utf-8"))
    assert {"command", "machine", "date", "commit", "notes", "tables"} == set(found)
    patterns = re.findall(r"`bench/results/([\w*-]+)\.json`", whole)
    is_named = any(fnmatch.fnmatch(path.stem, pattern) for pattern in patterns)
    for name, table in found["tables"].items():
        assert is_named or f"<!-- result: {path.stem} {name} -->" in whole, name
        assert {len(row) for row in table["rows"]} == {len(table["columns"])}


@pytest.mark.parametrize("path", RESULTS, ids=lambda path: path.stem)
def test_commands_start_programs_that_are_there(path):
    for line in report.decoded(path.read_text(encoding="utf-8"))["command"]:
        for program in re.findall(r"(?<![\w/])(?:bench|tests|scripts)/[\w/]+(?:\.py)?", line):
            assert (ROOT / program).is_file() or program == "scripts/run", line
        for module in re.findall(r"-m (bench\.[\w.]+)", line):
            path = ROOT / module.replace(".", "/")
            assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file(), line


def test_each_verdict_leads_to_a_place_and_a_command():
    found = pages._verdicts()
    for verdict in found["verdict"]:
        page, _, place = verdict["link"].partition("#")
        headings = re.findall(r"^#+ (.*)$", TEXT[pages.DOCS / page], re.M)
        places = {re.sub(r"[^\w\- ]", "", one.lower()).replace(" ", "-") for one in headings}
        assert place in places, verdict["link"]
        assert verdict["results"], verdict["text"]
        for name in verdict["results"]:
            commands = pages.result(name)["command"]
            assert all(line in TEXT[pages.DOCS / page] for line in commands), verdict["text"]


def test_links_between_pages_lead_somewhere():
    places = {}
    for page, text in TEXT.items():
        outside_code = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
        headings = re.findall(r"^#+ (.*)$", outside_code, re.M)
        plain = (re.sub(r"[^\w\- ]", "", one.lower()).replace(" ", "-") for one in headings)
        places[page] = set(plain)
    for page, text in (*TEXT.items(), (ROOT / "README.md", (ROOT / "README.md").read_text())):
        for target in re.findall(r"\]\(([^)\s]+)\)", text):
            name, _, place = target.partition("#")
            if "://" in name or name.endswith("/"):
                continue
            other = (page.parent / name).resolve() if name else page
            assert other.exists(), f"{page}: {target}"
            assert not place or place in places[other], f"{page}: {target}"


def written(rows):
    return {"command": ["a"], "tables": {"b": {"title": "c", "columns": ["d", "e"], "rows": rows}}}


@pytest.mark.parametrize(
    "cell", ["0.970", "-3", "1,000", "007", "+0.5", 'a "b"', "", "50 %", "nan"]
)
def test_cells_keep_their_digits(cell):
    text = report.encoded(written([["f", cell]]))
    assert report.decoded(text)["tables"]["b"]["rows"] == [["f", cell or None]]


def test_numbers_are_numbers_in_the_file():
    assert '["f", 0.970]' in report.encoded(written([["f", "0.970"]]))


def test_a_report_becomes_a_result(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(
        sys, "argv", [str(ROOT / "bench/a.py"), "--json", "out.json", "--size", "4"]
    )
    monkeypatch.setattr(sys, "orig_argv", ["python3", *sys.argv])
    made = report.Report()
    made.table("Times, in s", ["name", "s"], [["a", "0.50"]], "times")
    made.table("More of them", ["name"], [["a"]])
    with pytest.raises(ValueError, match="two tables 'times'"):
        made.table("", ["name"], [["a"]], "times")
    made.verdict(False, "a is fast")
    with pytest.raises(SystemExit):
        made.finish(tmp_path / "out.json")
    found = report.decoded((tmp_path / "out.json").read_text())
    assert found["command"] == ["scripts/run python3 bench/a.py --size 4"]
    assert found["notes"] == ["DOES NOT HOLD: a is fast"]
    assert list(found["tables"]) == ["times", "more-of-them"]
    assert found["tables"]["times"]["rows"] == [["a", "0.50"]]
    assert "DOES NOT HOLD" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("started", "expected"),
    [
        (["python3", "-m", "bench.a", "-x", "1"], "scripts/run python3 -m bench.a -x 1"),
        (
            ["blender", "-b", "--python", str(ROOT / "bench/a.py"), "--", "spot", "--json", "b"],
            "scripts/run blender --background --python-exit-code 1 --python bench/a.py -- spot",
        ),
        (
            ["blender", "-b", "--python", "bench/a.py", "--", "--json", "b"],
            "scripts/run blender --background --python-exit-code 1 --python bench/a.py",
        ),
        (
            ["blender", "--enable-event-simulate", "--python", "bench/a.py", "--", "--count", "9"],
            "scripts/run xvfb-run -a blender --enable-event-simulate --python bench/a.py"
            " -- --count 9",
        ),
    ],
)
def test_the_command_is_as_typed(monkeypatch, started, expected):
    monkeypatch.setattr(sys, "orig_argv", started)
    assert report.command() == expected
