# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs peers in turns, so that other load on the machine affects all of them alike."""

import statistics
import sys
from collections.abc import Mapping, Sequence

from bench.peers import Measurement, Peer
from bench.report import Report


def measure(
    work: Mapping[str, Peer], rounds: int, *, uncounted: int = 1
) -> dict[str, list[Measurement]]:
    """Runs all peers in turn, `rounds` times, after warm-up runs."""
    results: dict[str, list[Measurement]] = {name: [] for name in work}
    for count in range(-uncounted, rounds):
        for name, peer in work.items():
            found = peer.measure()
            if count >= 0:
                results[name].append(found)
        print(f"round {count + 1} of {rounds}", file=sys.stderr, flush=True)
    return results


def named(*peers: Peer) -> dict[str, Peer]:
    """Returns peers by their names."""
    return {peer.name: peer for peer in peers}


HEAD = ("program", "median s", "min - max s", "of medians", "of pairs (min - max)", "peak MiB")


def add_table(
    report: Report, title: str, results: dict[str, list[Measurement]], reference: str, name: str
) -> None:
    """Adds a table of times; pairs are runs of the same round."""
    rows = []
    for peer, runs in results.items():
        seconds = [run.seconds for run in runs]
        pairs = [a.seconds / b.seconds for a, b in zip(runs, results[reference], strict=True)]
        peak, start = max(run.peak_mib for run in runs), max(run.start_mib for run in runs)
        cells = [
            peer,
            f"{statistics.median(seconds):.3f}",
            f"{min(seconds):.3f} - {max(seconds):.3f}",
            f"{medians_ratio(runs, results[reference]):.2f}",
            f"{statistics.median(pairs):.2f} ({min(pairs):.2f} - {max(pairs):.2f})",
            f"{peak:.0f}" + (f" ({start:.0f} before)" if start else ""),
        ]
        rows.append(cells)
    report.table(title, HEAD, rows, name)


def medians_ratio(runs: Sequence[Measurement], others: Sequence[Measurement]) -> float:
    """Returns the ratio of the median times."""
    return statistics.median(run.seconds for run in runs) / statistics.median(
        run.seconds for run in others
    )
