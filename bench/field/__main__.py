# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs every shipped entry point at its defaults over files, and lists the faults it finds.

Usage: scripts/run python3 -m bench.field [FOLDER...] [--generated N] (--help lists options)

Each file of a kind that Prefilter reads goes through each entry point for that kind: a command, or
an operator in Blender, in a process of its own with limits of time and memory, without an argument
but the files (and half the size for `resize`, which asks for one). `checks` judges the results, and
knows nothing of how they were made. The package needs trimesh and OpenImageIO beside it, as the pip
command has them; Pillow and SciPy check. Used where they are found: the program of
bench/voxels/self_intersections.cpp, resvg_py (PyPI), and in NODE_PATH gltf-validator (npm).

A finding is a class, such as "traceback" or "silent", and details. Ends with status 1 if there is
one whose class is not allowed by --allow.
"""

import argparse
import collections
import concurrent.futures
import fnmatch
import importlib.util
import json
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

from bench.field import sheet
from bench.field.checks import check
from bench.field.generators import generate, truth_of
from bench.field.kinds import kind_of
from bench.field.runs import ENTRY_POINTS, EntryPoint, Run, available, run
from bench.report import Report, add_json_option

MAX_SECONDS = 300.0
MAX_MEBIBYTES = 12_288


def main() -> None:
    """Runs and reports."""
    options = _arguments()
    if options.kept:
        report = _report([one for folder in options.kept for one in _kept(folder)], options.allow)
        report.finish(options.json)
        return
    for module in ("trimesh", "OpenImageIO", "PIL", "scipy"):
        if importlib.util.find_spec(module) is None:
            sys.exit(f"needs {module} (PyPI) on PYTHONPATH; scripts/decoders.txt lists versions")
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.keep or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        files = [path for given in options.folders for path in _files_of(given, options.only)]
        if options.generated:
            files += generate(folder / "generated", options.generated, options.seed)
        tasks = list(_tasks(files, options.entry, options.skip))
        runs = _run_all(tasks, folder, options)
        if options.sheet:
            sheet.write(options.sheet, [one for one in runs if one.has_result])
    _report(runs, options.allow).finish(options.json)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="bench.field", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("folders", type=Path, nargs="*", metavar="FOLDER", help="files to run over")
    parser.add_argument("--generated", type=int, default=0, metavar="N", help="make N files, too")
    parser.add_argument("--seed", type=int, default=0, help="of the made files (default: 0)")
    parser.add_argument("--only", default="*", metavar="PATTERN", help="of names of files")
    parser.add_argument("--entry", default="*", metavar="PATTERN", help="of entry points")
    parser.add_argument("--skip", default="", metavar="PATTERN", help="entry points to leave out")
    parser.add_argument("--jobs", type=int, default=1, help="processes at a time (default: 1)")
    parser.add_argument("--seconds", type=float, default=MAX_SECONDS, help="that a run may take")
    parser.add_argument("--allow", nargs="*", default=[], metavar="CLASS", help="of findings")
    parser.add_argument(
        "--kept", type=Path, nargs="*", metavar="FOLDER", help="run nothing; report kept results"
    )
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep results and findings")
    parser.add_argument("--sheet", type=Path, metavar="FILE.png", help="draw all results")
    add_json_option(parser)
    return parser.parse_args()


def _files_of(folder: Path, pattern: str) -> Iterable[Path]:
    paths = sorted(folder.rglob("*")) if folder.is_dir() else [folder]
    return (path for path in paths if path.is_file() and fnmatch.fnmatch(path.name, pattern))


def _tasks(files: Sequence[Path], chosen: str, skipped: str) -> Iterable[tuple[EntryPoint, Path]]:
    for path in files:
        kind = kind_of(path)
        for entry_point in ENTRY_POINTS:
            is_chosen = fnmatch.fnmatch(entry_point.name, chosen)
            is_chosen &= not fnmatch.fnmatch(entry_point.name, skipped)
            if is_chosen and kind in entry_point.kinds and available(entry_point):
                yield entry_point, path


def _run_all(
    tasks: Sequence[tuple[EntryPoint, Path]], folder: Path, options: argparse.Namespace
) -> list[Run]:
    def run_and_check(number: int) -> Run:
        entry_point, source = tasks[number]
        name = f"{number:05}{entry_point.result_extension(source)}"
        done = run(
            entry_point,
            source.absolute(),
            (folder / name).absolute(),
            most_seconds=options.seconds,
            most_mebibytes=MAX_MEBIBYTES,
        )
        try:
            done.findings = check(done, truth_of(source))
        except Exception as error:  # A check that fails is a fault of the check: say so, and go on.
            done.findings.append(f"check failed: {type(error).__name__}: {error}")
        return done

    runs = []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for done in pool.map(run_and_check, range(len(tasks))):
            runs.append(done)
            for finding in done.findings:
                print(f"{done.entry_point}  {done.source.name}  {finding}", flush=True)
            if options.keep:
                _keep(folder / "runs.jsonl", done, is_first=len(runs) == 1)
    return runs


def _keep(path: Path, done: Run, *, is_first: bool) -> None:
    line = {
        "entry_point": done.entry_point,
        "source": str(done.source),
        "result": done.target.name,
        "status": done.status,
        "seconds": round(done.seconds, 2),
        "mebibytes": round(done.mebibytes),
        "output": done.output[-2000:],
        "findings": done.findings,
    }
    with path.open("w" if is_first else "a", encoding="utf-8") as file:
        file.write(json.dumps(line, ensure_ascii=False) + "\n")


def _kept(folder: Path) -> Iterable[Run]:
    """Yields the runs of an earlier call with --keep."""
    for line in (folder / "runs.jsonl").read_text(encoding="utf-8").splitlines():
        kept = json.loads(line)
        yield Run(
            entry_point=kept["entry_point"],
            source=Path(kept["source"]),
            target=folder / kept["result"],
            status=kept["status"],
            seconds=kept["seconds"],
            mebibytes=kept["mebibytes"],
            output=kept["output"],
            findings=kept["findings"],
        )


def _report(runs: Sequence[Run], allowed: Sequence[str]) -> Report:
    report = Report()
    names = [entry_point.name for entry_point in ENTRY_POINTS]
    names = [name for name in names if any(one.entry_point == name for one in runs)]
    rows = [_row(name, [one for one in runs if one.entry_point == name]) for name in names]
    columns = ("entry point", "files", "results", "refused", "with findings", "s", "s, most", "MiB")
    report.table("Entry points at their defaults", columns, rows, "entry-points")
    classes = collections.Counter(
        (finding.split(":")[0], one.entry_point) for one in runs for finding in one.findings
    )
    if classes:
        report.table(
            "Findings",
            ("class", "entry point", "runs"),
            [[kind, name, str(count)] for (kind, name), count in sorted(classes.items())],
            "findings",
        )
    wrong = {kind for kind, _ in classes} - set(allowed)
    text = f"of {len(runs)} runs none has a finding that is not allowed"
    report.verdict(not wrong, text if not wrong else f"{text}: {', '.join(sorted(wrong))}")
    return report


def _row(name: str, runs: Sequence[Run]) -> list[str]:
    seconds = sorted(one.seconds for one in runs)
    return [
        name,
        str(len(runs)),
        str(sum(one.status == 0 for one in runs)),
        str(sum(one.status not in (0, None) for one in runs)),
        str(sum(bool(one.findings) for one in runs)),
        f"{seconds[len(seconds) // 2]:.1f}",
        f"{seconds[-1]:.1f}",
        f"{max(one.mebibytes for one in runs):.0f}",
    ]


if __name__ == "__main__":
    sys.exit(main())
