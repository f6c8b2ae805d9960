# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs the paths of walks.py in Blender on a virtual screen, and records their costs.

usage: python3 drive.py [NAME...]
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import page

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "pictures" / "windows"))

import photograph  # noqa: E402

SIZE = (1280, 800)
MOST_SECONDS = 1500


def main(names: list[str]) -> None:
    """Walks the paths one after another, each in a new Blender."""
    for name in names or list(page.WHO):
        with photograph.screen(*SIZE) as (display, _), tempfile.TemporaryDirectory() as folder:
            costs = measure(name, display, folder)
        if "left_out" not in costs:
            page.keep(name, costs)
        print(name, json.dumps(costs), flush=True)


def measure(name: str, display: str, folder: str) -> dict[str, object]:
    """Returns the costs of a path."""
    environment = {**os.environ, "DISPLAY": display}
    if name in page.WITHOUT_EXTENSION:
        environment["BLENDER_USER_RESOURCES"] = folder
    done = subprocess.run(
        [
            *("blender", "--factory-startup", "--enable-event-simulate", "--window-geometry"),
            *("0", "0", *map(str, SIZE), "--python-exit-code", "1"),
            *("--python", str(HERE / "walks.py"), "--", name, folder),
        ],
        env=environment,
        capture_output=True,
        text=True,
        timeout=MOST_SECONDS,
        check=False,
    )
    for line in done.stdout.splitlines():
        if line.startswith(page.TOLD):
            return dict(json.loads(line.removeprefix(page.TOLD)))
    raise SystemExit(f"{name}: the path did not end\n{done.stdout}\n{done.stderr}")


if __name__ == "__main__":
    main(sys.argv[1:])
