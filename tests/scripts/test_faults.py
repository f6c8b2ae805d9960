# SPDX-License-Identifier: GPL-3.0-or-later

"""The list of faults that tests are to see: each can be planted, and names tests that are there."""

import fnmatch
import re
from pathlib import Path

import plant_faults
import pytest

ROOT = Path(__file__).resolve().parents[2]
FAULTS = plant_faults.read_faults()


def test_every_fault_can_be_planted():
    for fault in FAULTS:
        text = (ROOT / fault.file).read_text(encoding="utf-8")
        changed = plant_faults.planted(text, fault)
        assert changed != text
        assert changed.count("\n") == text.count("\n")


def test_every_test_is_there():
    sources = (ROOT / "tests" / "native").rglob("*_test.cpp")
    text = "".join(path.read_text(encoding="utf-8") for path in sources)
    suites = set(re.findall(r"^TEST(?:_[FP])?\((\w+),", text, re.MULTILINE))
    for fault in FAULTS:
        for name in filter(None, fault.native.split(":")):
            assert fnmatch.filter(suites, name.split(".")[0]), fault
        for tests in filter(None, (fault.python, fault.blender)):
            assert (ROOT / tests.split()[0]).exists(), fault


def test_at_least_fifty_over_all_rooms():
    assert len(FAULTS) >= 50
    rooms = {Path(fault.file).parent.name for fault in FAULTS}
    library = {path.name for path in (ROOT / "native" / "prefilter").iterdir() if path.is_dir()}
    assert library <= rooms


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('old = "a"\nnew = "b"', "needs native, python or blender"),
        ('old = "a"\nnew = "b"\nnative = "A.*"\nblender = "b"', "needs native, python or"),
        ('old = "a"\nnew = "a"\nnative = "A.*"', "is not one line that changes"),
        ('old = "a\\nb"\nnew = ""\nnative = "A.*"', "is not one line that changes"),
    ],
)
def test_lists_that_are_refused(tmp_path, text, message):
    path = tmp_path / "faults.toml"
    path.write_text(f'[[fault]]\nfile = "x.cpp"\n{text}\n', encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        plant_faults.read_faults(path)


def test_a_line_that_is_there_twice_is_refused():
    fault = plant_faults.Fault("x.cpp", "a", "b", native="A.*")
    with pytest.raises(ValueError, match="is there 2 times"):
        plant_faults.planted("a\na\n", fault)
    assert plant_faults.planted("a\nc\n", fault) == "b\nc\n"
