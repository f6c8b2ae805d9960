# SPDX-License-Identifier: GPL-3.0-or-later

"""Comments, docstrings and pages are plain English: few clauses with "what", no fragments."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("addon", "bench", "docs", "examples", "native", "scripts", "tests")
"""Their subfolders, and the pages beside them, are judged one by one."""
MAX_CLAUSES = 1.0
"""The most clauses that begin with "what" and a verb or an article, per 1000 words of a folder."""
MIN_WORDS = 800
"""Fewer words say nothing about a rate; folders with fewer are judged with the one above."""

_CLAUSE = re.compile(
    r"\b[Ww]hat (?:is|are|was|were|has|have|they|it|a|an|the|of|no|others?|there|makes?|stands?"
    r"|goes|comes|lies|takes?|holds?)\b"
)
_FRAGMENT = re.compile(r"(?:^|[.!?]\s+)(?:Of|That of|Those of|But for|Likewise)\b[^.?!]{0,60}")
_LINE = re.compile(r"^[ \t]*(?:///?<?|#)(?: |$)(.*)$")
_TRAILING = re.compile(r"[;,{})]\s+// (.*)$")


def cpp_comments(source: str) -> Iterator[str]:
    """Yields each comment: lines that follow each other are one."""
    yield from _joined(source)
    yield from (match[1] for line in source.splitlines() if (match := _TRAILING.search(line)))


def python_comments(source: str) -> Iterator[str]:
    """Yields docstrings and comments."""
    yield from (" ".join(match.split()) for match in re.findall(r'"""(.*?)"""', source, re.DOTALL))
    yield from _joined(re.sub(r'""".*?"""', "", source, flags=re.DOTALL))


def page_paragraphs(source: str) -> Iterator[str]:
    """Yields the paragraphs of a page, without its code."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", source, flags=re.DOTALL)
    yield from (" ".join(paragraph.split()) for paragraph in text.split("\n\n"))


def _joined(source: str) -> Iterator[str]:
    lines: list[str] = []
    for line in [*source.splitlines(), ""]:
        match = _LINE.match(line)
        if match and not match[1].startswith("SPDX-License-Identifier"):
            lines.append(match[1].strip())
        elif lines:
            yield " ".join(lines)
            lines = []


READERS = {
    ".h": cpp_comments,
    ".cpp": cpp_comments,
    ".py": python_comments,
    ".pyi": python_comments,
    ".md": page_paragraphs,
}


def texts_of_folders() -> dict[str, list[tuple[Path, str]]]:
    """Returns the texts of each folder that has enough words, with their files."""
    files = [path for folder in FOLDERS for path in (ROOT / folder).rglob("*")]
    texts: dict[str, list[tuple[Path, str]]] = {}
    for path in [*sorted(files), *ROOT.glob("*.md")]:
        if path.suffix in READERS and "__pycache__" not in path.parts:
            folder = path.relative_to(ROOT).parent.as_posix()
            for text in READERS[path.suffix](path.read_text(encoding="utf-8")):
                texts.setdefault(folder, []).append((path, text))
    for folder in sorted(texts, key=lambda name: -name.count("/")):
        words = sum(len(text.split()) for _, text in texts[folder])
        if words < MIN_WORDS and "/" in folder:
            texts.setdefault(folder.rsplit("/", 1)[0], []).extend(texts.pop(folder))
    return texts


TEXTS = texts_of_folders()


@pytest.mark.parametrize("folder", sorted(TEXTS))
def test_clauses_with_what_are_few(folder: str) -> None:
    words = sum(len(text.split()) for _, text in TEXTS[folder])
    clauses = [
        f"{path.relative_to(ROOT)}: {text[max(0, match.start() - 40) : match.end() + 40]}"
        for path, text in TEXTS[folder]
        for match in _CLAUSE.finditer(text)
    ]
    assert len(clauses) <= max(1, MAX_CLAUSES * words / 1000), clauses


@pytest.mark.parametrize("folder", sorted(TEXTS))
def test_sentences_have_a_subject(folder: str) -> None:
    fragments = [
        f"{path.relative_to(ROOT)}: {match[0]}"
        for path, text in TEXTS[folder]
        for match in _FRAGMENT.finditer(text)
    ]
    assert not fragments


@pytest.mark.parametrize(
    ("reader", "source", "expected"),
    [
        (
            cpp_comments,
            "// Cells\n// left.\nint a;  // in cells\n",
            ["Cells left.", "in cells"],
        ),
        (python_comments, '"""Returns it."""\n# Why.\nx = "# no"\n', ["Returns it.", "Why."]),
        (page_paragraphs, "One `bit of`\nline.\n\n```\ncode\n```\n", ["One line.", ""]),
    ],
)
def test_readers_find_texts(reader, source: str, expected: list[str]) -> None:
    assert list(reader(source)) == expected
