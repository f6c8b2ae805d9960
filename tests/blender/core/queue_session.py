# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: fills the queue, pauses and cancels its jobs by mouse.

Usage: blender --factory-startup --enable-event-simulate --python queue_session.py -- RESULT.json
"""

import importlib
import json
import sys
import time
from collections.abc import Generator, Iterator
from pathlib import Path

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import bodies
import scenes
from window import (
    PACKAGE,
    RedoPanel,
    Stage,
    begun,
    clicked,
    idle,
    moved,
    picture,
    play,
    region,
    until,
    without_objects,
    working_on,
)

RESULT = Path(sys.argv[sys.argv.index("--") + 1])

found: dict[str, object] = {}
queue = None


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    global queue
    stage = begun()
    bpy.ops.prefilter.dismiss_welcome()
    queue = importlib.import_module(f"{PACKAGE}.core.queue")
    bpy.utils.register_class(BakePanel)
    bpy.utils.register_class(VoxelizePanel)
    yield from by_mouse(stage)
    yield from mouse_over_progress(stage)
    yield from steps_of_their_own(stage)
    yield from what_goes_meanwhile(stage)
    yield from threads_rest(stage)
    yield from another_file(stage)
    RESULT.write_text(json.dumps(found))


def by_mouse(stage: Stage) -> Iterator[None]:
    """Queues two bakes and a voxelize; pauses the running job, then cancels all."""
    without_objects()
    for i, name in enumerate(("First", "Second")):
        scenes.textured_quad(scenes.image(name, scenes.noise(64, 64))).location.x = 3.0 * i
    bodies.sphere("Ball", subdivisions=3)
    stage.area.type = "IMAGE_EDITOR"
    yield from sidebar(stage, "Button")
    told = found["mouse"] = {"listed": [], "before": is_shown()}
    with working_on("textures.bake", "Bake", until_cancelled=False):
        stage.area.spaces.active.image = bpy.data.images["First"]
        yield from stage.redrawn()
        yield from clicked(stage.window, *button(stage, 0.3))
        yield from until(lambda: listed())
        stage.area.spaces.active.image = bpy.data.images["Second"]
        # The button that adds stands before the progress.
        yield from stage.redrawn()
        yield from clicked(stage.window, *button(stage, 0.07))
        yield from until(lambda: len(listed()) == 2)
        stage.area.spaces.active.image = bpy.data.images["First"]
        stage.area.type = "VIEW_3D"
        chosen("Ball")
        yield from sidebar(stage, "Button")
        yield from clicked(stage.window, *button(stage, 0.3))
        yield from until(lambda: len(listed()) == 3)
        told["listed"].append(listed())
        # The selection and the image of another moment.
        chosen()
        yield from sidebar(stage, "Prefilter")
        told["drawn"] = is_shown()
        yield from pressed(stage, "use_pause", 0)
        yield from until(lambda: running_text().startswith("Paused"))
        told["paused"] = running_text()
        yield from pressed(stage, "use_pause", 0)
        yield from until(lambda: running_text() == "50 %")
        yield from pressed(stage, "use_cancel", 1)
        yield from until(lambda: listed()[1][1] != "WAITING")
        told["listed"].append(listed())
    with working_on("voxels.voxelization", "Voxelization"):
        yield from until(lambda: listed()[2][1] == "RUNNING")
        told["listed"].append(listed())
        told["levels"] = [name in bpy.data.images for name in ("First.mip01", "Second.mip01")]
        yield from stage.redrawn()
        yield from pressed(stage, "use_cancel", 2)
        yield from until(idle)
    told["listed"].append(listed())
    yield from sidebar(stage, "Prefilter")
    told["ball"] = vertices("Ball")
    bpy.ops.prefilter.clear_queue()
    told["cleared"] = [listed(), is_shown()]


def mouse_over_progress(stage: Stage) -> Iterator[None]:
    """Leaves the mouse where it pressed until the work is over, and checks the drawing."""
    yield from sidebar(stage, "Button")
    with working_on("voxels.voxelization", "Voxelization", until_cancelled=False):
        chosen("Ball")
        bpy.context.scene.prefilter_voxelize.depth = 5
        yield from stage.redrawn()
        yield from clicked(stage.window, *button(stage, 0.4))
        yield from until(lambda: running_text() == "50 %")
        for _ in range(8):
            yield
        told = found["blue"] = [(yield from blue(stage))]
    yield from until(idle)
    for _ in range(8):
        yield
    told.append((yield from blue(stage)))
    bpy.ops.ed.undo_push(message="before")


def blue(stage: Stage) -> Generator[None, None, int]:
    """Returns the number of pixels of the sidebar that are as blue as a selection or progress."""
    there = (yield from picture(stage.area, "UI")).astype(int)
    return int(((there[..., 2] > 140) & (there[..., 0] < 100)).sum())


def steps_of_their_own(stage: Stage) -> Iterator[None]:
    """Voxelizes two objects, one of which gets another name; undoes both, and changes one."""
    without_objects()
    for i, name in enumerate(("One", "Two", "Other")):
        bodies.sphere(name, subdivisions=3, location=(3.0 * i, 0, 0))
    bpy.ops.ed.undo_push(message="before")
    for name in ("One", "Two"):
        chosen(name)
        voxelize(stage, depth=5)
    chosen("Other")
    bpy.data.objects["Two"].name = "Too"
    yield from until(idle)
    yield
    told = found["steps"] = {"done": listed(), "after": counts()}
    yield from stage.redo_panel()
    panel = RedoPanel(stage.window, stage.area)
    yield from panel.step("depth")
    yield from until(lambda: counts() != told["after"])
    told["redone"] = counts()
    bpy.ops.ed.undo()
    yield
    told["undone_once"] = counts()
    bpy.ops.ed.undo()
    yield
    told["undone_twice"] = counts()
    bpy.ops.prefilter.clear_queue()


def what_goes_meanwhile(stage: Stage) -> Iterator[None]:
    """Deletes an object whose turn has not come, hides one, and is in another mode for a while."""
    without_objects()
    for name in ("First", "Gone", "Hidden", "Last"):
        bodies.sphere(name, subdivisions=3)
    with working_on("voxels.voxelization", "Voxelization", until_cancelled=False):
        for name in ("First", "Gone", "Hidden", "Last"):
            chosen(name)
            voxelize(stage, depth=5)
        yield
        bpy.data.objects.remove(bpy.data.objects["Gone"])
        bpy.data.objects["Hidden"].hide_set(True)
        chosen("Last")
        with bpy.context.temp_override(**stage.override):
            bpy.ops.object.mode_set(mode="EDIT")
    yield from until(lambda: queue.listed()[1].message)
    told = found["meanwhile"] = {"waits": queue.listed()[1].message}
    with bpy.context.temp_override(**stage.override):
        bpy.ops.object.mode_set(mode="OBJECT")
    yield from until(idle)
    yield
    told["listed"] = [[job.state.name, job.message] for job in queue.listed()]
    told["last"] = vertices("Last")
    bpy.ops.prefilter.clear_queue()


def other_threads() -> float:
    """Returns the processor time of all threads but this one, in seconds."""
    return time.process_time() - time.thread_time()


def threads_rest(stage: Stage) -> Iterator[None]:
    """Measures how much of the processor work takes that runs, and work that is paused."""
    without_objects()
    bodies.sphere("Ball", subdivisions=6)
    chosen("Ball")
    voxelize(stage, depth=10)
    yield from until(lambda: running_text() not in {"", "0 %"})
    told = found["rest"] = {}
    at_work = other_threads()
    # Beside other programs this takes longer.
    yield from until(lambda: other_threads() - at_work > 1.0)
    told["works"] = other_threads() - at_work
    switches().use_pause[slot_of(0)] = True
    yield from until(lambda: running_text().startswith("Paused"))
    for _ in range(6):
        yield
    at_rest, began = other_threads(), time.monotonic()
    yield from until(lambda: time.monotonic() - began > 1.0)
    told["rests"] = other_threads() - at_rest
    switches().use_cancel[slot_of(0)] = True
    yield from until(idle)
    told["ball"] = vertices("Ball")


def another_file(stage: Stage) -> Iterator[None]:
    """Loads a file while work is paused and more waits."""
    without_objects()
    bodies.sphere("Ball", subdivisions=5)
    for _ in range(3):
        chosen("Ball")
        voxelize(stage, depth=9)
    switches().use_pause[slot_of(0)] = True
    yield from until(lambda: running_text().startswith("Paus"))
    told = found["file"] = {"before": [state for _, state in listed()]}
    bpy.ops.wm.read_homefile(use_empty=True)
    yield
    yield
    told["after"] = [listed(), idle()]
    bodies.cube("Next")
    chosen("Next")
    yield
    window = bpy.context.window_manager.windows[0]
    area = next(one for one in window.screen.areas if one.type == "VIEW_3D")
    voxelize(Stage(window, area), depth=5)
    yield from until(idle)
    told["next"] = len(bpy.data.objects["Next"].data.vertices)
    told["left"] = listed()


class _ButtonPanel:
    bl_label = "Button"
    bl_region_type = "UI"
    bl_category = "Button"

    def draw(self, context: bpy.types.Context) -> None:
        """Draws the main button, large."""
        self.layout.scale_y = 4.0
        module, name = self.button
        made = getattr(importlib.import_module(f"{PACKAGE}.{module}"), name)
        made.draw_main(self.layout, context)
        self.layout.label(text="Below", icon="INFO")


class BakePanel(_ButtonPanel, bpy.types.Panel):
    """The button of the bake."""

    bl_idname = "TEST_PT_bake"
    bl_space_type = "IMAGE_EDITOR"
    button = ("textures.menus", "BAKE_BUTTON")


class VoxelizePanel(_ButtonPanel, bpy.types.Panel):
    """The button of voxelizing."""

    bl_idname = "TEST_PT_voxelize"
    bl_space_type = "VIEW_3D"
    button = ("voxels.panel", "_VOXELIZE")


def sidebar(stage: Stage, tab: str) -> Iterator[None]:
    """Shows a tab."""
    stage.area.spaces.active.show_region_ui = True
    yield from until(lambda: stage.tab != "UNSUPPORTED")
    region(stage.area, "UI").active_panel_category = tab
    yield from stage.redrawn()
    yield from stage.redrawn()


def button(stage: Stage, share: float) -> tuple[int, int]:
    """Returns where the large button is, at a share of its width."""
    side = region(stage.area, "UI")
    return side.x + round(share * side.width), side.y + side.height - 80


def pressed(stage: Stage, name: str, number: int) -> Iterator[None]:
    """Presses the button that cancels or pauses a job, wherever in the tab it is."""
    side, slot = region(stage.area, "UI"), slot_of(number)
    x = side.x + side.width - 40
    for below_top in range(20, side.height - 20, 8):
        y = side.y + side.height - below_top
        yield from moved(stage.window, x, y)
        if under(stage, side) == ("use_cancel", slot):
            if name == "use_pause":
                x -= 22
                yield from moved(stage.window, x, y)
            assert under(stage, side) == (name, slot), under(stage, side)
            yield from clicked(stage.window, x, y)
            return
    raise AssertionError(f"no button {name} of job {number}")


def under(stage: Stage, side: bpy.types.Region) -> tuple[str, int] | None:
    """Returns the property under the mouse, and its index."""
    with bpy.context.temp_override(window=stage.window, area=stage.area, region=side):
        found_there = bpy.context.property
    if found_there is None:
        return None
    return found_there[1].rpartition(".")[2].partition("[")[0], found_there[2]


def slot_of(number: int) -> int:
    """Returns the index of the buttons of a job."""
    return queue.listed()[number].switches._index


def switches() -> bpy.types.PropertyGroup:
    """Returns the buttons of all jobs."""
    return bpy.context.window_manager.prefilter_switches


def listed() -> list[list[str]]:
    """Returns the jobs that the panel lists."""
    return [[job.title, job.state.name] for job in queue.listed()]


def running_text() -> str:
    """Returns how far the first job is; empty while it does not run."""
    jobs = queue.listed()
    return jobs[0].run.text if jobs and jobs[0].run is not None else ""


def is_shown() -> bool:
    """Returns whether the tab has the panel."""
    return bpy.types.PREFILTER_PT_queue.poll(bpy.context)


def chosen(*names: str) -> None:
    """Selects objects."""
    for obj in bpy.data.objects:
        obj.select_set(obj.name in names)
    bpy.context.view_layer.objects.active = bpy.data.objects[names[0]] if names else None


def voxelize(stage: Stage, **settings: object) -> None:
    """Presses Voxelize; so that sizes tell depths, triangles stay small."""
    settings = {"adaptivity": 0.0, **settings}
    with bpy.context.temp_override(**stage.override):
        assert bpy.ops.prefilter.voxelize("INVOKE_DEFAULT", True, **settings) == {"RUNNING_MODAL"}


def vertices(name: str) -> int:
    """Returns how many vertices an object's mesh has."""
    return len(bpy.data.objects[name].data.vertices)


def counts() -> list[int]:
    """Returns how many vertices the objects have that there were at first, by their names."""
    there = [name for name in ("One", "Other", "Too", "Two") if name in bpy.data.objects]
    return [vertices(name) for name in there]


play(session())
