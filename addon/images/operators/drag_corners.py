# SPDX-License-Identifier: GPL-3.0-or-later

"""`prefilter.drag_corners`: the corners of Resample, dragged on the image."""

from typing import TYPE_CHECKING, Any

import bpy

from ...core.translations import marked, report, tr
from ..choices import CORNERS
from ..view import pins as drawn

if TYPE_CHECKING:
    from ..pins import Canvas

_ARROWS = {
    "LEFT_ARROW": (-1.0, 0.0),
    "RIGHT_ARROW": (1.0, 0.0),
    "DOWN_ARROW": (0.0, -1.0),
    "UP_ARROW": (0.0, 1.0),
}
_FAR, _NEAR = 10.0, 0.1
_KEYS = marked(
    "Drag: Move Corner   Ctrl: Whole Pixels and Edges   Shift: Slowly   Arrows: By a Pixel   "
    "Tab: Next Corner   Enter: Keep   Esc: Take Back"
)


class PREFILTER_OT_drag_corners(bpy.types.Operator):
    """Drags the corners of Resample."""

    bl_idname = "prefilter.drag_corners"
    bl_label = "Drag Corners"
    bl_description = (
        "Drag the four corners on the image. Ctrl snaps to whole pixels and edges, Shift moves "
        "slowly, arrow keys move by a pixel, Tab goes to the next corner. Enter or another press "
        "keeps the corners, Esc takes them back"
    )

    # Not REGISTER, so that Adjust Last Operation still shows the operator before.
    bl_options: set[str] = set()

    _before: dict[str, Any]
    # Any, because Blender evaluates annotations, and `Drag` is not imported at run time.
    _drag: Any = None
    _start: tuple[float, ...] = ()

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Returns whether an Image editor shows an image."""
        if context.area is None or context.area.type != "IMAGE_EDITOR":
            cls.poll_message_set(tr("Call it in an Image editor"))
            return False
        image = context.space_data.image
        if image is None or not all(image.size):
            cls.poll_message_set(tr("Open an image in this editor first"))
            return False
        return True

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Reports that a window is needed."""
        del context
        text = report("Drag Corners needs a window; set the corners as numbers instead")
        self.report({"ERROR"}, text)
        return {"CANCELLED"}

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Starts dragging; ends it if it is running."""
        del event
        from ..pins import initial_changes

        if bpy.app.background:
            return self.execute(context)
        if drawn.session is not None:
            drawn.session.is_over = True
            return {"FINISHED"}
        group = context.scene.prefilter_resample
        self._before = {name: _value(group, name) for name in ("warp", *CORNERS)}
        image = group.source_of(context.space_data.image)
        context.space_data.image = image
        drawn.begin(image)
        changed = initial_changes(group.to_settings())
        if changed:
            _set(context, changed, marked("Begin to Drag Corners"))
        context.workspace.status_text_set(tr(_KEYS))
        context.window_manager.modal_handler_add(self)
        context.area.tag_redraw()
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Handles the mouse and keys over the image, and passes other events to Blender."""
        if self._is_over(context):
            return self._end(context)
        if event.type.startswith("TIMER"):
            return {"PASS_THROUGH"}
        if self._drag is not None:
            self._follow(context, event)
            return {"RUNNING_MODAL"}
        if not _is_over_canvas(context, event):
            return {"PASS_THROUGH"}
        if event.value != "PRESS":
            return {"PASS_THROUGH"} if event.type != "LEFTMOUSE" else {"RUNNING_MODAL"}
        if event.type in {"RET", "NUMPAD_ENTER"}:
            return self._end(context)
        if event.type in {"ESC", "RIGHTMOUSE"}:
            return self._revert(context)
        if event.type == "LEFTMOUSE":
            self._grab(context, event)
        elif event.type == "TAB":
            self._select_next(context, -1 if event.shift else 1)
        elif event.type in _ARROWS:
            self._nudge(context, event)
        else:
            return {"PASS_THROUGH"}
        return {"RUNNING_MODAL"}

    def cancel(self, context: bpy.types.Context) -> None:
        """Stops when Blender ends the operator, as when it loads another file."""
        self._end(context)

    def _is_over(self, context: bpy.types.Context) -> bool:
        session = drawn.session
        image = getattr(context.space_data, "image", None)
        return (
            session is None
            or session.is_over
            or not drawn.is_on(image)
            or context.scene.prefilter_resample.warp == "affine"
        )

    def _end(self, context: bpy.types.Context) -> set[str]:
        drawn.end()
        if context.workspace is not None:
            context.workspace.status_text_set(None)
        _redraw()
        return {"FINISHED"}

    def _revert(self, context: bpy.types.Context) -> set[str]:
        group = context.scene.prefilter_resample
        if any(_value(group, name) != value for name, value in self._before.items()):
            _set(context, self._before, marked("Take Corners Back"))
        self._end(context)
        return {"CANCELLED"}

    def _grab(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        from ..pins import REACH, Drag, nearest

        assert drawn.session is not None
        canvas, points, _ = _corners_in_editor(context)
        mouse = _mouse(context, event)
        index = nearest(points, canvas, mouse, REACH * context.preferences.system.ui_scale)
        if index is None:
            return
        drawn.session.active = index
        self._drag = Drag(points[index], mouse)
        self._start = _value(context.scene.prefilter_resample, CORNERS[index])
        context.area.tag_redraw()

    def _follow(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        """Moves the dragged corner, releases it, or reverts it."""
        assert drawn.session is not None
        assert self._drag is not None
        name = CORNERS[drawn.session.active]
        group = context.scene.prefilter_resample
        if event.type == "MOUSEMOVE":
            canvas, _, edges = _corners_in_editor(context)
            mouse, slow, snaps = _mouse(context, event), event.shift, event.ctrl
            self._move(context, self._drag.to(mouse, canvas, edges, is_slow=slow, snaps=snaps))
        elif event.type in {"ESC", "RIGHTMOUSE"} and event.value == "PRESS":
            setattr(group, name, self._start)
            self._drag = None
        elif event.type == "LEFTMOUSE" and event.value == "RELEASE":
            self._drag = None
            if _value(group, name) != self._start:
                bpy.ops.ed.undo_push(message="Drag Corner")
        _redraw()

    def _select_next(self, context: bpy.types.Context, step: int) -> None:
        assert drawn.session is not None
        drawn.session.active = (drawn.session.active + step) % len(CORNERS)
        context.area.tag_redraw()

    def _nudge(self, context: bpy.types.Context, event: bpy.types.Event) -> None:
        assert drawn.session is not None
        _, points, _ = _corners_in_editor(context)
        distance = _NEAR if event.shift else _FAR if event.ctrl else 1.0
        step = tuple(distance * x for x in _ARROWS[event.type])
        self._move(context, points[drawn.session.active] + step)
        bpy.ops.ed.undo_push(message="Nudge Corner")

    def _move(self, context: bpy.types.Context, point: Any) -> None:
        from ..pins import shares

        assert drawn.session is not None
        group = context.scene.prefilter_resample
        size = tuple(context.space_data.image.size)
        setattr(group, CORNERS[drawn.session.active], shares(point, group.to_settings(), size))
        _redraw()


def _corners_in_editor(context: bpy.types.Context) -> tuple["Canvas", Any, tuple[int, int]]:
    """Returns the position of the image, the corners, and the size of the frame around them."""
    from prefilter.workflows.images.placement import corners, frame

    settings = context.scene.prefilter_resample.to_settings()
    size = tuple(context.space_data.image.size)
    canvas = drawn.canvas_of(_canvas_region(context), size)
    return canvas, corners(settings, *size), frame(settings, *size)


def _canvas_region(context: bpy.types.Context) -> bpy.types.Region:
    return next(region for region in context.area.regions if region.type == "WINDOW")


def _mouse(context: bpy.types.Context, event: bpy.types.Event) -> tuple[int, int]:
    """Returns the mouse position in the region of the image."""
    region = _canvas_region(context)
    return event.mouse_x - region.x, event.mouse_y - region.y


def _is_over_canvas(context: bpy.types.Context, event: bpy.types.Event) -> bool:
    """Returns whether the mouse is over the image's region, and not over an overlapping one."""

    def holds(region: bpy.types.Region) -> bool:
        x, y = event.mouse_x - region.x, event.mouse_y - region.y
        return 0 <= x < region.width and 0 <= y < region.height

    others = [region for region in context.area.regions if region.type != "WINDOW"]
    return holds(_canvas_region(context)) and not any(
        holds(region) for region in others if min(region.width, region.height) > 1
    )


def _value(group: Any, name: str) -> Any:
    value = getattr(group, name)
    return value if isinstance(value, str) else tuple(value)


def _set(context: bpy.types.Context, values: dict[str, Any], message: str) -> None:
    """Changes settings, as one undo step."""
    for name, value in values.items():
        setattr(context.scene.prefilter_resample, name, value)
    bpy.ops.ed.undo_push(message=message)


def _redraw() -> None:
    from ...bridge import editors

    editors.redraw()
