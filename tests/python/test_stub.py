# SPDX-License-Identifier: GPL-3.0-or-later

"""The stubs have the names of the package and of the native module, with the same arguments."""

import ast
import inspect
import re
from pathlib import Path

import prefilter
from prefilter import _native

FOLDER = Path(prefilter.__file__).parent
STUB = ast.parse((FOLDER / "_native.pyi").read_text())


def arguments_in_stub(function):
    return [argument.arg for argument in function.args.args]


def signatures(function):
    """The names of the arguments, for each overload, from what pybind11 writes in docstrings."""
    signature = re.compile(r"(?:\d+\. )?\w+\((.*)\) ->")
    found = [match[1] for match in map(signature.match, function.__doc__.splitlines()) if match]
    # Overloads are listed below a line that says so.
    return [re.findall(r"(?:^|, )(\w+): ", each) for each in found if "*args" not in each]


def public(owner):
    return {name for name in vars(owner) if not name.startswith("_") or name == "__init__"}


def test_names_are_the_same():
    found = {
        getattr(node, "name", None) or node.target.id
        for node in STUB.body
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AnnAssign)
    }
    assert found == {name for name in vars(_native) if not name.startswith("_")}


def test_arguments_are_the_same():
    functions = [node for node in STUB.body if isinstance(node, ast.FunctionDef)]
    for name in {node.name for node in functions}:
        expected = [arguments_in_stub(node) for node in functions if node.name == name]
        assert signatures(getattr(_native, name)) == expected, name


def test_members_are_the_same():
    for node in STUB.body:
        if not isinstance(node, ast.ClassDef) or not node.body[1:]:
            continue
        bound = getattr(_native, node.name)
        methods = [part for part in node.body if isinstance(part, ast.FunctionDef)]
        fields = {part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
        assert {part.name for part in methods} | fields == public(bound), node.name
        assert all(isinstance(inspect.getattr_static(bound, name), property) for name in fields)
        for name in {part.name for part in methods}:
            member = inspect.getattr_static(bound, name)
            expected = [arguments_in_stub(part) for part in methods if part.name == name]
            if not isinstance(member, property):
                assert signatures(member) == expected, f"{node.name}.{name}"


def test_the_package_has_the_names_of_its_stub():
    lines = (FOLDER / "__init__.pyi").read_text().splitlines()
    stub = {
        (match[1], match[2])
        for match in map(re.compile(r"from (\S+) import (\w+) as \2").fullmatch, lines)
        if match
    }
    names = {
        (module, name) for module in prefilter._NAMES for name in prefilter._NAMES[module].split()
    }
    assert stub == names
