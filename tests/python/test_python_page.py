# SPDX-License-Identifier: GPL-3.0-or-later

"""docs/python.md: its signatures match the package's, and it lists all public names.

Its samples and the ones in docs/python_examples.md run, and use each public name.
"""

import ast
import inspect
import re
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import prefilter
import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGE = (DOCS / "python.md").read_text(encoding="utf-8")
EXAMPLES = (DOCS / "python_examples.md").read_text(encoding="utf-8")
# The names before the dot of methods in the tables.
INSTANCES = {
    "surface": prefilter.Surface,
    "octree": prefilter.Octree,
    "shape": prefilter.Shape,
    "table": prefilter.SamplingTable,
}
CALL = re.compile(r"([\w.]+)\((.*)\)")


def spans() -> list[str]:
    """The code in the first columns of the tables."""
    rows = re.findall(r"(?m)^\| (`.*?) \| ", PAGE)
    return [span for row in rows for span in re.findall(r"`([^`]+)`", row)]


def owner_of(path: str) -> tuple[object, str]:
    *before, name = path.split(".")
    if not before:
        return prefilter, name
    return INSTANCES.get(before[0]) or getattr(prefilter, before[0]), name


def parameters(function: Callable[..., object], *, is_method: bool) -> list[str]:
    """Names of the parameters, with the star before keyword-only ones."""
    found = list(inspect.signature(function).parameters.values())[1 if is_method else 0 :]
    names: list[str] = []
    for each in found:
        if each.kind is each.KEYWORD_ONLY and not any(name.startswith("*") for name in names):
            names.append("*")
        names.append("*" * (each.kind is each.VAR_POSITIONAL) + each.name)
    return names


def of_the_package(path: str) -> list[str]:
    owner, name = owner_of(path)
    if path == "available_memory":  # takes nothing; a builtin, which tells no signature
        return []
    is_method = inspect.isclass(owner) and inspect.isfunction(inspect.getattr_static(owner, name))
    return parameters(getattr(owner, name), is_method=is_method)


def wrong_signatures(told: list[str]) -> list[str]:
    """Signatures that differ from the package's; "..." repeats the previous one's parameters."""
    wrong = []
    before: set[str] = set()
    for path, listed in (match.groups() for match in map(CALL.fullmatch, told) if match):
        names = listed.split(", ") if listed else []
        expected = of_the_package(path)
        if "..." in names:
            is_right = {*names} - {"..."} <= {*expected} <= {*names} | before
        else:
            is_right = names == expected
        if not is_right:
            wrong.append(f"{path}({', '.join(expected)})")
        before = {*expected}
    return wrong


def public_members(name: str) -> set[str]:
    owner = getattr(prefilter, name)
    if not inspect.isclass(owner) or issubclass(owner, Exception):
        return set()
    return {member for member in vars(owner) if not member.startswith("_")}


def test_signatures_are_those_of_the_package():
    assert len(spans()) > 60
    assert not wrong_signatures(spans())


@pytest.mark.parametrize(
    "told",
    [
        ["texel_weights(surface, width, height, *, wrap, progress)"],
        ["texel_weights(surface, width, height, wrap, progress, threads)"],
        ["octree.coarsened(depth, *, threads)"],
        ["to_linear(image, *, threads)", "write_ktx2(..., alpha)"],
    ],
)
def test_wrong_signatures_are_found(told):
    assert len(wrong_signatures(told)) == 1


def test_every_public_name_is_there():
    code = [*samples(PAGE), *re.findall(r"`([^`\n]+)`", PAGE)]
    words = {word for text in code for word in re.findall(r"\w+", text)}
    members = {f"{name}.{member}" for name in prefilter.__all__ for member in public_members(name)}
    assert {name for name in prefilter.__all__ if name not in words} == set()
    assert {name for name in members if name.partition(".")[2] not in words} == set()


def samples(page: str) -> list[str]:
    return re.findall(r"(?ms)^```python\n(.*?)^```$", page)


def used_names(code: Iterable[str]) -> set[str]:
    """The package's names that code uses, as `prefilter.name`."""
    return {
        node.attr
        for sample in code
        for node in ast.walk(ast.parse(sample))
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "prefilter"
    }


def test_every_public_name_has_an_example():
    used = used_names([*samples(PAGE), *samples(EXAMPLES)])
    assert sorted({*prefilter.__all__} - used) == [], "no sample of the pages uses them"


def test_only_code_that_uses_a_name_is_an_example():
    code = ["# prefilter.resize\nprefilter.Octree.load('trim', mipmaps)", "x: prefilter.Surface"]
    assert used_names(code) == {"Octree", "Surface"}


def run_samples(page: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, object]:
    """The scope after pasting all samples, in turn, into an empty session and folder."""
    monkeypatch.chdir(folder)
    scope: dict[str, object] = {}
    for sample in samples(page):
        exec(compile(sample, f"sample: {sample[:40]!r}", "exec"), scope)
    return scope


def test_samples_run_one_after_another(tmp_path, monkeypatch):
    scope = run_samples(PAGE, tmp_path, monkeypatch)
    assert len(samples(PAGE)) >= 8
    assert len(scope["error"]) == 100
    assert scope["words"][1].dtype == np.uint16
    assert sorted(scope["baked"]) == [1001]
    assert scope["octree"].volume == pytest.approx(1.0, rel=1e-6)
    assert scope["drawn"].shape == (1024, 1024, 4)
    assert scope["report"].dropped == 0
    assert (tmp_path / "surface.ply").stat().st_size > 1000


def test_examples_run_one_after_another(tmp_path, monkeypatch):
    """The examples assert their own results."""
    run_samples(EXAMPLES, tmp_path, monkeypatch)
    assert len(samples(EXAMPLES)) >= 20
    assert {"texture.dds", "texture.exr", "ball.ply"} <= {each.name for each in tmp_path.iterdir()}
