# SPDX-License-Identifier: GPL-3.0-or-later

"""The allowed imports between the modules of the add-on and of the package."""

import ast
from collections.abc import Collection, Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ADDON = ROOT / "addon"
PACKAGE = ROOT / "native" / "python" / "prefilter"
LAYERS = ("core", "bridge")
SVG = PACKAGE / "shapes" / "_svg"
SVG_FLOORS = ("model", "read", "text", "paint", "filters", "draw")


def modules(folder: Path) -> dict[str, Path]:
    """Returns the files of a package by module name."""
    found = {}
    for path in (*folder.rglob("*.py"), *folder.rglob("*.pyi")):
        names = path.relative_to(folder.parent).with_suffix("").parts
        found[".".join(names[:-1] if names[-1] == "__init__" else names)] = path
    return found


def imports(folder: Path) -> dict[str, set[str]]:
    """Returns the modules of a package that each module imports, including for type checkers."""
    known = modules(folder)
    return {name: set(imported(path, folder, known.keys())) for name, path in known.items()}


def imported(path: Path, folder: Path, known: Collection[str]) -> Iterator[str]:
    package = path.relative_to(folder.parent).parent.parts
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            base = ".".join((*above, *([node.module] if node.module else ())))
            for alias in node.names:
                # Other names come from the package itself.
                name = f"{base}.{alias.name}"
                module = name if name in known else base
                if module in known:
                    yield module


def cycle(graph: dict[str, set[str]]) -> list[str]:
    """Returns a cycle of modules, each of which imports a neighbor; empty if there is none."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return error.args[1]
    return []


def folder_of(name: str) -> str:
    """Returns the folder of the add-on that contains a module; empty for top-level modules."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 and (ADDON / parts[1]).is_dir() else ""


def wrong_imports(graph: dict[str, set[str]]) -> list[str]:
    """Returns forbidden imports: into a higher layer, or into another subject."""
    wrong = []
    for name, others in graph.items():
        for other in others:
            here, there = folder_of(name), folder_of(other)
            if not here or there == here:
                continue
            allowed = {"core": set(), "bridge": {"core"}}.get(here, set(LAYERS))
            if there not in allowed:
                wrong.append(f"{name} imports {other}")
    return sorted(wrong)


def upward_imports(graph: dict[str, set[str]], package: str, floors: tuple[str, ...]) -> list[str]:
    """Returns the imports of higher folders by lower ones; `floors` goes from the lowest up."""
    floor_of = {
        name: floors.index(name.removeprefix(package).split(".")[1])
        for name in graph
        if name.startswith(f"{package}.")
    }
    return sorted(
        f"{name} imports {other}"
        for name, floor in floor_of.items()
        for other in graph[name]
        if floor_of.get(other, -1) > floor
    )


def private_imports(source: str) -> list[str]:
    """Returns the private modules and names of the package that a source file imports."""
    names = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom) and not node.level:
            names += [f"{node.module}.{alias.name}" for alias in node.names]
    return [
        name
        for name in names
        if name.startswith("prefilter.") and any(part[0] == "_" for part in name.split("."))
    ]


def write(folder: Path, files: dict[str, str]) -> Path:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


@pytest.mark.parametrize("folder", [ADDON, PACKAGE], ids=lambda folder: folder.name)
def test_no_import_cycles(folder):
    graph = imports(folder)
    assert sum(map(len, graph.values())) > len(graph)
    assert not cycle(graph)


def test_folders_import_lower_layers_only():
    graph = imports(ADDON)
    assert {folder_of(name) for name in graph} > {"", *LAYERS}
    assert not wrong_imports(graph)


def test_folders_of_svg_import_lower_ones_only():
    assert {path.parent.name for path in SVG.glob("*/*.py")} == set(SVG_FLOORS)
    assert [path.name for path in SVG.glob("*.py")] == ["__init__.py"]
    assert not upward_imports(imports(PACKAGE), "prefilter.shapes._svg", SVG_FLOORS)


def test_the_addon_imports_public_names_of_the_package():
    sources = [path.read_text(encoding="utf-8") for path in ADDON.rglob("*.py")]
    assert any("prefilter.workflows" in source for source in sources)
    assert not [name for source in sources for name in private_imports(source)]


@pytest.mark.parametrize(
    ("line", "is_private"),
    [
        ("from prefilter._native import Octree", True),
        ("from prefilter.files import _staging", True),
        ("def late():\n    import prefilter.files._staging", True),
        ("from prefilter.files import staging", False),
        ("from ._own import name", False),
        ("from _cycles import with_osl", False),
    ],
)
def test_a_private_import_is_found(line, is_private):
    assert bool(private_imports(line)) == is_private


def test_every_subject_is_registered_and_has_only_its_folder():
    (line,) = (
        node
        for node in ast.parse((ADDON / "__init__.py").read_text()).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "SUBJECTS"
    )
    subjects = ast.literal_eval(line.value)
    assert set(subjects) == {path.parent.name for path in ADDON.glob("*/__init__.py")} - {*LAYERS}
    found = {path.name for path in ADDON.glob("*.py")}
    assert found == {"__init__.py", "commands.py", "manual.py", "preferences.py"}


def test_manual_pages_of_subjects_exist():
    named = {
        page
        for path in ADDON.glob("*/__init__.py")
        for node in ast.parse(path.read_text()).body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "MANUAL"
        for page in map(ast.literal_eval, node.value.keys)
    }
    assert named
    assert named <= {path.stem for path in (ROOT / "docs").glob("*.md")}


def test_a_wrong_import_is_found():
    graph = {"addon.core.a": {"addon.bridge.b"}, "addon.textures.c": {"addon.voxels.d", "addon"}}
    assert wrong_imports(graph) == [
        "addon.core.a imports addon.bridge.b",
        "addon.textures.c imports addon",
        "addon.textures.c imports addon.voxels.d",
    ]


def test_an_upward_import_is_found():
    graph = {"a.read.one": {"a.model.two", "a.draw.three", "b"}, "a.model.two": set()}
    graph |= {"a.draw.three": {"a.read.one"}, "a": {"a.draw.three"}, "b": {"a.draw.three"}}
    assert upward_imports(graph, "a", SVG_FLOORS) == ["a.read.one imports a.draw.three"]


@pytest.mark.parametrize(
    "line",
    [
        "from .. import other",
        "from ..other import thing",
        "import box.other",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from ..other import thing",
        "def late():\n    from ..other import thing",
    ],
)
def test_a_cycle_is_found(tmp_path, line):
    files = {"__init__.py": "", "inner/__init__.py": "", "other.py": "from .inner import one"}
    files["inner/one.py"] = line
    found = cycle(imports(write(tmp_path / "box", files)))
    assert sorted(set(found)) == ["box.inner.one", "box.other"]
