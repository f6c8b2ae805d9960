# SPDX-License-Identifier: GPL-3.0-or-later

"""Any files of a folder can be compiled as one: their internal names differ.

native/compile_together.cmake compiles eight files of a folder at a time, and a new file moves those
after it to other units. So names in nameless namespaces differ within the folder, not only within
today's units.
"""

import re
from collections import defaultdict
from pathlib import Path

import pytest

LIBRARY = Path(__file__).resolve().parents[2] / "native/prefilter"
# A second alias of the same type is no error.
_ALIAS = re.compile(r"\busing\s+(\w+)\s*=\s*([^;]+);")
_TYPE = re.compile(r"(?<![<,\w] )\b(?:struct|class|enum class|enum)\s+(\w+)\s*(?:final\s*)?[:{]")
_CONSTANT = re.compile(r"\bconst(?:expr|init)?\b[^;{}()=]*?\b(k[A-Z]\w*)\s*(?:\[[^]]*\]\s*)?[={(]")
_FUNCTION = re.compile(r"[\w>&*]\s+[&*]?(\w+)\(([^;{}()]*(?:\([^()]*\)[^;{}()]*)*)\)\s*\{")
_COMMENT_OR_TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', re.DOTALL)


def internal_names(source: str) -> set[str]:
    """Returns the names of nameless namespaces; functions with the types of their parameters."""
    code = _COMMENT_OR_TEXT.sub(" ", source)
    names: set[str] = set()
    for match in re.finditer(r"\bnamespace \{", code):
        text = _top_level(code[match.end() :])
        names.update(
            f"{name} = {' '.join(target.split())}" for name, target in _ALIAS.findall(text)
        )
        text = _ALIAS.sub(" ", text)
        names.update(_TYPE.findall(text))
        names.update(_CONSTANT.findall(text))
        names.update(f"{name}({_types(given)})" for name, given in _FUNCTION.findall(text))
    return names


def _top_level(code: str) -> str:
    """Returns a block's text up to its end, without the contents of inner blocks."""
    text, depth = [], 1
    for character in code:
        depth += (character == "{") - (character == "}")
        if depth == 0:
            break
        if depth == 1 or (depth == 2 and character == "{"):
            text.append(character)
    return "".join(text)


def _types(parameters: str) -> str:
    return re.sub(r"\s*\b\w+(?=\s*(?:,|$|=))", "", " ".join(parameters.split()))


def clashes(folder: Path) -> dict[str, list[str]]:
    """Returns the names that several files of a folder define, with these files."""
    files: dict[str, list[str]] = defaultdict(list)
    for path in sorted(folder.glob("*.cpp")):
        for name in internal_names(path.read_text(encoding="utf-8")):
            files[name].append(path.name)
    aliases = {name.split(" = ")[0] for name in files if " = " in name}
    targets: dict[str, set[str]] = defaultdict(set)
    for name in files:
        if " = " in name:
            targets[name.split(" = ")[0]].add(name)
    twice = {name: where for name, where in files.items() if len(where) > 1 and " = " not in name}
    twice |= {name: sorted(targets[name]) for name in aliases if len(targets[name]) > 1}
    return twice


@pytest.mark.parametrize(
    "folder", sorted({path.parent for path in LIBRARY.rglob("*.cpp")}), ids=lambda path: path.name
)
def test_internal_names_differ(folder: Path) -> None:
    assert not clashes(folder)


def test_clashes_are_found(tmp_path: Path) -> None:
    first = "namespace {\nconstexpr int kSide = 4;\nusing Row = int;\nint f(int a) { return a; }\n}"
    other = "namespace {\nconstexpr double kSide = 1;\nusing Row = int;\nint f(float b) {}\n}"
    (tmp_path / "a.cpp").write_text(first)
    (tmp_path / "b.cpp").write_text(other)
    assert clashes(tmp_path) == {"kSide": ["a.cpp", "b.cpp"]}
    (tmp_path / "b.cpp").write_text(first.replace("= int;", "= long;").replace("kSide", "kWidth"))
    assert set(clashes(tmp_path)) == {"Row", "f(int)"}
