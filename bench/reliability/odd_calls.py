# SPDX-License-Identifier: GPL-3.0-or-later

"""Calls of the package with random arguments: other shapes, types, strides and values.

Each call starts out valid; some arguments are then replaced, or their arrays are cut, transposed,
stretched, converted, or get values that are not finite, huge or far outside. It must return, or
raise ValueError or MemoryError, within 10 s of a processor and 2 GiB; its arguments must stay
unchanged. A process makes some calls in a row, so that a crash counts as one.

usage: odd_calls.py [PATTERN] [--count N] [--first SEED] [--json FILE]
  scripts/run python3 bench/reliability/odd_calls.py
"""

import argparse
import os
import resource
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import prefilter  # noqa: E402

from bench import report  # noqa: E402

_LIMIT, _SECONDS, _CALLS = 2 << 30, 60, 25
_TYPES = ("f2", "f4", "f8", ">f8", "i1", "u1", "i2", "u2", "i4", ">i4", "i8", "u8", "?", "c8", "O")
_VALUES = (np.nan, np.inf, -np.inf, 1e308, -1e308, 1e-308, 0.0, -1.0, 2.0**31, 2.0**63, 1e20)
_ODD = (None, True, -1, 0, 1, 2, 1 << 31, 1 << 63, 0.5, np.nan, "", "x", b"x", (), [], {}, [[1]])
_IMAGE = np.random.default_rng(1).random((8, 8, 3), np.float32)
_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
_TRIANGLES = np.array([t for a, b, c, d in _SIDES for t in ((a, b, c), (a, c, d))])
_UVS = _CORNERS[:, :2].copy()
_CLOUD = np.random.default_rng(2).normal(size=(200, 3))
_CLOUD /= np.linalg.norm(_CLOUD, axis=1, keepdims=True)


def _with_surface(call: Callable[..., Any]) -> Callable[..., Any]:
    def made(image: Any, positions: Any, triangles: Any, uvs: Any, **more: Any) -> Any:
        return call(image, prefilter.Surface(positions, triangles, uvs), **more)

    return made


def _drawn(points: Any, width: Any, color: Any, **more: Any) -> Any:
    shape = prefilter.Shape(color=color)
    shape.add_polygon(points)
    return prefilter.rasterize([shape, shape.stroked(width)], 16, 16, **more)


_SURFACE = {"image": _IMAGE, "positions": _CORNERS, "triangles": _TRIANGLES, "uvs": _UVS}
_MESH = {"positions": _CORNERS, "triangles": _TRIANGLES}
CALLS: dict[str, tuple[Callable[..., Any], dict[str, Any]]] = {
    "mipmaps": (_with_surface(prefilter.mipmaps), {**_SURFACE, "wrap": "repeat"}),
    "coarser_levels": (_with_surface(prefilter.coarser_levels), {**_SURFACE, "wrap": "clamp"}),
    "resize": (
        prefilter.resize,
        {"image": _IMAGE, "width": 5, "height": 3, "filter": "lanczos3", "wrap": "clamp"},
    ),
    "sample": (
        prefilter.sample,
        {
            "levels": [_IMAGE, _IMAGE[:4, :4], _IMAGE[:2, :2], _IMAGE[:1, :1]],
            "table": "trilinear",
            "coordinates": _UVS,
            "scales": 1.5,
        },
    ),
    "voxelize": (prefilter.voxelize, {**_MESH, "depth": 3, "thickness": None}),
    "as_solid": (prefilter.as_solid, {**_MESH, "cell": 0.2}),
    "close_holes": (prefilter.close_holes, {"positions": _CORNERS, "triangles": _TRIANGLES[:-1]}),
    "uv_charts": (prefilter.uv_charts, {**_MESH, "uvs": _UVS}),
    "reconstruct": (prefilter.reconstruct, {"points": _CLOUD, "normals": _CLOUD, "depth": 4}),
    "estimate_normals": (prefilter.estimate_normals, {"points": _CLOUD, "neighbours": 8}),
    "rasterize": (
        _drawn,
        {"points": _UVS[[0, 2, 6, 4]] * 9, "width": 2.0, "color": (0.5, 1.0), "filter": "mitchell"},
    ),
}


def odd(value: Any, chance: np.random.Generator) -> Any:
    """Returns a changed argument."""
    kind = int(chance.integers(0, 8))
    if kind == 0 or not isinstance(value, np.ndarray):
        return _ODD[int(chance.integers(0, len(_ODD)))]
    with np.errstate(all="ignore"):
        match kind:
            case 1:
                return value.astype(_TYPES[int(chance.integers(0, len(_TYPES)))])
            case 2:
                return value[:: int(chance.choice([-1, 2, 3]))]
            case 3:
                return np.asfortranarray(value)[..., ::-1]
            case 4:
                return value[: int(chance.integers(0, len(value) + 1))]
            case 5:
                return value[..., : int(chance.integers(0, value.shape[-1] + 1))]
            case 6:
                return np.broadcast_to(value.ravel()[:1], value.shape)
    changed = value.astype(float if value.dtype.kind == "f" else value.dtype)
    for _ in range(int(chance.integers(1, 4))):
        number = _VALUES[int(chance.integers(0, len(_VALUES)))]
        with np.errstate(all="ignore"):
            changed.ravel()[int(chance.integers(0, changed.size))] = np.asarray(number).astype(
                changed.dtype
            )
    return changed


def call_oddly(name: str, seed: int) -> str:
    """Makes a call, and returns the fault in its outcome; empty for none."""
    call, good = CALLS[name]
    chance = np.random.default_rng([seed, *name.encode()])
    arguments = dict(good)
    for argument in chance.choice(list(good), int(chance.integers(1, 3))):
        arguments[str(argument)] = odd(good[str(argument)], chance)
    arrays = [each for each in arguments.values() if isinstance(each, np.ndarray)]
    before = [each.tobytes() for each in arrays]
    try:
        call(**arguments)
    except (ValueError, MemoryError):
        pass
    except BaseException as error:
        return f"{type(error).__name__}: {error}: {traceback.extract_tb(error.__traceback__)[-1]}"
    if before != [each.tobytes() for each in arrays]:
        return "an argument was changed"
    return ""


def calls_in_child(name: str, seeds: range) -> tuple[int, list[str]]:
    """Makes calls in a process of its own; returns its exit status and the faults."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(read)
        used = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
        resource.setrlimit(resource.RLIMIT_AS, (used + _LIMIT,) * 2)
        resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        for seed in seeds:
            os.write(write, f"at {seed}\n".encode())
            wrong = call_oddly(name, seed)
            if wrong:
                os.write(
                    write, f"wrong {seed}: {wrong[:200]}\n".encode().replace(b"\n", b" ") + b"\n"
                )
        os._exit(0)
    os.close(write)
    with os.fdopen(read, errors="replace") as said:
        lines = said.read().splitlines()
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    wrong = [line.removeprefix("wrong ") for line in lines if line.startswith("wrong ")]
    if status:
        wrong.append(f"{lines[-1]}: status {status}")
    return status, wrong


def main() -> None:
    """Calls every function of the table again and again."""
    parser = argparse.ArgumentParser()
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--count", type=int, default=1000, help="of each (default: %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="seed (default: %(default)s)")
    report.add_json_option(parser)
    options = parser.parse_args()
    told, rows, bad = report.Report(), [], 0
    for name in CALLS:
        if options.pattern not in name:
            continue
        ends, wrongs = 0, []
        for first in range(options.first, options.first + options.count, _CALLS):
            status, wrong = calls_in_child(name, range(first, first + _CALLS))
            ends += status != 0
            wrongs += wrong
        bad += len(wrongs)
        rows.append([name, str(options.count), str(ends), str(len(wrongs))])
        print("  ".join(rows[-1]), *wrongs[:6], sep="\n  " if wrongs else "  ", flush=True)
    told.table("Odd calls", ["Function", "Calls", "Processes ended", "Wrong"], rows, "odd-calls")
    told.verdict(not bad, "each call returns, or raises ValueError or MemoryError")
    told.finish(options.json)


if __name__ == "__main__":
    main()
