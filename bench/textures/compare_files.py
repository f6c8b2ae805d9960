# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares prefilter with maketx, picture file to mip-mapped file, in time and memory.

Usage: cmake --preset bench && cmake --build build/bench --target prefilter_bake_file
       scripts/run python3 bench/textures/compare_files.py [--size N] [--rounds N] [--threads N]

The criteria, for 8-bit RGBA pictures of 1024 and 4096 texels, two threads each: pam-box takes no
longer than maketx's box, pam-bilinear no longer than its lanczos3, pam-trilinear at most 3 times
that; and pam-bilinear at 4096 no more than 450 MB. They are asked of prefilter_bake_file, in C++ as
maketx is; bake_file.py does the same with the Python package, and shows what Python costs.
Every round runs each program once; ends with status 1 where a criterion does not hold.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import run
from bench.peers.file_to_file import IN_CPP, FileToFile
from bench.peers.maketx import Maketx
from bench.report import Report, add_json_option
from bench.textures.compare_maketx import HERE, SPOT
from bench.turns import add_table, measure, medians_ratio, named

LIMITS = (
    ("pam-box", "box", 1.0),
    ("pam-bilinear", "lanczos3", 1.0),
    ("pam-trilinear", "lanczos3", 3.0),
)
LARGEST_MIB = 450e6 / 2**20


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--size", type=int, default=1024, help="texels (default: %(default)s)")
    parser.add_argument("--rounds", type=int, default=5, help="how often (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="of each (default: %(default)s)")
    add_json_option(parser)
    options = parser.parse_args()
    if not IN_CPP.exists():
        parser.error(f"there is no '{IN_CPP}'; build the target prefilter_bake_file first")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        spot = ["--spot", str(SPOT)] if SPOT.is_dir() else []
        run([sys.executable, str(HERE / "scene.py"), name, *spot])
        picture = folder / "sized.png"
        size = f"{options.size}x{options.size}"
        subprocess.run(
            ["oiiotool", str(folder / "picture.png"), "--resize", size, "-o", str(picture)],
            check=True,
        )
        ours = {
            key: FileToFile(picture, folder, filter=key, threads=options.threads)
            for key, _, _ in LIMITS
        }
        in_python = [
            FileToFile(picture, folder, filter=key, threads=options.threads, python=True)
            for key in ours
        ]
        theirs = {
            key: Maketx(picture, folder, filter=key, threads=options.threads)
            for key in ("box", "lanczos3")
        }
        results = measure(named(*theirs.values(), *ours.values(), *in_python), options.rounds)
    report = Report()
    title = f"{'spot' if spot else 'generated'}, {size} RGBA, {options.threads} threads each"
    add_table(report, title, results, theirs["lanczos3"].name, "times")
    for key, other, limit in LIMITS:
        ratio = medians_ratio(results[ours[key].name], results[theirs[other].name])
        claim = f"{key} takes {ratio:.2f} of the wall time of maketx's {other}"
        report.verdict(ratio <= limit, f"{claim}; at most {limit} is asked for")
    peak = max(found.peak_mib for found in results[ours["pam-bilinear"].name])
    if options.size == 4096:
        report.verdict(peak <= LARGEST_MIB, f"its peak is {peak:.0f} MiB")
    report.finish(options.json)


if __name__ == "__main__":
    main()
