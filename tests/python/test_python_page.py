# SPDX-License-Identifier: GPL-3.0-or-later

"""docs/python.md: its signatures are the package's, it names all public ones, and samples run."""

import inspect
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import prefilter
import pytest

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "python.md").read_text(encoding="utf-8")
# What stands before the dot of a method in the tables.
INSTANCES = {
    "surface": prefilter.Surface,
    "octree": prefilter.Octree,
    "shape": prefilter.Shape,
    "table": prefilter.SamplingTable,
}
CALL = re.compile(r"([\w.]+)\((.*)\)")


def spans() -> list[str]:
    """What the first columns of the tables hold as code."""
    rows = re.findall(r"(?m)^\| (`.*?) \| ", PAGE)
    return [span for row in rows for span in re.findall(r"`([^`]+)`", row)]


def owner_of(path: str) -> tuple[object, str]:
    *before, name = path.split(".")
    if not before:
        return prefilter, name
    return INSTANCES.get(before[0]) or getattr(prefilter, before[0]), name


def parameters(function: Callable[..., object], *, is_method: bool) -> list[str]:
    """The names of the parameters, with the star that those after it are given by name."""
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
    """Those that differ from the package's; "..." stands for parameters of the one before."""
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
    code = [*samples(), *re.findall(r"`([^`\n]+)`", PAGE)]
    words = {word for text in code for word in re.findall(r"\w+", text)}
    members = {f"{name}.{member}" for name in prefilter.__all__ for member in public_members(name)}
    assert {name for name in prefilter.__all__ if name not in words} == set()
    assert {name for name in members if name.partition(".")[2] not in words} == set()


def samples() -> list[str]:
    return re.findall(r"(?ms)^```python\n(.*?)^```$", PAGE)


def test_samples_run_one_after_another(tmp_path, monkeypatch):
    """As they are pasted, into an empty session and folder."""
    monkeypatch.chdir(tmp_path)
    scope = {}
    for sample in samples():
        exec(compile(sample, f"docs/python.md: {sample[:40]!r}", "exec"), scope)
    assert len(samples()) >= 8
    assert len(scope["error"]) == 100
    assert scope["words"][1].dtype == np.uint16
    assert sorted(scope["baked"]) == [1001]
    assert scope["octree"].volume == pytest.approx(1.0, rel=1e-6)
    assert scope["drawn"].shape == (1024, 1024, 4)
    assert scope["report"].dropped == 0
    assert (tmp_path / "surface.ply").stat().st_size > 1000
