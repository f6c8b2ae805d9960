# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares pam-bilinear with maketx --filter lanczos3, in time and memory.

Usage: scripts/run python3 bench/textures/compare_maketx.py [--rounds N] [--threads N]

The criterion: on a 1024 x 1024 RGBA picture of the model spot, pam-bilinear from image in memory to
levels in memory takes at most 0.8 of the wall time of maketx on the same picture, with two threads
each. Every round runs each program once, so that what else the machine does falls on all of them
alike; ends with status 1 where the criterion does not hold.
"""

import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import run
from bench.peers.in_memory import InMemory
from bench.peers.maketx import Maketx
from bench.report import Report, add_json_option
from bench.turns import add_table, measure, medians_ratio, named

HERE = Path(__file__).resolve().parent
SPOT = HERE.parents[2] / "shared/data/textured/spot"
LIMIT = 0.8


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=9, help="how often (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="of each (default: %(default)s)")
    parser.add_argument(
        "--spot",
        type=Path,
        default=SPOT,
        help="the folder of the model; where there is none, a picture and a mesh of like size are "
        "made (default: %(default)s)",
    )
    add_json_option(parser)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        spot = ["--spot", str(options.spot)] if options.spot.is_dir() else []
        _, _, told = run([sys.executable, str(HERE / "scene.py"), name, *spot])
        subject = f"{'spot' if spot else 'generated'}, {told.strip()}"
        ours = InMemory("prefilter", folder, filter="pam-bilinear", threads=options.threads)
        theirs = Maketx(folder / "picture.png", folder, filter="lanczos3", threads=options.threads)
        others = [
            Maketx(folder / "picture.png", folder, filter="box", threads=options.threads),
            Maketx(
                folder / "picture.png",
                folder,
                filter="rifman",
                threads=options.threads,
                sharpen=0.5,
            ),
            InMemory("openimageio", folder, filter="lanczos3", threads=options.threads),
            InMemory("prefilter", folder, filter="lanczos3", threads=options.threads),
            InMemory("prefilter", folder, filter="ls-bilinear", threads=options.threads),
        ]
        results = measure(named(theirs, ours, *others), options.rounds)
    report = Report()
    title = f"{subject}, {options.threads} threads each"
    add_table(report, title, results, theirs.name, "times")
    ratio = medians_ratio(results[ours.name], results[theirs.name])
    claim = f"'{ours.name}' takes {ratio:.2f} of the wall time of '{theirs.name}'"
    report.verdict(ratio <= LIMIT, f"{claim}; at most {LIMIT} is asked for")
    report.finish(options.json)


if __name__ == "__main__":
    main()
