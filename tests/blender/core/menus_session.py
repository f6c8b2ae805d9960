# SPDX-License-Identifier: GPL-3.0-or-later

"""Runs in a Blender with a window: opens every menu entry, panel and file handler of the add-on.

Usage: blender --factory-startup --enable-event-simulate --python menus_session.py -- RESULT.json
"""

import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import bpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.append(str(Path(__file__).resolve().parents[2] / "python"))

import bodies
import clouds
import entries
from entries import Call, Case
from window import (
    PACKAGE,
    Stage,
    begun,
    browser,
    chosen_in_browser,
    idle,
    moved,
    play,
    until,
    working_on,
)

RESULT = Path(sys.argv[sys.argv.index("--") + 1])
KINDS = ("VIEW_3D", "IMAGE_EDITOR", "PROPERTIES", "TEXT_EDITOR")

found: dict[str, Any] = {
    "problems": [],
    "calls": [],
    "dropped": [],
    "drawn_entries": [],
    "drawn": [],
}


def session() -> Iterator[None]:
    """Yields whenever Blender should draw and handle events before going on."""
    stage = begun()
    reports = Reports(stage)
    note_problems()
    entries.clear()
    offered, silent = entries.calls(stage.area)
    found["silent"] = sorted(silent)
    yield
    for call in offered:
        yield from called(stage, reports, call)
    yield from dropped(stage)
    yield from menus(stage)
    yield from panels(stage)
    RESULT.write_text(json.dumps(found))


def note_problems() -> None:
    """Has operators that work in the background note why they fail."""
    owner = sys.modules[f"{PACKAGE}.core.operator"].BackgroundOperator
    fail = owner._fail

    def noting(self: Any, problem: BaseException | str) -> set[str]:
        found["problems"].append(f"{self.bl_idname}: {problem}")
        return fail(self, problem)

    owner._fail = noting


class Reports:
    """The list of Blender's Info editor: the reports of all operators, errors or not."""

    def __init__(self, stage: Stage) -> None:
        """Makes the smallest area the editor."""
        self._window = stage.window
        areas = [area for area in stage.window.screen.areas if area != stage.area]
        self._area = min(areas, key=lambda area: area.width * area.height)
        self._area.type = "INFO"
        self._seen = 0

    def taken(self) -> list[str]:
        """Returns the reports since the last call."""
        region = next(one for one in self._area.regions if one.type == "WINDOW")
        manager = bpy.context.window_manager
        manager.clipboard = ""
        with bpy.context.temp_override(window=self._window, area=self._area, region=region):
            bpy.ops.info.select_all(action="SELECT")
            bpy.ops.info.report_copy()
        # Calls of operators are listed, too.
        lines = [one for one in manager.clipboard.splitlines() if not one.startswith("bpy.")]
        new, self._seen = lines[self._seen :], len(lines)
        return new


def called(stage: Stage, reports: Reports, call: Call) -> Iterator[None]:
    """Runs the operators of a menu, each in the scene that it needs, and records the results."""
    case = entries.case_of(call)
    entries.clear()
    yield
    shown = case.scene()
    reports.taken()
    operator = entries.operator_of(call.operator)
    note: dict[str, Any] = {"menu": call.menu, "operator": call.operator}
    found["calls"].append(note)
    with entries.editor(stage.area, entries.editor_of(call.menu), shown):
        note["polls"] = operator.poll()
        if not note["polls"]:
            return
        try:
            note["begun"] = sorted(operator("INVOKE_DEFAULT", **call.properties_now()))
        except RuntimeError as error:
            note["problem"] = str(error)
            return
    yield from answered(stage, case)
    note["done"] = reports.taken()
    note["browses"] = browser() is not None


def answered(stage: Stage, case: Case) -> Iterator[None]:
    """Gives an operator the file or the key that it waits for, and waits until it has ended."""
    yield
    if case.file == "/":
        yield from chosen_in_browser(RESULT.parent)
    elif case.file:
        path = RESULT.with_name(case.file)
        if path.suffix in {".svg", ".xyz"}:
            entries.write_file(path)
        yield from chosen_in_browser(path.parent, path.name)
    if case.key:
        x, y = stage.area.x + stage.area.width // 2, stage.area.y + stage.area.height // 2
        yield from moved(stage.window, x, y)
        yield
        for value in ("PRESS", "RELEASE"):
            stage.window.event_simulate(type=case.key, value=value, x=x, y=y)
            yield
    yield from until(idle)
    yield


def dropped(stage: Stage) -> Iterator[None]:
    """Simulates the drop of a file of each extension that a handler names."""
    for handler in entries.handlers():
        operator = entries.operator_of(handler.bl_import_operator)
        for extension in handler.bl_file_extensions.split(";"):
            entries.clear()
            yield
            path = entries.write_dropped(RESULT.parent, extension)
            note: dict[str, Any] = {"handler": handler.__name__, "extension": extension}
            found["dropped"].append(note)
            note["editors"] = []
            for kind in KINDS:
                with entries.editor(stage.area, kind, None):
                    if handler.poll_drop(bpy.context):
                        note["editors"].append(kind)
            with entries.editor(stage.area, note["editors"][0], None):
                operator("INVOKE_DEFAULT", **entries.as_dropped(operator, path))
            yield
            yield
            if operator.get_rna_type().identifier == "PREFILTER_OT_drop_points":
                stage.window.event_simulate(type="I", value="PRESS", unicode="i")
            yield from until(lambda: idle() and bool(bpy.data.objects or bpy.data.images))
            yield
            note["points"] = [len(clouds.points(obj)) for obj in bpy.data.objects]
            note["images"] = [list(image.size) for image in bpy.data.images]


def menus(stage: Stage) -> Iterator[None]:
    """Opens the menus, and notes which entries are drawn."""
    entries.clear()
    shown = entries.drawn()
    entries.textured()
    drawn: set[str] = set()
    for name, draw in entries.appended():
        replace_draw(getattr(bpy.types, name), draw, drawn)
    for name in sorted({name for name, _ in entries.appended()}):
        kind = entries.editor_of(name)
        if name == "VIEW3D_MT_sculpt":
            entries.clear()
            entries.sculpted()
            shown = None
        with entries.editor(stage.area, kind, shown):
            if issubclass(getattr(bpy.types, name), bpy.types.Menu):
                bpy.ops.wm.call_menu(name=name)
        stage.area.tag_redraw()
        yield
        yield
        stage.escape()
        yield
    found["drawn_entries"] = sorted(drawn)
    found["entries"] = sorted({name for name, _ in entries.appended()})


def replace_draw(owner: type, draw: Any, drawn: set[str]) -> None:
    """Has an entry note that it was drawn to the end."""

    def noting(self: Any, context: bpy.types.Context) -> None:
        draw(self, context)
        drawn.add(owner.__name__)

    noting.__module__ = draw.__module__
    functions = getattr(owner.draw, "_draw_funcs", None)
    if functions is not None:
        functions[functions.index(draw)] = noting


def panels(stage: Stage) -> Iterator[None]:
    """Shows every scene in every editor, and notes which panels are drawn."""
    drawn: set[str] = set()
    unfold(drawn)
    for scene in entries.PANEL_SCENES:
        stage.area.type = "VIEW_3D"
        yield from until(lambda: not bpy.app.is_job_running("RENDER_PREVIEW"))
        entries.clear()
        yield
        shown = scene()
        for kind in KINDS:
            with entries.editor(stage.area, kind, shown):
                pass
            if kind == "PROPERTIES":
                yield from properties(stage)
            elif not (scene is entries.sculpted and kind != "VIEW_3D"):
                yield from stage.open_tab()
            yield from stage.redrawn()
    yield from queued(stage)
    entries.clear()
    stage.area.type = "VIEW_3D"
    yield
    for panel in entries.panels():
        if panel.bl_region_type == "HEADER":
            with bpy.context.temp_override(**stage.override):
                bpy.ops.wm.call_panel(name=panel.__name__)
            yield
            yield
            stage.escape()
            yield
    found["drawn"] = sorted(drawn)
    found["panels"] = sorted(panel.__name__ for panel in entries.panels())


def queued(stage: Stage) -> Iterator[None]:
    """Shows the queue while a job runs and another one waits."""
    entries.clear()
    bodies.cube()
    with working_on("voxels.voxelization", "Voxelization", until_cancelled=False):
        for _ in range(2):
            with entries.editor(stage.area, "VIEW_3D", None):
                bpy.ops.prefilter.voxelize("INVOKE_DEFAULT")
        for kind in ("VIEW_3D", "IMAGE_EDITOR"):
            stage.area.type = kind
            yield from stage.open_tab()
            yield from stage.redrawn()
    yield from until(idle)


def properties(stage: Stage) -> Iterator[None]:
    """Shows the tabs of the Properties editor that the scene has."""
    for tab in ("RENDER", "DATA"):
        try:
            stage.area.spaces.active.context = tab
        except TypeError:
            continue
        yield from stage.redrawn()


def unfold(drawn: set[str]) -> None:
    """Opens all panels and their subpanels, and records which of them are drawn."""
    own = entries.panels()
    around = {one for panel in own for one in entries.ancestors(panel)} - set(own)
    both = sorted(around, key=entries.depth_of) + own
    for panel in reversed(both):
        bpy.utils.unregister_class(panel)
    for panel in both:
        panel.bl_options = set(getattr(panel, "bl_options", ())) - {"DEFAULT_CLOSED"}
        if panel in own:
            note_draw(panel, drawn)
        bpy.utils.register_class(panel)
    sidebar = sys.modules[f"{PACKAGE}.core.sidebar"]
    closed = sidebar.subpanel

    def opened(layout: bpy.types.UILayout, name: str, title: str) -> Any:
        header, body = layout.panel(f"PREFILTER_{name}_opened", default_closed=False)
        header.label(text=title)
        return header, body

    for name, module in list(sys.modules.items()):
        if name.startswith(PACKAGE) and getattr(module, "subpanel", None) is closed:
            module.subpanel = opened


def note_draw(panel: type, drawn: set[str]) -> None:
    """Has a panel note that it was drawn to the end."""
    original = panel.draw

    def draw(self: Any, context: bpy.types.Context) -> None:
        original(self, context)
        drawn.add(panel.__name__)

    panel.draw = draw


play(session())
