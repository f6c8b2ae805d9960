# SPDX-License-Identifier: GPL-3.0-or-later

"""Hooks of mkdocs.yml: the site's navigation, from docs/README.md, and the job templates."""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
from mkdocs.structure.files import File
from packager.navigation import Entry, sections

# Job templates ship with the extension, and stand in the site where pages link to them.
_TEMPLATES = Path(__file__).resolve().parents[1] / "addon" / "farm"
_IN_SOURCE, _IN_SITE = "](../addon/farm/", "](job_templates/"

# Pages below another are listed there.
_BELOW = "benchmarks"


def on_config(config: Any) -> Any:
    """Sets the navigation."""
    docs = Path(config["docs_dir"])
    found: list[dict[str, Any]] = [{"Start": "README.md"}]
    for title, groups in sections((docs / "README.md").read_text(encoding="utf-8")):
        parts: list[Any] = []
        for group, entries in groups.items():
            listed = [_item(entry, docs) for entry in entries]
            parts += [{group: listed}] if group else listed
        found.append({title: parts})
    config["nav"] = found
    return config


def on_files(files: Any, config: Any) -> Any:
    """Adds the job templates."""
    for path in sorted(_TEMPLATES.rglob("*.*")):
        uri = f"job_templates/{path.relative_to(_TEMPLATES).as_posix()}"
        files.append(File.generated(config, uri, abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Has links lead to the job templates of the site."""
    return markdown.replace(_IN_SOURCE, _IN_SITE)


def _item(entry: Entry, docs: Path) -> dict[str, Any]:
    if entry.page != _BELOW:
        return {entry.title: f"{entry.page}.md"}
    below = sorted((docs / entry.page).glob("*.md"))
    return {entry.title: [f"{entry.page}.md", *(f"{entry.page}/{each.name}" for each in below)]}
