# SPDX-License-Identifier: GPL-3.0-or-later

"""No call to functions whose last bits differ between C libraries, processors or NumPys.

The C++ library and the package have elementary functions of their own; tests/native/hashes
compares their results.
"""

import ast
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from prefilter import _native

NATIVE = Path(__file__).resolve().parents[2] / "native"
OURS = NATIVE / "include/prefilter/base/elementary.h"
FUNCTIONS = (
    "a?(?:sin|cos|tan)h?|atan2|exp|exp2|expm1|log|log2|log10|log1p|pow|cbrt|hypot|erfc?|[lt]gamma"
)
_CALL = re.compile(rf"(?<![\w.>])(?:(\w*)::)?((?:{FUNCTIONS})[fl]?)\s*\(")
_COMMENT_OR_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:[^\"\\\n]|\\.)*\"", re.DOTALL)
_OTHERS = re.compile(
    r"\blong double\b|\bfma[fl]?(?=\s*\()"
    r"|std::\w+_distribution\b|std::(?:shuffle|sample|hash|reduce)\b|\bqsort\b"
)
# Functions of Python's math and NumPy; matrix products are left to BLAS, whose summation order
# differs.
_PYTHON = re.compile(rf"{FUNCTIONS}|arc(?:sin|cos|tan)h?|arctan2|power|float_power|dist|sumprod")
_MATRICES = {"dot", "vdot", "inner", "matmul", "einsum", "tensordot", "linalg", "fft", "random"}


def _calls_in_cpp(source: str) -> Iterator[str]:
    code = _COMMENT_OR_TEXT.sub(" ", source)
    for match in _CALL.finditer(code):
        if match[1] != "elementary":
            yield match[0]
    yield from _OTHERS.findall(code)


def _calls_in_python(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
            yield "@"
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            known = node.value.id in ("math", "np")
            if known and (_PYTHON.fullmatch(node.attr) or node.attr in _MATRICES):
                yield f"{node.value.id}.{node.attr}"


def test_the_module_asks_the_c_library_for_none() -> None:
    program = shutil.which("nm")
    if program is None or not _native.__file__.endswith(".so"):
        pytest.skip("nm lists what a module of Linux asks for; there is none here")
    listed = subprocess.run(
        (program, "--dynamic", "--undefined-only", "--without-symbol-versions", _native.__file__),
        check=True,
        capture_output=True,
        text=True,
    ).stdout
    names = {line.split()[-1] for line in listed.splitlines()}
    assert "malloc" in names
    assert not {name for name in names if re.fullmatch(rf"(?:{FUNCTIONS}|sincos)[fl]?", name)}


def test_cpp_calls_elementary_functions_of_its_own() -> None:
    folders = ("include/**/*", "prefilter/**/*", "python/*")
    paths = [path for folder in folders for path in NATIVE.glob(folder)]
    sources = sorted(path for path in paths if path.suffix in (".h", ".cpp") and path != OURS)
    found = [f"{path}: {call}" for path in sources for call in _calls_in_cpp(path.read_text())]
    assert sources
    assert not found


def test_python_calls_elementary_functions_of_its_own() -> None:
    sources = sorted((NATIVE / "python/prefilter").rglob("*.py"))
    found = [f"{path}: {call}" for path in sources for call in _calls_in_python(path.read_text())]
    assert sources
    assert not found


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("a = std::sin(x);", ["std::sin("]),
        ("a = sin(x);", ["sin("]),
        ("a = powf(x, 2.0F);", ["powf("]),
        ("a = elementary::sin(x) + sink(x) + table.log(x) + std::sqrt(x); // std::sin(x)", []),
        ("a = std::fma(x, y, z);", ["fma"]),
        ("std::uniform_real_distribution<double> u;", ["std::uniform_real_distribution"]),
    ],
)
def test_calls_in_cpp_are_found(source: str, expected: list[str]) -> None:
    assert list(_calls_in_cpp(source)) == expected


@pytest.mark.parametrize(
    ("source", "expected"),
    [
        ("math.hypot(x, y)", ["math.hypot"]),
        ("np.arctan2(y, x)", ["np.arctan2"]),
        ("a @ b", ["@"]),
        ("np.linalg.det(a)", ["np.linalg"]),
        ("math.sqrt(x) + np.floor(y) + _native.sin(x)", []),
    ],
)
def test_calls_in_python_are_found(source: str, expected: list[str]) -> None:
    assert list(_calls_in_python(source)) == expected
