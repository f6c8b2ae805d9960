"""Compares pam-bilinear with maketx --filter lanczos3, in time and memory.

Usage: scripts/run python3 native/bench/compare_maketx.py [--rounds N] [--threads N]

The criterion: on a 1024 x 1024 RGBA picture of the model spot, pam-bilinear from image in memory to
levels in memory takes at most 0.8 of the wall time of maketx on the same picture, with two threads
each. Every round runs each program once, so that what else the machine does falls on all of them
alike; ends with status 1 where the criterion does not hold.
"""

import argparse
import statistics
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from peers import Measurement, Peer, run
from peers.in_memory import InMemory
from peers.maketx import Maketx

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
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        spot = ["--spot", str(options.spot)] if options.spot.is_dir() else []
        _, _, told = run([sys.executable, str(HERE / "scene.py"), name, *spot])
        print(f"{'spot' if spot else 'generated'}, {told.strip()}, {options.threads} threads each")
        ours = InMemory("prefilter", folder, filter="pam-bilinear", threads=options.threads)
        theirs = Maketx(folder / "picture.png", folder, filter="lanczos3", threads=options.threads)
        others = [
            Maketx(folder / "picture.png", folder, filter="box", threads=options.threads),
            InMemory("openimageio", folder, filter="lanczos3", threads=options.threads),
            InMemory("prefilter", folder, filter="lanczos3", threads=options.threads),
        ]
        results = measure([theirs, ours, *others], options.rounds)
    print_table(results, theirs.name)
    ratio = medians_ratio(results[ours.name], results[theirs.name])
    print(
        f"{'holds' if ratio <= LIMIT else 'DOES NOT HOLD'}: '{ours.name}' takes {ratio:.2f} of the "
        f"wall time of '{theirs.name}'; at most {LIMIT} is asked for"
    )
    if ratio > LIMIT:
        raise SystemExit(1)


def measure(peers: Sequence[Peer], rounds: int) -> dict[str, list[Measurement]]:
    """Runs all of them in turn, `rounds` times, after one round that is not counted."""
    results: dict[str, list[Measurement]] = {peer.name: [] for peer in peers}
    for count in range(-1, rounds):
        for peer in peers:
            found = peer.measure()
            if count >= 0:
                results[peer.name].append(found)
        print(f"round {count + 1} of {rounds}", file=sys.stderr, flush=True)
    return results


def print_table(results: dict[str, list[Measurement]], reference: str) -> None:
    """Prints a markdown table; pairs are runs of the same round."""
    print("\n| program | median s | min - max s | of medians | of pairs (min - max) | peak MiB |")
    print("| :--- | ---: | ---: | ---: | ---: | ---: |")
    for name, runs in results.items():
        seconds = [run.seconds for run in runs]
        pairs = [a.seconds / b.seconds for a, b in zip(runs, results[reference], strict=True)]
        peak, start = max(run.peak_mib for run in runs), max(run.start_mib for run in runs)
        cells = [
            name,
            f"{statistics.median(seconds):.3f}",
            f"{min(seconds):.3f} - {max(seconds):.3f}",
            f"{medians_ratio(runs, results[reference]):.2f}",
            f"{statistics.median(pairs):.2f} ({min(pairs):.2f} - {max(pairs):.2f})",
            f"{peak:.0f}" + (f" ({start:.0f} before)" if start else ""),
        ]
        print(f"| {' | '.join(cells)} |")
    print()


def medians_ratio(runs: Sequence[Measurement], others: Sequence[Measurement]) -> float:
    """Returns the ratio of the median times."""
    return statistics.median(run.seconds for run in runs) / statistics.median(
        run.seconds for run in others
    )


if __name__ == "__main__":
    main()
