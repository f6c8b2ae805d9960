# SPDX-License-Identifier: GPL-3.0-or-later

"""Compares prefilter with itself on larger textures and meshes, picture file to mip-mapped file.

Usage: cmake --preset bench && cmake --build build/bench --target prefilter_bake_file
       scripts/run python3 bench/textures/compare_growth.py [--rounds N] [--threads N]

The criteria, for pam-bilinear and 8-bit RGBA pictures: 8192 texels take at most 4.4 times as long
as 4096, and a mesh of a million triangles over 1024 texels less than 3 times as long as one of ten
thousand. Every round runs each once; ends with status 1 where a criterion does not hold.
"""

import argparse
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from bench.peers import run
from bench.peers.file_to_file import IN_CPP, FileToFile
from bench.report import Report, add_json_option
from bench.textures.compare_maketx import HERE
from bench.turns import add_table, measure, medians_ratio, named


@dataclass(frozen=True)
class Growth:
    """A smaller and a larger case, as texels along a side and triangles."""

    name: str
    small: tuple[int, int]
    large: tuple[int, int]
    limit: float


CASES = (
    Growth("size", (4096, 10_000), (8192, 10_000), 4.4),
    Growth("triangles", (1024, 10_000), (1024, 1_000_000), 3.0),
)


def main() -> None:
    """Measures and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5, help="how often (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=2, help="of each (default: %(default)s)")
    parser.add_argument(
        "--filter", default="pam-bilinear", help="the filter (default: %(default)s)"
    )
    add_json_option(parser)
    options = parser.parse_args()
    if not IN_CPP.exists():
        parser.error(f"there is no '{IN_CPP}'; build the target prefilter_bake_file first")
    report = Report()
    with tempfile.TemporaryDirectory() as name:
        for case in CASES:
            work = [prepared(Path(name), *sides, options) for sides in (case.small, case.large)]
            results = measure(named(*work), options.rounds)
            add_table(report, work[1].name, results, work[0].name, case.name)
            ratio = medians_ratio(results[work[1].name], results[work[0].name])
            claim = f"{work[1].name} takes {ratio:.2f} times as long"
            report.verdict(ratio <= case.limit, f"{claim}; at most {case.limit} is asked for")
    report.finish(options.json)


def prepared(place: Path, size: int, triangles: int, options: argparse.Namespace) -> FileToFile:
    """Writes a picture and a mesh, and returns the work on them."""
    folder = place / f"{size}-{triangles}"
    picture = folder / "sized.png"
    if not picture.exists():
        folder.mkdir()
        run([sys.executable, str(HERE / "scene.py"), str(folder), "--triangles", str(triangles)])
        scale = ["oiiotool", str(folder / "picture.png"), "--resize", f"{size}x{size}"]
        subprocess.run([*scale, "-o", str(picture)], check=True)
    work = FileToFile(picture, folder, filter=options.filter, threads=options.threads)
    work.name = f"{options.filter}, {size} texels, {triangles} triangles"
    return work


if __name__ == "__main__":
    main()
