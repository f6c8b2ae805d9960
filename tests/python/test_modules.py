"""The package's modules stand on one another: none imports one that imports it."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import prefilter

FOLDER = Path(prefilter.__file__).parent


def name_of(path):
    parts = path.relative_to(FOLDER.parent).with_suffix("").parts
    return parts[:-1] if parts[-1] == "__init__" else parts


def imports(path, modules):
    """The modules that one imports from its own package, for types or at any other time."""
    package = path.relative_to(FOLDER.parent).parts[:-1]
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level > 0:
            base = package[: len(package) - node.level + 1]
            source = base + tuple(node.module.split(".") if node.module else ())
            for alias in node.names:
                found = (*source, alias.name)
                yield found if found in modules else source


def test_no_two_modules_import_each_other():
    paths = [*FOLDER.rglob("*.py"), *FOLDER.rglob("*.pyi")]
    modules = {name_of(path): path for path in paths}
    graph = {name: set(imports(path, modules)) for name, path in modules.items()}
    assert ("prefilter", "_border", "arguments") in graph[("prefilter", "surface")]
    assert all(source in modules for sources in graph.values() for source in sources)
    list(TopologicalSorter(graph).static_order())  # Raises CycleError, which names the modules.
