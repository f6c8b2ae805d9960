# SPDX-License-Identifier: GPL-3.0-or-later

"""The source distribution for pip, and the package's metadata in pyproject.toml."""

import fnmatch
import re
import subprocess
import tomllib
from pathlib import Path

import sdist
from packager.project import description

CHECKOUT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["project"]
SETTINGS = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["tool"]["scikit-build"]
MANIFEST = tomllib.loads((CHECKOUT / "blender_manifest.toml").read_text())
VERSION = MANIFEST["version"]


def laid_out(folder: Path) -> Path:
    library = folder / "cache/some-1.2"
    (library / "src").mkdir(parents=True)
    for name in ("LICENSE.txt", "NOTICE.txt", "src/a.c"):
        (library / name).write_text(name)
    pybind11 = folder / "pybind11-3.0.dist-info"
    (pybind11 / "licenses").mkdir(parents=True)
    (pybind11 / "licenses/LICENSE").write_text("terms of pybind11")
    return sdist.lay_out(folder / "made", pybind11, [library])


def test_it_holds_sources_and_licenses(tmp_path: Path) -> None:
    tree = laid_out(tmp_path)
    held = {path.relative_to(tree).as_posix() for path in tree.rglob("*") if path.is_file()}
    assert {
        "third_party/some-1.2/LICENSE.txt",
        "third_party/some-1.2/src/a.c",
        "third_party/pybind11-3.0/LICENSE.txt",
        "scripts/sources.toml",
    } <= held
    assert not any("__pycache__" in name for name in held)
    command = ("git", "-C", str(CHECKOUT), "ls-files", "native", "tests/python")
    listed = subprocess.run(command, capture_output=True, text=True).stdout.split()
    assert {name for name in listed if (CHECKOUT / name).exists()} <= held
    patterns = tomllib.loads((tree / "pyproject.toml").read_text())["project"]["license-files"]
    licensed = {name for pattern in patterns for name in fnmatch.filter(held, pattern)}
    assert licensed == {name for name in held if re.search(r"LICENSE|NOTICE", name)}
    assert PROJECT["readme"] in held


def test_what_pypi_shows_leads_nowhere_else(tmp_path: Path) -> None:
    text = (laid_out(tmp_path) / "README.md").read_text()
    assert text.startswith("# Prefilter\n")
    assert len(text) > 1000
    assert "![" not in text
    assert re.findall(r"\]\((?!https://)", text) == []
    example = text.partition("```python\n")[2].removesuffix("```\n")
    compile(example, "the example", "exec")
    assert "import prefilter" in example


def test_a_link_becomes_its_text(tmp_path: Path) -> None:
    (tmp_path / "docs").mkdir()
    (tmp_path / "README.md").write_text(
        "# A\n\n![a\nb](c.png)\n\n*What\nit is.*\n\nSee [one page](docs/one.md#x), [two](https://x.y)."
        "\n\n## More\n\nNot here.\n"
    )
    (tmp_path / "docs/python.md").write_text("# Use\n\n```python\n1\n```\n\n```python\n2\n```\n")
    expected = "# A\n\nSee one page, [two](https://x.y).\n\n```python\n1\n```\n"
    assert description(tmp_path) == expected


def test_the_version_is_written_once() -> None:
    written = SETTINGS["metadata"]["version"]
    found = re.search(written["regex"], (CHECKOUT / written["input"]).read_text())
    assert found
    assert found["value"] == VERSION
    assert "version" not in PROJECT
    assert "version" in PROJECT["dynamic"]
    sources = [CHECKOUT / "CMakeLists.txt", CHECKOUT / "pyproject.toml"]
    for folder in ("native", "addon"):
        sources += [path for path in (CHECKOUT / folder).rglob("*") if path.is_file()]
    sources = [path for path in sources if "__pycache__" not in path.parts]
    assert [path for path in sources if f'"{VERSION}"' in path.read_text()] == []


def test_the_manifest_says_the_same() -> None:
    assert PROJECT["name"] == MANIFEST["id"]
    assert PROJECT["description"] == MANIFEST["tagline"]
    assert PROJECT["urls"]["Homepage"] == MANIFEST["website"]
    assert [author["name"] for author in PROJECT["authors"]] == [MANIFEST["maintainer"]]
    assert [f"SPDX:{PROJECT['license']}"] == MANIFEST["license"]


def test_tags_name_the_pythons_that_are_allowed() -> None:
    minimum = PROJECT["requires-python"].removeprefix(">=")
    named = [
        item.rpartition(" :: ")[2]
        for item in PROJECT["classifiers"]
        if re.search(r":: 3\.\d+$", item)
    ]
    assert named[0] == minimum
    assert f"Python :: {minimum}" in "\n".join(PROJECT["classifiers"])


def test_one_compiler_makes_all_wheels() -> None:
    wheels = tomllib.loads((CHECKOUT / "pyproject.toml").read_text())["tool"]["cibuildwheel"]
    pinned = re.findall(r"ziglang==\S+", (CHECKOUT / "scripts/toolchain.txt").read_text())
    assert re.findall(r"ziglang==\S+", wheels["before-build"]) == pinned
    platforms = tomllib.loads((CHECKOUT / "scripts/platforms.toml").read_text())
    targets = {one["target"] for one in platforms.values() if isinstance(one, dict)}
    for override in wheels["overrides"]:
        for name, part in (("CC", "cc"), ("CXX", "c++")):
            command = override["environment"][name]
            assert command.startswith(f"python -m ziglang {part} -target ")
            assert command.split()[-1] in targets
