# SPDX-License-Identifier: GPL-3.0-or-later

"""Writes the page of the paths from paths.json: a table of their costs, and their steps.

usage: python3 page.py     writes docs/paths.md again
"""

import json
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
DATA = HERE / "paths.json"
PAGE = HERE.parent / "paths.md"
VERSIONS = ("4.3", "5.2")

WHO = {
    "game_artist": ("Game artist", "all maps of a model, from a file just opened", 5),
    "look_dev": ("Look-dev artist", "a texture cache for Cycles, from a file just opened", 4),
    "printer": ("3D printer", "a solid, from a file with a broken mesh", 2),
    "sculptor": ("Sculptor", "a solid of a sculpture, from Sculpt Mode", 3),
    "scanner": ("Scanner", "a surface of a scan that is dropped onto the view", 1),
    "designer": ("Designer", "an image of a text", 3),
    "texture_artist": ("Texture artist", "a facade, straightened", 3),
    "newcomer": ("Newcomer", "a demonstration, from the zip", 4),
}
"""For each path: the user, the goal, and the limit of clicks."""
WITHOUT_EXTENSION = {"newcomer"}
"""Paths of a Blender without the extension, which gets the zip in build/."""
TOLD = "prefilter: path "
"""Prefix of the line with the costs of a path in Blender's output."""
NOT_IN = {("look_dev", "4.3"): "Texture caches came with Blender 5.2."}

_HEAD = """# Paths to a first result

`docs/paths/drive` walks these paths in real windows of Blender 4.3 and 5.2, by mouse and keys, and
writes this page. A click is a press of a mouse button, a drag a press with movement. The wait is
the time until the result is ready. The gap is the longest time without a response of Blender
meanwhile: between two ticks of a timer that should tick every hundredth of a second. Own is the
longest time for which Prefilter blocked the main thread; the rest is Blender, mostly drawing. The
machine had other work and no graphics card, so times are longer than on a desktop. The page shows
the walk with the shortest gap.
"""


def read() -> dict[str, Any]:
    """Returns the recorded costs, by path and version."""
    return json.loads(DATA.read_text(encoding="utf-8")) if DATA.exists() else {}


def keep(name: str, told: dict[str, Any]) -> None:
    """Records the costs of a path if its steps have changed, or its gap is shorter."""
    kept = read()
    version = told.pop("version")
    before = kept.setdefault(name, {}).get(version)
    if before is None or before["steps"] != told["steps"] or told["gap"] < before["gap"]:
        kept[name][version] = told
    write(kept)


def write(kept: dict[str, Any]) -> None:
    """Writes the data, in the order of the page, and the page."""
    ordered = {
        name: {version: kept[name][version] for version in VERSIONS if version in kept[name]}
        for name in WHO
        if name in kept
    }
    DATA.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(text(ordered), encoding="utf-8")


def text(kept: dict[str, Any]) -> str:
    """Returns the page."""
    lines = [
        _HEAD,
        "| Who | Gets | Blender | Clicks | Keys | Drags | Wait (s) | Longest gap (s) | Own (s) |",
        "|---|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    for name, (who, what, _) in WHO.items():
        for version, took in kept.get(name, {}).items():
            numbers = [took[key] for key in ("clicks", "keys", "drags")]
            times = [f"{took[key]:.2f}" for key in ("wait", "gap", "own")]
            lines.append(f"| {' | '.join(map(str, [who, what, version, *numbers, *times]))} |")
    for name, (who, _, _) in WHO.items():
        walks = kept.get(name, {})
        if not walks:
            continue
        lines += ["", f"## {who}", ""]
        latest = list(walks.values())[-1]
        lines.append(f"{latest['start']}")
        lines.append("")
        lines += [f"{i}. {step}" for i, step in enumerate(latest["steps"], start=1)]
        lines += ["", f"{latest['result']}"]
        lines += ["", *(why for (left_out, _), why in NOT_IN.items() if left_out == name)]
    while not lines[-1]:
        lines.pop()
    return "\n".join(lines).replace("\n\n\n", "\n\n") + "\n"


if __name__ == "__main__":
    write(read())
