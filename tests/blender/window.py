# SPDX-License-Identifier: GPL-3.0-or-later

"""Helpers of the sessions that run in a Blender with a window."""

import ctypes
import importlib
import os
import sys
import threading
import time
import traceback
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import addon_utils
import bpy
import numpy as np
import scenes
from numpy.typing import NDArray

PACKAGE = "bl_ext.user_default.prefilter"

SECONDS_PER_STEP = 0.05
NEVER_TOO_LONG = 1e6
LONGEST_WAIT = 240.0
"""Seconds after which an event that a session waits for counts as missing, on a busy machine."""


def until(condition: Callable[[], bool]) -> Iterator[None]:
    """Yields until a condition holds."""
    end = time.monotonic() + LONGEST_WAIT
    while time.monotonic() < end:
        yield
        if condition():
            return
    raise TimeoutError(f"waited {LONGEST_WAIT} s for {condition}")


def idle() -> bool:
    """Returns whether no operator of the add-on works."""
    return not any(
        operator.bl_idname.startswith("PREFILTER_OT")
        for window in bpy.context.window_manager.windows
        for operator in window.modal_operators
    )


@contextmanager
def held() -> Iterator[None]:
    """Holds work in threads back until it is cancelled, so that Esc never comes too late."""
    job = sys.modules[f"{PACKAGE}.core.jobs"].Job
    advance = job._advance

    def wait(self: Any, fraction: float) -> bool:
        self._cancelled.wait(LONGEST_WAIT)
        return advance(self, fraction)

    job._advance = wait
    try:
        yield
    finally:
        job._advance = advance


@contextmanager
def working_on(module: str, name: str, *, until_cancelled: bool = True) -> Iterator[None]:
    """Has work take until the end of the block, or until it is cancelled."""
    work = getattr(importlib.import_module(f"{PACKAGE}.{module}"), name)
    compute, is_over = work.compute, threading.Event()

    def wait(self: object, progress: Callable[[float], bool]) -> None:
        while progress(0.5) and (until_cancelled or not is_over.wait(0.01)):
            time.sleep(0.001)
        compute(self, progress)

    work.compute = wait
    try:
        yield
    finally:
        is_over.set()
        work.compute = compute


def moved(window: bpy.types.Window, x: int, y: int) -> Iterator[None]:
    """Moves the mouse."""
    window.event_simulate(type="MOUSEMOVE", value="NOTHING", x=x, y=y)
    yield


def clicked(window: bpy.types.Window, x: int, y: int) -> Iterator[None]:
    """Clicks."""
    yield from moved(window, x, y)
    for value in ("PRESS", "RELEASE"):
        window.event_simulate(type="LEFTMOUSE", value=value, x=x, y=y)
        yield


def stepped(window: bpy.types.Window, x: int, y: int, *, up: bool) -> Iterator[None]:
    """Turns the wheel with Ctrl, which steps through the values of a setting."""
    yield from moved(window, x, y)
    kind = "WHEELUPMOUSE" if up else "WHEELDOWNMOUSE"
    window.event_simulate(type=kind, value="PRESS", ctrl=True, x=x, y=y)
    yield
    yield


def cancelled(window: bpy.types.Window, area: bpy.types.Area) -> Iterator[None]:
    """Presses the first button Cancel in the sidebar of an area."""
    sidebar = region(area, "UI")
    x = sidebar.x + sidebar.width * 3 // 4
    for below_top in range(20, 120, 8):
        y = sidebar.y + sidebar.height - below_top
        yield from moved(window, x, y)
        with bpy.context.temp_override(window=window, area=area, region=sidebar):
            under = bpy.context.property
        if under is not None and "use_cancel" in under[1]:
            yield from clicked(window, x, y)
            return
    raise AssertionError("there is no button Cancel in the sidebar")


def pixels(area: bpy.types.Area, kind: str = "WINDOW") -> NDArray[np.uint8]:
    """Returns the pixels of a region on the X server, (height, width, 3), row 0 at the bottom.

    That may be older than what Blender has drawn; see `picture`.
    """
    part = region(area, kind)
    screen = scenes.screen(os.environ["FRAMEBUFFER"])
    return screen[part.y : part.y + part.height, part.x : part.x + part.width]


def picture(area: bpy.types.Area, kind: str = "WINDOW") -> Generator[None, None, NDArray[np.uint8]]:
    """Draws a region, waits until the X server shows it, and returns its pixels as `pixels` does.

    The server may be late on a busy machine. A change of the pointer's shape is sent behind the
    picture, and the server does one after the other: once it has the new pointer, which is
    invisible, it shows the picture.
    """
    area.tag_redraw()
    yield
    yield
    window, pointer = bpy.context.window_manager.windows[0], Pointer()
    before = pointer.serial()
    window.cursor_modal_set("NONE")
    yield from until(lambda: pointer.serial() != before)
    result = pixels(area, kind).copy()
    window.cursor_modal_restore()
    return result


class Pointer:
    """The X server's pointer image, by the extension XFixes."""

    class _Image(ctypes.Structure):
        """XFixesCursorImage, up to the last field that is read."""

        _fields_: ClassVar = [
            *((name, ctypes.c_short) for name in ("x", "y")),
            *((name, ctypes.c_ushort) for name in ("width", "height", "x_hot", "y_hot")),
            ("serial", ctypes.c_ulong),
        ]

    def __init__(self) -> None:
        """Connects to the server."""
        self._x = ctypes.CDLL("libX11.so.6")
        self._fixes = ctypes.CDLL("libXfixes.so.3")
        self._x.XOpenDisplay.restype = ctypes.c_void_p
        self._x.XFree.argtypes = [ctypes.c_void_p]
        self._fixes.XFixesGetCursorImage.restype = ctypes.POINTER(self._Image)
        self._fixes.XFixesGetCursorImage.argtypes = [ctypes.c_void_p]
        self._display = self._x.XOpenDisplay(None)

    def serial(self) -> int:
        """Returns a number that is another one for each shape of the pointer."""
        image = self._fixes.XFixesGetCursorImage(self._display)
        number = int(image.contents.serial)
        self._x.XFree(image)
        return number


def browser() -> bpy.types.Window | None:
    """Returns the window of the file browser, if it is open."""
    windows = bpy.context.window_manager.windows
    return next((one for one in windows if one.screen.areas[0].type == "FILE_BROWSER"), None)


def chosen_in_browser(folder: Path, name: str = "") -> Iterator[None]:
    """Chooses a file, or the folder, in the file browser that opens, and waits for the work."""
    window = yield from _opened_browser()
    params = window.screen.areas[0].spaces.active.params
    params.directory = bytes(folder)
    if name:
        params.filename = name
    yield
    yield from _closed(window, bpy.ops.file.execute)
    yield from until(idle)
    yield


def left_browser() -> Iterator[None]:
    """Cancels the file browser that opens."""
    window = yield from _opened_browser()
    yield from _closed(window, bpy.ops.file.cancel)


def _opened_browser() -> Generator[None, None, bpy.types.Window]:
    yield from until(lambda: browser() is not None)
    yield
    window = browser()
    assert window is not None
    return window


def _closed(window: bpy.types.Window, close: Callable[[], object]) -> Iterator[None]:
    with bpy.context.temp_override(window=window, area=window.screen.areas[0]):
        close()
    yield from until(lambda: browser() is None)
    yield


def place_of(
    window: bpy.types.Window, area: bpy.types.Area, command: str, kind: str = "UI"
) -> Generator[None, None, tuple[int, int]]:
    """Moves the mouse down a region until it is over a button, and returns where that is.

    Args:
        window: The window.
        area: The editor.
        command: The beginning of the button's call in Python, such as "prefilter.voxelize(".
        kind: The region.
    """
    within = region(area, kind)
    x = within.x + within.width // 2
    for below_top in range(8, within.height, 10):
        y = within.y + within.height - below_top
        yield from moved(window, x, y)
        if command_under(window, area, within).startswith(command):
            return x, y - 4
    raise AssertionError(f"there is no button {command}")


def command_under(window: bpy.types.Window, area: bpy.types.Area, within: bpy.types.Region) -> str:
    """Returns the call in Python of the button under the mouse; empty if there is none."""
    manager = bpy.context.window_manager
    manager.clipboard = ""
    with bpy.context.temp_override(window=window, area=area, region=within):
        if bpy.ops.ui.copy_python_command_button.poll():
            bpy.ops.ui.copy_python_command_button()
    return manager.clipboard.removeprefix("bpy.ops.")


def pressed(stage: "Stage", command: str, kind: str = "UI") -> Iterator[None]:
    """Clicks the button whose call in Python begins with something."""
    x, y = yield from place_of(stage.window, stage.area, command, kind)
    yield from clicked(stage.window, x, y)


def region(area: bpy.types.Area, kind: str) -> bpy.types.Region:
    """Returns the region of a kind."""
    return next(found for found in area.regions if found.type == kind)


@dataclass(frozen=True)
class Stage:
    """The largest editor of the window."""

    window: bpy.types.Window
    area: bpy.types.Area

    @property
    def override(self) -> dict[str, Any]:
        """Arguments of `temp_override` for running operators there."""
        return {"window": self.window, "area": self.area, "region": region(self.area, "WINDOW")}

    @property
    def tab(self) -> str:
        """The tab that the sidebar shows."""
        return region(self.area, "UI").active_panel_category

    def open_tab(self) -> Iterator[None]:
        """Opens the sidebar at the tab of the add-on, and draws that."""
        self.area.spaces.active.show_region_ui = True
        yield from until(lambda: self.tab != "UNSUPPORTED")
        region(self.area, "UI").active_panel_category = "Prefilter"
        yield from self.redrawn()

    def redrawn(self) -> Iterator[None]:
        """Draws the editor."""
        self.area.tag_redraw()
        yield
        yield

    def escape(self) -> None:
        """Presses Esc."""
        self.window.event_simulate(type="ESC", value="PRESS")

    def menus(self, *names: str) -> Iterator[None]:
        """Opens menus one after another."""
        for name in names:
            with bpy.context.temp_override(**self.override):
                bpy.ops.wm.call_menu(name=name)
            yield
            self.escape()
            yield

    def redo_panel(self) -> Iterator[None]:
        """Yields until Adjust Last Operation is open."""
        if region(self.area, "HUD").height < 40:
            yield from RedoPanel(self.window, self.area).unfolded()


def begun(kind: str = "", *, opened: str = "") -> Stage:
    """Enables the add-on, and returns the largest editor.

    Redo is never too slow to be done at once, and Esc never asks: on a busy machine all is slow.

    Args:
        kind: What editor it is to be; empty for the one that it is.
        opened: A panel that is to be open, as one that is closed is not drawn.
    """
    assert addon_utils.enable(PACKAGE, default_set=True) is not None
    importlib.import_module(f"{PACKAGE}.core.redo").QUICK_SECONDS = NEVER_TOO_LONG
    importlib.import_module(f"{PACKAGE}.core.runs").ASKING_SECONDS = NEVER_TOO_LONG
    panel = getattr(bpy.types, opened, None)
    if panel is not None and "DEFAULT_CLOSED" in getattr(panel, "bl_options", ()):
        bpy.utils.unregister_class(panel)
        panel.bl_options = set()
        bpy.utils.register_class(panel)
    return largest(kind)


def largest(kind: str = "") -> Stage:
    """Returns the largest editor, which becomes one of a kind."""
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    if kind:
        area.type = kind
    if area.type == "VIEW_3D":
        # These are slow in software rendering, and no session looks at them.
        bpy.context.preferences.system.viewport_aa = "OFF"
        area.spaces.active.overlay.show_overlays = False
        area.spaces.active.show_gizmo = False
    return Stage(window, area)


def without_objects() -> None:
    """Removes the objects of the file that Blender starts with."""
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)


class RedoPanel:
    """Adjust Last Operation, used with the mouse."""

    def __init__(self, window: bpy.types.Window, area: bpy.types.Area) -> None:
        """Takes the panel of an area, which an operator has opened there."""
        self._window = window
        self._region = region(area, "HUD")

    @property
    def operator(self) -> bpy.types.Operator:
        """The last operator."""
        return bpy.context.window_manager.operators[-1]

    def unfolded(self) -> Iterator[None]:
        """Opens the panel, of which Blender shows the title only."""
        folded = self._region.height
        yield from clicked(self._window, self._region.x + 40, self._region.y + 12)
        yield from until(lambda: self._region.height > folded)

    def step(self, name: str, *, up: bool = True) -> Iterator[None]:
        """Steps a setting, wherever in the panel it is; settings on the way step back and forth."""
        for below_top in range(36, self._region.height - 6, 18):
            before = getattr(self.operator.properties, name)
            settings = self._settings()
            yield from self._stepped(below_top, up=up)
            if getattr(self.operator.properties, name) != before:
                return
            if self._settings() != settings:
                # Meanwhile the panel may have other rows, and another height.
                yield from self._settled()
                yield from self._stepped(below_top, up=not up)
                yield from self._settled()
        raise AssertionError(f"no setting {name} in the redo panel")

    def apply(self) -> Iterator[None]:
        """Presses the button at the bottom."""
        x = self._region.x + self._region.width * 2 // 3
        yield from clicked(self._window, x, self._region.y + 18)

    def _stepped(self, below_top: int, *, up: bool) -> Iterator[None]:
        x = self._region.x + self._region.width * 3 // 4
        yield from stepped(self._window, x, self._region.y + self._region.height - below_top, up=up)

    def _settled(self) -> Iterator[None]:
        yield from until(idle)
        for _ in range(4):
            yield

    def _settings(self) -> dict[str, object]:
        return {key: str(value) for key, value in self.operator.properties.items()}


def play(session: Iterator[None]) -> None:
    """Runs a session, which yields whenever Blender should draw and handle events, then ends."""

    def step() -> float:
        try:
            next(session)
        except StopIteration:
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            os._exit(1)
        return SECONDS_PER_STEP

    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(step, first_interval=1.0, persistent=True)
