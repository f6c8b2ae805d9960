# SPDX-License-Identifier: GPL-3.0-or-later

"""Reads small damaged files of points, textures, tables, octrees and drawings.

Files of some hundred bytes are damaged at random, and each is read in a process of its own, which
may take 2 GiB and 10 s of a processor. It must be read, or refused by a ValueError, and take no
more than 256 MiB and 5 s. Formats that other modules read are included (laspy with lazrs,
and pye57); kinds whose module cannot be imported are left out.

usage: damage.py [KIND...] [--count N] [--first SEED] [--keep FOLDER] [--json FILE]
  scripts/run python3 bench/reliability/damage.py
"""

import argparse
import gzip
import importlib
import importlib.util
import io
import multiprocessing
import os
import resource
import signal
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import prefilter  # noqa: E402

from bench import report  # noqa: E402

MOST_MIB, MOST_SECONDS = 256.0, 5.0
_LIMIT, _SECONDS = 2 << 30, 10
_MOST_WALL_SECONDS = 120
_READ, _REFUSED, _NO_MEMORY, _OTHER = range(4)
_POINTS = 25
_NUMBERS = (0, 1, 0x7F, 1 << 15, 1 << 30, (1 << 31) - 1, (1 << 32) - 1, 1 << 40, (1 << 63) - 1)


@dataclass(frozen=True)
class Kind:
    """A kind of files.

    Attributes:
        name: Its name in tables, which ends with the file name extension.
        make: Writes a whole one.
        read: Reads one.
        needs: Modules without which there is nothing to test.
        change: Damages the bytes of one and recomputes its checksums, as an attacker would.
    """

    name: str
    make: Callable[[Path], object]
    read: Callable[[Path], object]
    needs: tuple[str, ...] = ()
    change: Callable[[bytes, np.random.Generator], bytes] | None = None


@dataclass
class Found:
    """Outcomes of the files of a kind."""

    read: int = 0
    refused: int = 0
    killed: int = 0
    others: int = 0
    seconds: float = 0.0
    mib: float = 0.0


def _points() -> np.ndarray[Any, Any]:
    return np.random.default_rng(1).normal(size=(_POINTS, 3))


def _las(point_format: int) -> Callable[[Path], object]:
    def make(path: Path) -> None:
        import laspy

        las = laspy.create(point_format=point_format)
        las.x, las.y, las.z = _points().T
        las.write(path)

    return make


def _e57(path: Path) -> None:
    import pye57

    data = {f"cartesian{axis}": values for axis, values in zip("XYZ", _points().T, strict=True)}
    data["intensity"] = np.arange(_POINTS, dtype=np.float64)
    data |= {
        f"color{name}": np.arange(_POINTS, dtype=np.uint8) for name in ("Red", "Green", "Blue")
    }
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw({name: np.ascontiguousarray(each) for name, each in data.items()})


def _ply(path: Path) -> None:
    names = "".join(f"property float {name}\n" for name in ("x", "y", "z", "nx", "ny", "nz"))
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {_POINTS}\n{names}end_header\n"
    rows = np.hstack([_points(), _points()]).astype("<f4")
    data = head.encode() + rows.tobytes()
    path.write_bytes(gzip.compress(data) if path.suffix == ".gz" else data)


def _levels(count: int = 3) -> list[np.ndarray[Any, Any]]:
    values = np.random.default_rng(2).integers(0, 255, (1 << count, 1 << count, 4), np.uint8)
    return [values[: 1 << i, : 1 << i].copy() for i in range(count, -1, -1)]


def _ktx2(form: str, **options: Any) -> Callable[[Path], object]:
    return lambda path: prefilter.write_ktx2(path, _levels(), format=form, **options)


def _octree(path: Path) -> None:
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    prefilter.voxelize(corners, np.array(triangles), depth=3).save(path)


def _table(path: Path) -> None:
    prefilter.SamplingTable.build("tent", texels=2).save(path)


_DRAWING = b"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 99 99"><style>.a,g>b{fill:red}
</style><linearGradient id="g"><stop/><stop offset="1" stop-color="blue"/></linearGradient>
<filter id="f"><feGaussianBlur stdDeviation="2"/><feOffset dx="3"/></filter>
<g transform="rotate(9)" opacity=".5"><path class="a" d="M1 1h30q9 9 3 40a9 9 0 1 1-8 9z"/>
<circle r="30" fill="url(#g)" stroke="red" stroke-width="3" stroke-dasharray="4 2"/></g>
<rect width="40" height="9" filter="url(#f)"/></svg>"""


def _svg(path: Path) -> None:
    path.write_bytes(gzip.compress(_DRAWING) if path.suffix == ".svgz" else _DRAWING)


def _draw(path: Path) -> None:
    prefilter.rasterize_svg(path, 64, 64, fonts=())


def damaged(contents: bytes, chance: np.random.Generator) -> bytes:
    """Returns a file with bits, bytes and numbers changed, pieces repeated, or its end cut off."""
    found = bytearray(contents)
    for _ in range(chance.integers(1, 5)):
        place = int(chance.integers(0, max(len(found) - 8, 1)))
        number = int(chance.choice(np.array(_NUMBERS, np.uint64)))
        match int(chance.integers(0, 7)):
            case 0:
                found[place] ^= 1 << int(chance.integers(0, 8))
            case 1:
                found[place] = int(chance.integers(0, 256))
            case 2:
                found[place : place + 4] = (number & 0xFFFFFFFF).to_bytes(4, "little")
            case 3:
                found[place : place + 8] = number.to_bytes(8, "little")
            case 4:
                found[place : place + 2] = (number & 0xFFFF).to_bytes(2, "big")
            case 5:
                del found[place + int(chance.integers(0, 8)) :]
                found += bytes(1)
            case _:
                found[place:place] = found[place : place + int(chance.integers(1, 40))]
    return bytes(found)


def _inside_gzip(contents: bytes, chance: np.random.Generator) -> bytes:
    return gzip.compress(damaged(gzip.decompress(contents), chance))


def _in_pages(contents: bytes, chance: np.random.Generator) -> bytes:
    """Damages an E57 file: the last four bytes of each page are a CRC-32C of the others."""
    page = 1024
    found = damaged(contents, chance)
    pages = []
    for begin in range(0, len(found), page):
        data = found[begin : begin + page - 4]
        register = 0xFFFFFFFF
        for byte in data:
            register ^= byte
            for _ in range(8):
                register = register >> 1 ^ (0x82F63B78 if register & 1 else 0)
        pages.append(data + (register ^ 0xFFFFFFFF).to_bytes(4, "big"))
    return b"".join(pages)


def _in_arrays(contents: bytes, chance: np.random.Generator) -> bytes:
    """Damages the values of an array in an archive."""
    with np.load(io.BytesIO(contents)) as file:
        arrays = dict(file)
    name = str(chance.choice(sorted(arrays)))
    values = arrays[name]
    data = damaged(values.tobytes(), chance)
    whole = data[: len(data) // values.itemsize * values.itemsize]
    changed = np.frombuffer(whole, values.dtype)
    fits = changed.size == values.size
    arrays[name] = changed.reshape(values.shape) if fits else changed
    made = io.BytesIO()
    np.savez(made, **arrays)
    return made.getvalue()


KINDS = (
    *(
        Kind(
            f"format {point_format}.laz",
            _las(point_format),
            prefilter.read_points,
            ("laspy", "lazrs"),
        )
        for point_format in (0, 3, 6, 7)
    ),
    Kind("format 3.las", _las(3), prefilter.read_points, ("laspy",)),
    Kind("scan.e57", _e57, prefilter.read_points, ("pye57",)),
    Kind("right sums.e57", _e57, prefilter.read_points, ("pye57",), _in_pages),
    Kind("scan.ply", _ply, prefilter.read_points),
    Kind("scan.ply.gz", _ply, prefilter.read_points),
    Kind("right sums.ply.gz", _ply, prefilter.read_points, (), _inside_gzip),
    Kind("rgba8.ktx2", _ktx2("rgba8"), prefilter.read_ktx2),
    Kind("uastc.ktx2", _ktx2("uastc"), prefilter.read_ktx2),
    Kind("etc1s.ktx2", _ktx2("etc1s"), prefilter.read_ktx2),
    Kind("octree.npz", _octree, prefilter.Octree.load),
    Kind("right sums.npz", _octree, prefilter.Octree.load, (), _in_arrays),
    Kind("table.json", _table, prefilter.SamplingTable.load),
    Kind("drawing.svg", _svg, _draw),
    Kind("drawing.svgz", _svg, _draw),
)


def _read_in_child(kind: Kind, path: Path, used: int) -> None:
    """Reads a file, and ends this process with a status for the outcome."""
    signal.alarm(_MOST_WALL_SECONDS)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
    resource.setrlimit(resource.RLIMIT_AS, (used + _LIMIT,) * 2)
    status = _READ
    try:
        kind.read(path)
    except ValueError:
        status = _REFUSED
    except MemoryError:
        status = _NO_MEMORY
    except BaseException:
        status = _OTHER
    os._exit(status)


def outcome(kind: Kind, path: Path) -> tuple[int, float, float]:
    """Returns the exit status, negative for a signal, seconds of a processor, and MiB."""
    sys.stdout.flush()
    used = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    child = os.fork()
    if child == 0:
        _read_in_child(kind, path, used)
    _, status, spent = os.wait4(child, 0)
    seconds = spent.ru_utime + spent.ru_stime
    return os.waitstatus_to_exitcode(status), seconds, spent.ru_maxrss / 1024


def make(name: str, path: Path) -> None:
    """Writes a whole file; in a process of its own, as copies of one with threads would wait."""
    next(kind for kind in KINDS if kind.name == name).make(path)


def tried(
    kind: Kind, folder: Path, seeds: range, keep: Path | None
) -> tuple[Found, int, list[str]]:
    """Damages a file of a kind again and again.

    Returns:
        The outcomes, the size of the whole file in bytes, and the faults.
    """
    path = folder / kind.name
    made = multiprocessing.get_context("spawn").Process(target=make, args=(kind.name, path))
    made.start()
    made.join()
    contents = path.read_bytes()
    status, _, least = outcome(kind, path)
    if status != _READ:
        raise OSError(f"{kind.name}: the whole file is not read: {status}")
    found, wrong = Found(), []
    for seed in seeds:
        data = (kind.change or damaged)(contents, np.random.default_rng(seed))
        path.write_bytes(data)
        status, seconds, mib = outcome(kind, path)
        mib = max(mib - least, 0.0)
        found.seconds, found.mib = max(found.seconds, seconds), max(found.mib, mib)
        found.read += status == _READ
        found.refused += status == _REFUSED
        found.killed += status < 0
        found.others += status > _REFUSED
        if status not in (_READ, _REFUSED) or seconds > MOST_SECONDS or mib > MOST_MIB:
            wrong.append(f"{kind.name} {seed}: status {status}, {seconds:.1f} s, {mib:.0f} MiB")
            if keep is not None:
                (keep / f"{seed}-{kind.name}").write_bytes(data)
    return found, len(contents), wrong


def main() -> None:
    """Damages files of every kind that there is."""
    parser = argparse.ArgumentParser()
    parser.add_argument("kinds", nargs="*", metavar="KIND", help="part of a name")
    parser.add_argument("--count", type=int, default=1000, help="of each (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="seed (default: %(default)s)")
    parser.add_argument("--keep", type=Path, help="folder for those that went wrong")
    report.add_json_option(parser)
    options = parser.parse_args()
    told, rows, wrong = report.Report(), [], []
    import prefilter.shapes._svg.draw.compositing
    import prefilter.shapes._svg.draw.opening
    import prefilter.textures.ktx2_reader  # noqa: F401

    seeds = range(options.first, options.first + options.count)
    with tempfile.TemporaryDirectory() as name:
        for kind in KINDS:
            if options.kinds and not any(each in kind.name for each in options.kinds):
                continue
            missing = [each for each in kind.needs if importlib.util.find_spec(each) is None]
            if missing:
                told.note(f"{kind.name} left out: there is no {', '.join(missing)}")
                continue
            for each in kind.needs:
                importlib.import_module(each)
            found, size, bad = tried(kind, Path(name), seeds, options.keep)
            wrong += bad
            cells = [size, found.read, found.refused, found.killed, found.others]
            rows.append([kind.name, *map(str, cells), f"{found.seconds:.1f}", f"{found.mib:.0f}"])
            print("  ".join(rows[-1]), *bad[:5], sep="\n  " if bad else "  ", flush=True)
    head = ["File", "Bytes", "Read", "Refused", "Killed", "Others", "Most seconds", "Most MiB"]
    told.table("Damaged files", head, rows, "damage")
    told.verdict(
        not wrong,
        f"{len(seeds) * len(rows)} damaged files: read or refused, "
        f"within {MOST_SECONDS:g} s and {MOST_MIB:g} MiB",
    )
    told.finish(options.json)


if __name__ == "__main__":
    main()
