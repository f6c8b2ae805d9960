# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares reconstruct with screened Poisson: time, memory, and nearness to the true surface.

Usage: scripts/run python3 bench/points/reconstruct.py FOLDER [SET...] [--depth N] [--rounds N]
                                                     [--programs NAME...] [--json FILE]

FOLDER keeps the sets (see sets.py) and what every program made of them. Programs that are missing
are named and left out; PREFILTER_POISSONRECON is the path of a built PoissonRecon, and
PREFILTER_OPEN3D_PYTHON and PREFILTER_MESHLAB_PYTHON are Pythons that can import open3d and
pymeshlab, where ours cannot. Each program has one thread and one processor, and every round runs
each once, from a file of points to a file of triangles; Python's imports are not counted. Criteria
compare with the best Poisson program in each measure. Ends with status 1 where a
criterion does not hold.
"""

import argparse
import json
import statistics
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import Measurement, Peer
from bench.peers.meshlab_poisson import MeshLab
from bench.peers.open3d_poisson import Open3d
from bench.peers.poisson_recon import PoissonRecon
from bench.peers.wavelets import Wavelets
from bench.points import sets
from bench.report import Report, add_json_option
from bench.turns import measure

ROOT = Path(__file__).resolve().parents[2]
OURS: dict[str, dict[str, Any]] = {
    "Haar": {"wavelet": "haar", "smooth": False, "fit": False},
    "Haar smoothed": {"wavelet": "haar", "smooth": True, "fit": False},
    "Haar fitted": {"wavelet": "haar", "smooth": False, "fit": True},
    "Haar smoothed, fitted": {"wavelet": "haar", "smooth": True, "fit": True},
    "D4": {"wavelet": "d4", "smooth": False, "fit": False},
    "D4 smoothed": {"wavelet": "d4", "smooth": True, "fit": False},
    "D4 smoothed, fitted": {"wavelet": "d4", "smooth": True, "fit": True},
}
THEIRS = {peer.name: peer for peer in (PoissonRecon, Open3d, MeshLab)}
TIME_BARS = {
    9: {"Haar": 1 / 12, "Haar fitted": 1 / 8, "D4 smoothed": 1 / 3},
    11: {"Haar": 1 / 12, "Haar fitted": 1 / 8, "D4 smoothed": 1 / 4},
}
MEMORY_BARS = {"Haar": 80e6, "D4": 130e6}  # Bytes above the input.
MEMORY_DEPTH = 9
CLEAN_BARS = {"Haar fitted": 0.5, "Haar": 2.0}
NOISY_BAR = 1.25
NOISY = "D4 smoothed, fitted"
FITTED = "Haar fitted"
CLEAN = ("1m", "4500k")
MADE = "made"  # The folder of surfaces, in that of the sets.


@dataclass(frozen=True)
class Row:
    """The measurements of one program on one set."""

    runs: list[Measurement]
    quality: dict[str, Any]

    @property
    def cpu(self) -> float:
        """The median."""
        return statistics.median(run.cpu_seconds for run in self.runs)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("sets", nargs="*", default=sets.names())
    parser.add_argument("--depth", type=int, default=9, help="default: %(default)s")
    parser.add_argument("--rounds", type=int, default=3, help="default: %(default)s")
    parser.add_argument("--programs", nargs="+", default=[*OURS, *THEIRS], metavar="NAME")
    add_json_option(parser)
    options = parser.parse_args()
    for name in options.programs:
        if name not in OURS and name not in THEIRS:
            parser.error(f"no program is called '{name}'; there are {', '.join([*OURS, *THEIRS])}")
    report = Report()
    programs = [name for name in options.programs if name in OURS]
    for name, peer in THEIRS.items():
        if name in options.programs and peer.missing():
            report.note(f"{name} is left out: it needs {peer.missing()}")
        elif name in options.programs:
            programs.append(name)
    sharp: dict[str, dict[str, Row]] = {}
    for name in options.sets:
        points = options.folder / f"{name}.ply"
        if not points.exists():
            python("bench.points.sets", options.folder, name)
        rows = compare(name, points, programs, options)
        title = f"{name}, depth {options.depth}"
        report.table(title, HEAD, [row(key, found) for key, found in rows.items()], name)
        judge(report, name, rows, options.depth)
        if name.endswith("tilted") and NOISY in rows:
            judge_tilt(report, name, options.folder / MADE, options.depth)
        if name.endswith(CLEAN) and options.depth == MEMORY_DEPTH and FITTED in rows:
            judge_memory(report, name, points, options.depth)
        if name.endswith("1m") and len(rows) > 1:
            sharp[name] = rows
    hausdorff(report, sharp)
    report.finish(options.json)


def compare(
    name: str, points: Path, programs: Sequence[str], options: argparse.Namespace
) -> dict[str, Row]:
    """Runs all programs on a set, in turns, and measures their results."""
    made = options.folder / MADE
    made.mkdir(exist_ok=True)
    targets = {key: made / f"{name}, {key}, {options.depth}.ply" for key in programs}
    work: dict[str, Peer] = {}
    for key, target in targets.items():
        if key in OURS:
            work[key] = Wavelets(points, target, options.depth, OURS[key], name=key)
        else:
            work[key] = THEIRS[key](points, target, options.depth)
    runs = measure(work, options.rounds, uncounted=0)
    source = sets.source_of(name) or "-"
    arguments = (source, options.depth, points, "--json")
    return {
        key: Row(runs[key], json.loads(python("bench.points.measure", target, *arguments)))
        for key, target in targets.items()
    }


def python(module: str, *arguments: object) -> str:
    """Runs a module in a process of its own, so that nothing stays in the memory of this one."""
    command = [sys.executable, "-m", module, *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout


HEAD = (
    "program",
    "CPU s",
    "min - max",
    "wall s",
    "peak MiB",
    "of it before",
    "triangles",
    "mean",
    "99.9 %",
    "normals, degrees",
    "closed 2-manifold",
)


def row(key: str, found: Row) -> list[str]:
    """Returns a line of the table."""
    cpu = [run.cpu_seconds for run in found.runs]
    quality = found.quality
    return [
        key,
        f"{found.cpu:.2f}",
        f"{min(cpu):.2f} - {max(cpu):.2f}",
        f"{statistics.median(run.seconds for run in found.runs):.2f}",
        f"{max(run.peak_mib for run in found.runs):.0f}",
        f"{max(run.start_mib for run in found.runs):.0f}",
        f"{quality['triangles']}",
        f"{quality['mean']:.4f}",
        f"{quality['high']:.3f}",
        f"{quality['degrees']:.2f}",
        "yes" if quality["is_manifold"] else "only closed" if quality["is_closed"] else "no",
    ]


def judge(report: Report, name: str, rows: dict[str, Row], depth: int) -> None:
    """Compares with the best Poisson there is."""
    for key, found in rows.items():
        if key in OURS:
            report.verdict(found.quality["is_manifold"], f"{name}: {key} is a closed 2-manifold")
    peers = [key for key in THEIRS if key in rows]
    if not peers:
        return
    is_clean, is_worn = name.endswith(CLEAN), name.endswith((*sets.WORN, "uneven"))

    def at_most(key: str, what: str, bar: float, value: Callable[[Row], float]) -> None:
        peer = min(peers, key=lambda name: value(rows[name]))
        share = value(rows[key]) / value(rows[peer])
        claim = f"{name}: {key}'s {what} is {share:.3f} of {peer}'s; at most {bar:.3g} is asked for"
        report.verdict(share <= bar, claim)

    for key in rows:
        if is_clean and key in TIME_BARS.get(depth, {}):
            at_most(key, "CPU time", TIME_BARS[depth][key], lambda row: row.cpu)
        if is_clean and key in CLEAN_BARS:
            at_most(key, "mean distance", CLEAN_BARS[key], lambda row: row.quality["mean"])
        if is_clean and key == FITTED:
            at_most(key, "normal error", 1.0, lambda row: row.quality["degrees"])
        if is_worn and key == NOISY:
            at_most(key, "mean distance", NOISY_BAR, lambda row: row.quality["mean"])


def judge_memory(report: Report, name: str, points: Path, depth: int) -> None:
    """Measures the library's memory beyond points that are already loaded."""
    for key, bar in MEMORY_BARS.items():
        target = points.with_name("memory.ply")
        run = Wavelets(points, target, depth, OURS[key], name=key, in_memory=True).measure()
        target.unlink(missing_ok=True)
        above = (run.peak_mib - run.start_mib) * 2**20
        report.verdict(
            above <= bar,
            f"{name}: {key} at depth {depth} takes {above / 1e6:.0f} MB above its input; at most "
            f"{bar / 1e6:.0f} is asked for",
        )


def judge_tilt(report: Report, name: str, folder: Path, depth: int) -> None:
    """Compares the surfaces from turned and from true normals (figure 4.5)."""
    turned = folder / f"{name}, {NOISY}, {depth}.ply"
    true = folder / f"{name.replace('tilted', '1m')}, {NOISY}, {depth}.ply"
    if not (turned.exists() and true.exists()):
        return
    points = folder.parent / f"{name}.ply"
    found = json.loads(python("bench.points.measure", turned, true, depth, points, "--json"))
    report.verdict(
        found["largest"] <= 1,
        f"{name}: normals turned by up to {sets.TILT:g} degrees move the surface of {NOISY} by "
        f"{found['mean']:.3f} cells on average, {found['high']:.3f} at the 99.9th percentile and "
        f"{found['largest']:.3f} at the most; at most 1 is asked for",
    )


def hausdorff(report: Report, results: dict[str, dict[str, Row]]) -> None:
    """Adds table 4.3: the largest distances, as shares of the largest in each row."""
    programs = [*OURS, *THEIRS]
    rows = []
    for name, found in results.items():
        largest = {key: value.quality["largest"] for key, value in found.items()}
        worst = max(largest.values())
        shares = (f"{largest[key] / worst:.3f}" if key in largest else "" for key in programs)
        rows.append([name, *shares, f"{worst:.2f}"])
    if rows:
        report.table(
            "Largest distance, normalized by row (table 4.3)",
            ("set", *programs, "worst, cells"),
            rows,
            "largest",
        )


if __name__ == "__main__":
    main()
