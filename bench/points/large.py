# SPDX-License-Identifier: GPL-3.0-or-later

"""Streams a file that is larger than the memory allowed, and one of a tenth of its points.

Usage: scripts/run python3 bench/points/large.py FOLDER [--wavelet haar|d4] [--depth N]
                                               [--limit MIB] [--threads N]

FOLDER keeps the points, 2.4 GB and 0.24 GB, and needs as much again and more for temporary files
and the surface. The criteria: the whole process stays below 600 MB, and ten times the points take
at most 1.3 times ten times the processor time. Ends with status 1 where one does not hold.
"""

import argparse
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers.wavelets import Wavelets
from bench.report import Report, add_json_option

ROOT = Path(__file__).resolve().parents[2]
SETS = {"igea_10m": 10, "igea_100m": 100}  # Millions of points.
MOST_BYTES = 600e6
LINEAR_BAR = 1.3


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--wavelet", default="haar", choices=["haar", "d4"])
    parser.add_argument("--depth", type=int, default=11, help="default: %(default)s")
    parser.add_argument("--limit", type=int, default=500, help="default: %(default)s")
    parser.add_argument("--threads", type=int, default=1, help="default: %(default)s")
    add_json_option(parser)
    options = parser.parse_args()
    command = [sys.executable, "-m", "bench.points.sets", str(options.folder), *SETS]
    subprocess.run(command, cwd=ROOT, check=True)
    rows, cpu = [], {}
    for name, millions in SETS.items():
        target = options.folder / "large.ply"
        run = Wavelets(
            options.folder / f"{name}.ply",
            target,
            options.depth,
            {"wavelet": options.wavelet, "memory_limit": options.limit},
            name=name,
            threads=options.threads,
        ).measure()
        cpu[name] = run.cpu_seconds / millions
        size = f"{target.stat().st_size / 1e6:.0f}"
        target.unlink()
        seconds = [f"{value:.1f}" for value in (run.cpu_seconds, run.seconds)]
        rows.append([name, *seconds, f"{1e3 * cpu[name]:.0f}", f"{run.peak_mib:.0f}", size])
    report = Report()
    title = f"{options.wavelet} at depth {options.depth}, memory limit {options.limit} MiB"
    head = ["set", "CPU s", "wall s", "CPU ms / million points", "peak MiB", "surface MB"]
    report.table(title, head, rows, "clouds")
    report.verdict(
        run.peak_mib * 2**20 < MOST_BYTES,
        f"100 M points take {run.peak_mib * 2**20 / 1e6:.0f} MB, the whole process; less than "
        f"{MOST_BYTES / 1e6:.0f} is asked for",
    )
    share = cpu["igea_100m"] / cpu["igea_10m"]
    report.verdict(
        share <= LINEAR_BAR,
        f"their time is {share:.2f} of ten times that of a tenth; at most {LINEAR_BAR} is asked "
        "for",
    )
    report.finish(options.json)


if __name__ == "__main__":
    main()
