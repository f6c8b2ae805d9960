# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares reconstruct with screened Poisson on clouds that are open, uneven, noisy or sparse.

Usage: scripts/run python3 bench/points/real.py FOLDER [SET...] [--depth N] [--rounds N]
           [--programs ours poisson] [--options KEY=VALUE...] [--keep FOLDER] [--again]
           [--json FILE]

FOLDER keeps the sets (see hard_sets.py), and what Poisson made of them with its measures, so that
it runs again with --again alone. PREFILTER_POISSONRECON and PREFILTER_SURFACETRIMMER are the paths
of built programs, PREFILTER_SELF_INTERSECTIONS of the one in bench/voxels. --options are keywords
of `prefilter.reconstruct`, values as JSON. At depth 0 both use the depth that prefilter picks for
the set. Poisson has its defaults; on open scans, SurfaceTrimmer cuts off the parts sampled two
levels more coarsely than half of the vertices. Each has one thread and one processor, from a file
of points to a file of triangles. Ends with status 1 where a criterion does not hold.
"""

import argparse
import dataclasses
import json
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import Measurement, Peer
from bench.peers.poisson_recon import PoissonRecon
from bench.peers.wavelets import Wavelets
from bench.points.reconstruct import python
from bench.report import Report, add_json_option

OURS, POISSON = "ours", "poisson"
TIME_BAR, MEMORY_BAR, CLEAN_BAR = 1 / 6, 1 / 2, 0.5
TRIM_LEVELS = 2.0
# Measures that must not exceed Poisson's, with the excess that sampling error explains.
BARS = {"folded": 0.0, "cut": 0.0, "lost": 0.02, "invented": 0.02, "high": 0.0, "degrees": 0.0}


@dataclass(frozen=True)
class Prepared:
    """A set on disk."""

    points: Path
    truth: Path | None
    depth: int
    cell: float
    is_open: bool
    is_clean: bool


@dataclass(frozen=True)
class Row:
    """The measurements of one program on one set."""

    runs: list[Measurement]
    quality: dict[str, Any]

    @property
    def cpu(self) -> float:
        """The least: other work on the machine only adds to it."""
        return min(run.cpu_seconds for run in self.runs)

    @property
    def memory(self) -> float:
        """Peak memory beyond the memory at the start [MiB]."""
        return max(run.peak_mib - run.start_mib for run in self.runs)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("sets", nargs="*")
    parser.add_argument("--depth", type=int, default=9, help="0: automatic; default: %(default)s")
    parser.add_argument("--rounds", type=int, default=1, help="default: %(default)s")
    parser.add_argument("--programs", nargs="+", default=[OURS, POISSON], choices=[OURS, POISSON])
    parser.add_argument("--options", nargs="+", default=[], metavar="KEY=VALUE")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="of our surfaces")
    parser.add_argument("--again", action="store_true", help="run Poisson, too")
    add_json_option(parser)
    options = parser.parse_args()
    report = Report()
    together = []
    for name in options.sets or json.loads(python("bench.points.hard_sets")):
        found = prepared(options.folder, name, options.depth)
        rows = {}
        if POISSON in options.programs:
            rows[POISSON] = theirs(options, name, found)
        if OURS in options.programs:
            rows[OURS] = ours(options, name, found)
        title = f"{name}, depth {found.depth}" + (", open" if found.is_open else "")
        lines = [line(key, row) for key, row in rows.items()]
        report.table(title, HEAD, lines, name)
        together += [[name if i == 0 else "", *cells] for i, cells in enumerate(lines)]
        if len(rows) == 2:
            judge(report, name, found, rows)
    report.table("all", ("set", *HEAD), together, "sets")
    report.finish(options.json)


def prepared(folder: Path, name: str, depth: int) -> Prepared:
    """Makes a set unless it is there."""
    made = json.loads(python("bench.points.hard_sets", folder / "sets", name, "--depth", depth))
    truth = Path(made.pop("truth")) if made["truth"] else made.pop("truth")
    return Prepared(Path(made.pop("points")), truth, **made)


def ours(options: argparse.Namespace, name: str, found: Prepared) -> Row:
    """Runs prefilter."""
    folder = options.keep or options.folder / OURS
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / f"{name}, {found.depth}.ply"
    keywords = {}
    for option in options.options:
        key, _, value = option.partition("=")
        keywords[key] = json.loads(value)
    peer = Wavelets(found.points, target, found.depth, keywords, name=OURS)
    return Row([peer.measure() for _ in range(options.rounds)], measured(target, found))


def theirs(options: argparse.Namespace, name: str, found: Prepared) -> Row:
    """Runs Poisson, unless its result exists."""
    folder = options.folder / POISSON
    folder.mkdir(parents=True, exist_ok=True)
    target = folder / f"{name}, {found.depth}.ply"
    notes = target.with_suffix(".json")
    if notes.exists() and not options.again:
        kept = json.loads(notes.read_text())
        return Row([Measurement(**run) for run in kept["runs"]], kept["quality"])
    trimmed = TRIM_LEVELS if found.is_open else None
    peer: Peer = PoissonRecon(found.points, target, found.depth, trimmed=trimmed)
    runs = [peer.measure() for _ in range(options.rounds)]
    row = Row(runs, measured(target, found))
    kept = {"runs": [dataclasses.asdict(run) for run in runs], "quality": row.quality}
    notes.write_text(json.dumps(kept))
    return row


def measured(target: Path, found: Prepared) -> dict[str, Any]:
    """Measures a surface."""
    arguments = (target, found.truth or "-", found.cell, found.points)
    return json.loads(python("bench.points.soundness", *arguments))


HEAD = (
    "program",
    "CPU s",
    "MiB",
    "triangles",
    "folded %",
    "cut",
    "parts",
    "genus",
    "lost %",
    "invented %",
    "mean",
    "99.9 %",
    "normals",
)


def line(key: str, row: Row) -> list[str]:
    """Returns a line of the table."""
    quality = row.quality
    return [
        key,
        f"{row.cpu:.2f}",
        f"{row.memory:.0f}",
        str(quality["triangles"]),
        f"{quality['folded']:.4f}",
        str(quality["cut"]),
        str(quality["parts"]),
        str(quality["genus"]) if quality["genus"] >= 0 else "open",
        f"{quality['lost']:.3f}",
        f"{quality['invented']:.3f}",
        f"{quality['mean']:.4f}",
        f"{quality['high']:.3f}",
        f"{quality['degrees']:.2f}",
    ]


def judge(report: Report, name: str, found: Prepared, rows: Mapping[str, Row]) -> None:
    """Compares with Poisson."""
    own, other = rows[OURS], rows[POISSON]
    wrong = [
        f"{key} {own.quality[key]:.4g} > {other.quality[key]:.4g}"
        for key, slack in BARS.items()
        if own.quality[key] > other.quality[key] + slack
    ]
    shares = {
        "CPU": (own.cpu / other.cpu, TIME_BAR),
        "memory": (own.memory / other.memory, MEMORY_BAR),
    }
    if found.is_clean:
        shares["mean distance"] = (own.quality["mean"] / other.quality["mean"], CLEAN_BAR)
    wrong += [
        f"{key} {value:.3f} > {bar:.3g}" for key, (value, bar) in shares.items() if value > bar
    ]
    told = ", ".join(f"{key} {value:.3f}" for key, (value, _) in shares.items())
    claim = f"{name}: of Poisson's: {told}"
    report.verdict(not wrong, claim + (f"; {', '.join(wrong)}" if wrong else ""))


if __name__ == "__main__":
    main()
