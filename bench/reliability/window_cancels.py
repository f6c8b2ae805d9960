# SPDX-License-Identifier: GPL-3.0-or-later

"""Tests whether work that is canceled by Esc in a window leaves anything.

Operators start as users start them, and Esc is pressed at a random moment of the time that each
takes. Nothing may have changed in the scene but by work that was done already; memory, files,
threads and data-blocks of Blender are to be flat, as in soak.py.

usage: blender --enable-event-simulate --python window_cancels.py -- [PATTERN] [--count N]
  [--json FILE]
  scripts/run xvfb-run -a blender --enable-event-simulate \\
    --python bench/reliability/window_cancels.py
"""

import argparse
import os
import random
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "blender")]

import bodies  # noqa: E402
import clouds  # noqa: E402
import scenes  # noqa: E402
from window import Stage, begun, idle, play, until, without_objects  # noqa: E402

from bench import report  # noqa: E402
from bench.reliability.soak import MOST_KIB_PER_RUN, State  # noqa: E402

UNDO_STEPS = 4


def select(name: str) -> None:
    """Makes an object the only one that is selected."""
    for obj in bpy.data.objects:
        obj.select_set(obj.name == name)
    bpy.context.view_layer.objects.active = bpy.data.objects[name]


def bake() -> None:
    """Bakes an image of 1024 x 1024 texels."""
    select("Quad")
    bpy.ops.prefilter.bake_mipmaps("INVOKE_DEFAULT", image="Paint")


def resize() -> None:
    """Fits a smaller image."""
    select("Quad")
    bpy.ops.prefilter.resize_image("INVOKE_DEFAULT", image="Large")


def voxelize() -> None:
    """Voxelizes a ball at a depth that takes a while."""
    select("Ball")
    bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", depth=7)


def reconstruct() -> None:
    """Makes the surface of points."""
    select("Scan")
    bpy.ops.prefilter.reconstruct("INVOKE_DEFAULT", depth=7)


WORK: dict[str, Callable[[], None]] = {
    "bake_mipmaps": bake,
    "resize_image": resize,
    "voxelize": voxelize,
    "reconstruct": reconstruct,
}


def scene() -> dict[str, tuple[int, ...]]:
    """Returns the scene's objects, images and meshes with their sizes."""
    return {
        **{f"object {one.name}": () for one in bpy.data.objects},
        **{f"image {one.name}": tuple(one.size) for one in bpy.data.images},
        **{
            f"mesh {one.name}": (len(one.vertices), len(one.polygons), len(one.attributes))
            for one in bpy.data.meshes
        },
    }


class Cancels:
    """Outcomes of the canceled work."""

    def __init__(self, count: int) -> None:
        """Takes how often each operator is started."""
        self._count = count
        self._chance = random.Random(1)
        self.rows: list[list[str]] = []
        self.failed: list[str] = []

    def of(self, stage: Stage, name: str) -> Iterator[None]:
        """Starts and cancels an operator again and again."""
        before, began = scene(), time.monotonic()
        yield from self._started(stage, name)
        yield from until(idle)
        seconds = time.monotonic() - began
        if scene() == before:
            self.failed.append(f"{name}: leaves nothing even where it is not canceled")
        yield from _taken_back(before)
        done, slowest, early = 0, 0.0, _at_rest()
        for run in range(self._count):
            yield from self._started(stage, name)
            end = time.monotonic() + self._chance.uniform(0.0, 0.8 * seconds)
            yield from until(lambda end=end: time.monotonic() >= end)
            pressed = time.monotonic()
            stage.escape()
            yield from until(idle)
            slowest = max(slowest, time.monotonic() - pressed)
            yield
            if scene() != before:
                done += 1
                yield from _taken_back(before)
            if scene() != before:
                self.failed.append(f"{name}: something is left of run {run}")
                return
            if run == max(self._count // 2, 1) - 1:
                early = _at_rest()
        last, runs = _at_rest(), self._count - max(self._count // 2, 1)
        self.rows.append(
            [
                name,
                f"{seconds:.1f}",
                str(self._count - done),
                str(done),
                f"{slowest:.1f}",
                f"{(last.kib - early.kib) / max(runs, 1):.1f}",
                str(last.files - early.files),
                str(last.threads - early.threads),
                str(last.blocks - early.blocks),
            ]
        )

    def _started(self, stage: Stage, name: str) -> Iterator[None]:
        bpy.ops.ed.undo_push(message="before")
        with bpy.context.temp_override(**stage.override):
            WORK[name]()
        yield


def _at_rest() -> State:
    """Returns the process's resources once no undo step holds a result."""
    for _ in range(UNDO_STEPS + 1):
        bpy.ops.ed.undo_push(message="rest")
    return State.now()


def _taken_back(before: dict[str, tuple[int, ...]]) -> Iterator[None]:
    for _ in range(2):
        if scene() != before:
            bpy.ops.ed.undo()
            yield


def session(count: int, pattern: str, path: Path | None) -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    bpy.context.preferences.edit.undo_steps = UNDO_STEPS
    without_objects()
    scenes.textured_quad(scenes.image("Paint", scenes.noise(1024, 1024))).name = "Quad"
    scenes.image("Large", scenes.noise(3072, 3072))
    bodies.sphere("Ball", subdivisions=5)
    clouds.scan(*clouds.torus(200_000))
    yield
    cancels = Cancels(count)
    for name in WORK:
        if pattern in name:
            yield from cancels.of(stage, name)
    told = report.Report()
    head = ["Operator", "Takes s", "Canceled", "Done before", "Slowest end s", "KiB a run"]
    told.table("Esc", [*head, "Files", "Threads", "Data-blocks"], cancels.rows, "cancels")
    told.verdict(not cancels.failed, f"nothing is left of canceled work {cancels.failed[:3]}")
    for index, what in ((6, "files"), (7, "threads"), (8, "data-blocks")):
        grown = [row[0] for row in cancels.rows if int(row[index]) > 0]
        told.verdict(not grown, f"as many {what} as before {' '.join(grown)}")
    grown = [row[0] for row in cancels.rows if float(row[5]) > MOST_KIB_PER_RUN]
    told.verdict(not grown, f"at most {MOST_KIB_PER_RUN:g} KiB a run more {' '.join(grown)}")
    try:
        told.finish(path)
    except SystemExit as ended:
        sys.stdout.flush()
        os._exit(int(ended.code or 0))
    sys.stdout.flush()


def main() -> None:
    """Plays the session."""
    arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    parser = argparse.ArgumentParser()
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--count", type=int, default=100, help="runs (default: %(default)s)")
    report.add_json_option(parser)
    options = parser.parse_args(arguments)
    play(session(options.count, options.pattern, options.json))


if __name__ == "__main__":
    main()
