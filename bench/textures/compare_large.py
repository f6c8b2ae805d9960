# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares bakes of a large image, and of many in tiles, with the bakes of another checkout.

Usage: python3 bench/textures/compare_large.py FOLDER --before CHECKOUT [--cache] [--rounds N]

FOLDER keeps the scenes; large_scene.py makes them. An image of 8192 x 8192 bytes is baked to an
OpenEXR file in Blender 4.3, or with --cache 120 images of 12 UDIM sets, on 300 objects, into the
texture cache of Blender 5.2. Every round runs each checkout once, in a new process. Both need the
extension, which scripts/run installs.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import Measurement
from bench.peers.clock import MARK
from bench.report import Report, add_json_option

HERE = Path(__file__).resolve()
SCENE = HERE.with_name("large_scene.py")


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="keeps the scenes")
    parser.add_argument("--before", type=Path, required=True, help="the other checkout")
    parser.add_argument("--cache", action="store_true", help="bake into the texture cache")
    parser.add_argument("--size", type=int, default=8192, help="(default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=3, help="how often (default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    checkouts = {"before": options.before.resolve(), "now": HERE.parents[2]}
    suite = "sid" if options.cache else "trixie"
    folder = options.folder.resolve() / ("ship" if options.cache else str(options.size))
    work = "bake-cache" if options.cache else "bake"
    if not folder.exists():
        folder.mkdir(parents=True)
        making = ["make-ship"] if options.cache else ["make-picture", str(options.size)]
        blender(checkouts["now"], suite, *making, str(folder))
    found: dict[str, list[Measurement]] = {name: [] for name in checkouts}
    for count in range(options.rounds):
        for name, checkout in checkouts.items():
            found[name].append(clocked(blender(checkout, suite, work, str(folder))))
        print(f"round {count + 1} of {options.rounds}", file=sys.stderr, flush=True)
    rows = []
    for name, runs in found.items():
        cpu = [run.cpu_seconds for run in runs]
        wall = statistics.median(run.seconds for run in runs)
        peak = max(run.peak_mib for run in runs)
        around = f"{min(cpu):.1f} - {max(cpu):.1f}"
        rows.append([name, f"{statistics.median(cpu):.1f}", around, f"{wall:.1f}", f"{peak:.0f}"])
    report = Report()
    head = ("checkout", "CPU s, median", "min - max", "wall s, median", "peak MiB")
    report.table(f"{work}, {folder.name}", head, rows, "times")
    report.write(options.json)


def blender(checkout: Path, suite: str, *arguments: str) -> str:
    """Runs large_scene.py in Blender with the extension of a checkout; returns its output."""
    program = [str(checkout / "scripts/run"), "blender", "--background", "--python", str(SCENE)]
    return subprocess.run(
        [*program, "--", *arguments],
        env={**os.environ, "PREFILTER_SUITE": suite},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    ).stdout


def clocked(printed: str) -> Measurement:
    """Returns the measurements; raises OSError if the bake failed."""
    for line in printed.splitlines():
        if line.startswith(MARK):
            return Measurement(**json.loads(line.removeprefix(MARK)))
    raise OSError(f"no measurement in: {printed}")


if __name__ == "__main__":
    main()
