# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: drags the corners of Resample on a picture of a facade.

Usage: blender --factory-startup --enable-event-simulate --python pins_session.py -- RESULT.json
"""

import importlib
import json
import sys
from collections.abc import Generator, Iterator
from pathlib import Path

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import scenes
import window as windows
from window import PACKAGE, Stage, begun, idle, moved, picture, play, region, until

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
windows.SECONDS_PER_STEP = 0.05
SIZE = (300, 200)
NAMES = ("lower_left", "lower_right", "upper_right", "upper_left")

found: dict[str, object] = {}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun("IMAGE_EDITOR", opened="PREFILTER_PT_resample")
    yield
    pixels = 0.3 * scenes.noise(SIZE[1], SIZE[0])
    pixels[60:140, 90:210, :3] = (1.0, 0.5, 0.1)
    pixels[..., 3] = 1.0
    stage.area.spaces.active.image = scenes.image("Facade", pixels)
    yield from stage.open_tab()
    yield from dragged(stage)
    yield from keys(stage)
    yield from taken_back(stage)
    yield from kept(stage)
    yield from anew(stage)
    RESULT.write_text(json.dumps(found))


def dragged(stage: Stage) -> Iterator[None]:
    """Presses the button, and drags corners, with and without Ctrl; undoes the last."""
    before = yield from picture(stage.area)
    yield from started(stage)
    found["warp"] = settings().warp
    found["corners at first"] = pixels()
    shown = yield from picture(stage.area)
    found["changed on screen"] = float(np.mean(shown != before))
    found["button"] = importlib.import_module(f"{PACKAGE}.images.view.pins").is_on(
        bpy.data.images["Facade"]
    )
    for index, place in enumerate(((90, 60), (210, 60), (210, 140), (90, 140))):
        yield from drag(stage, index, place, ctrl=True)
    found["dragged"] = pixels()
    found["straightened on screen"] = yield from orange(stage)
    yield from drag(stage, 2, (250, 180))
    found["before undo"] = pixels()[2]
    bpy.ops.ed.undo()
    yield from stage.redrawn()
    found["undone"] = pixels()
    found["runs after undo"] = not idle()


def keys(stage: Stage) -> Iterator[None]:
    """Moves corners by keys, and takes back a drag."""
    over = on_screen(stage, (150, 100))
    for key, options in (("RIGHT_ARROW", {}), ("UP_ARROW", {"ctrl": True}), ("TAB", {})):
        yield from pressed(stage, key, over, **options)
    yield from pressed(stage, "DOWN_ARROW", over, shift=True)
    found["nudged"] = pixels()
    x, y = on_screen(stage, pixels()[0])
    yield from moved(stage.window, x, y)
    stage.window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
    yield
    yield from moved(stage.window, x + 30, y + 30)
    found["while dragging"] = pixels()[0]
    stage.window.event_simulate(type="RIGHTMOUSE", value="PRESS", x=x + 30, y=y + 30)
    yield
    found["drag taken back"] = pixels()[0]
    found["runs after that"] = not idle()
    stage.window.event_simulate(type="LEFTMOUSE", value="RELEASE", x=x + 30, y=y + 30)
    yield


def taken_back(stage: Stage) -> Iterator[None]:
    """Takes all back by Esc."""
    yield from pressed(stage, "ESC", on_screen(stage, (150, 100)))
    yield from until(idle)
    found["after Esc"] = [settings().warp, *pixels()]


def kept(stage: Stage) -> Iterator[None]:
    """Keeps corners by Enter, and pins the image by its corners; resamples with the mouse."""
    settings().warp = "corners"
    yield from started(stage)
    yield from drag(stage, 1, (200, 50))
    yield from stage.redrawn()
    yield from pressed(stage, "RET", on_screen(stage, (100, 100)))
    yield from until(idle)
    found["after Enter"] = pixels()[1]
    yield from started(stage)
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.drag_corners("INVOKE_DEFAULT")
    yield from moved(stage.window, *on_screen(stage, (100, 90)))
    yield from until(idle)
    found["ends by a second press"] = True


def anew(stage: Stage) -> Iterator[None]:
    """Straightens the picture, and drags corners of the result, which move the source's corners."""
    settings().warp = "rectify"
    yield from started(stage)
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.resample_image("INVOKE_DEFAULT", warp="rectify", **corners())
    yield from until(lambda: stage.area.spaces.active.image.name == "Facade.rectified")
    yield from moved(stage.window, *on_screen(stage, (100, 90)))
    yield from until(idle)
    found["ends where the result is shown"] = True
    yield from stage.redrawn()
    yield from started(stage)
    found["dragged on"] = stage.area.spaces.active.image.name
    yield from pressed(stage, "RET", on_screen(stage, (100, 100)))
    yield from until(idle)


def settings() -> bpy.types.PropertyGroup:
    """Returns the settings of the panel."""
    return bpy.context.scene.prefilter_resample


def corners() -> dict[str, tuple[float, ...]]:
    """Returns the corners as the settings have them."""
    return {name: tuple(getattr(settings(), name)) for name in NAMES}


def pixels() -> list[list[float]]:
    """Returns the corners in pixels."""
    return (np.array(list(corners().values())) * SIZE).tolist()


def started(stage: Stage) -> Iterator[None]:
    """Starts the operator from the sidebar, as its button does."""
    with bpy.context.temp_override(**stage.override | {"region": region(stage.area, "UI")}):
        bpy.ops.prefilter.drag_corners("INVOKE_DEFAULT")
    yield from stage.redrawn()


def on_screen(stage: Stage, place: tuple[float, float]) -> tuple[int, int]:
    """Returns where a pixel of the image is in the window."""
    part = region(stage.area, "WINDOW")
    x, y = part.view2d.view_to_region(place[0] / SIZE[0], place[1] / SIZE[1], clip=False)
    return part.x + x, part.y + y


def drag(stage: Stage, index: int, place: tuple[float, float], **keys: bool) -> Iterator[None]:
    """Drags a corner to a pixel of the image."""
    x, y = on_screen(stage, pixels()[index])
    yield from moved(stage.window, x, y)
    stage.window.event_simulate(type="LEFTMOUSE", value="PRESS", x=x, y=y)
    yield
    x, y = on_screen(stage, place)
    for kind, value in (("MOUSEMOVE", "NOTHING"), ("LEFTMOUSE", "RELEASE")):
        stage.window.event_simulate(type=kind, value=value, x=x, y=y, **keys)
        yield


def pressed(stage: Stage, key: str, at: tuple[int, int], **keys: bool) -> Iterator[None]:
    """Presses a key."""
    yield from moved(stage.window, *at)
    for value in ("PRESS", "RELEASE"):
        stage.window.event_simulate(type=key, value=value, x=at[0], y=at[1], **keys)
        yield


def orange(stage: Stage) -> Generator[None, None, float]:
    """Returns how much of the lower left quarter of the editor has the facade's color."""
    shown = (yield from picture(stage.area)).astype(int)
    height, width = shown.shape[0] // 4, shown.shape[1] // 4
    corner = shown[:height, :width]
    return float(np.mean((corner[..., 0] > 230) & (corner[..., 2] < 60)))


play(session())
