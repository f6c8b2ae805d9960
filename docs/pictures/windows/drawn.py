# SPDX-License-Identifier: GPL-3.0-or-later

"""Lists the contents of panels, in order: settings with labels and defaults, buttons, texts.

A photograph of panels carries this list as text, and a test compares it with the current panels.
Runs inside Blender, with or without a window.
"""

import json
from collections.abc import Iterator, Sequence
from typing import Any

import bpy

PAINT = "Paint"


def drawn(panels: Sequence[str]) -> list[dict[str, Any]]:
    """Returns the contents of panels and their subpanels for a square with an image.

    The scene is made anew: it loses all objects.
    """
    _make_scene()
    return [_drawn(panel) for name in panels for panel in family(getattr(bpy.types, name))]


def as_text(found: Sequence[dict[str, Any]]) -> str:
    """Returns the contents as text, a line per row."""
    lines = []
    for panel in found:
        lines.append(f"{panel['panel']} {panel['label']!r} in {panel['editor']}")
        lines += [f"  {json.dumps(row, ensure_ascii=True)}" for row in panel["rows"]]
    return "\n".join(lines)


def family(panel: type) -> Iterator[type]:
    """Yields a panel and all below it."""
    yield panel
    for other in registered_panels():
        if getattr(other, "bl_parent_id", "") == panel.__name__:
            yield from family(other)


def registered_panels() -> list[type]:
    """Returns the classes of all Python panels."""
    return [panel for panel in bpy.types.Panel.__subclasses__() if panel.is_registered]


class Layout:
    """A stand-in for a layout of Blender that records its contents."""

    def __init__(self, rows: list[list[Any]]) -> None:
        """Takes the list of records."""
        self._rows = rows

    def row(self, *, heading: str = "", **_: Any) -> "Layout":
        """Records the heading of a part."""
        if heading:
            self._rows.append(["heading", heading])
        return Layout(self._rows)

    column = box = split = grid_flow = column_flow = row

    def separator(self, **_: Any) -> None:
        """Records a gap."""
        self._rows.append(["gap"])

    def label(self, *, text: str = "", **_: Any) -> None:
        """Records a text."""
        self._rows.append(["text", text])

    def prop(self, data: Any, name: str, *, text: str | None = None, **_: Any) -> None:
        """Records a setting, with its label and default."""
        setting = data.bl_rna.properties[name]
        self._rows.append(
            ["setting", name, setting.name if text is None else text, _default(setting)]
        )

    def prop_search(
        self, data: Any, name: str, *_: Any, text: str | None = None, **__: Any
    ) -> None:
        """Records a setting that is chosen from a list."""
        self.prop(data, name, text=text)

    def prop_enum(self, data: Any, name: str, value: str, *, text: str | None = None) -> None:
        """Records one of the values of a setting."""
        self.prop(data, name, text=text)
        self._rows[-1].append(value)

    def operator(self, name: str, *, text: str | None = None, **_: Any) -> "_Properties":
        """Records a button."""
        module, _, function = name.partition(".")
        if text is None:
            text = getattr(getattr(bpy.ops, module), function).get_rna_type().name
        self._rows.append(["button", name, text])
        return _Properties()

    def progress(self, *, text: str = "", **_: Any) -> None:
        """Records a bar."""
        self._rows.append(["progress", text])

    def panel(self, name: str, *, default_closed: bool = False) -> tuple["Layout", "Layout"]:
        """Records a collapsible part, as if it were open."""
        self._rows.append(["panel", name, "closed" if default_closed else "open"])
        return Layout(self._rows), Layout(self._rows)

    def __getattr__(self, name: str) -> Any:
        """Returns a function that records its texts."""

        def other(*arguments: Any, **keywords: Any) -> "Layout":
            texts = [one for one in (*arguments, *keywords.values()) if isinstance(one, str)]
            self._rows.append([name, *texts])
            return Layout(self._rows)

        return other


class _Properties:
    """Accepts any property that a panel sets on the operator of a button."""


class _Panel:
    """A stand-in for a panel while it draws."""

    def __init__(self, panel: type, rows: list[list[Any]]) -> None:
        self._panel = panel
        self.layout = Layout(rows)

    def __getattr__(self, name: str) -> Any:
        found = getattr(self._panel, name)
        return found.__get__(self) if hasattr(found, "__get__") else found


def _drawn(panel: type) -> dict[str, Any]:
    rows: list[list[Any]] = []
    with _editor(panel.bl_space_type):
        for part in ("draw_header", "draw_header_preset", "draw"):
            if hasattr(panel, part):
                getattr(panel, part)(_Panel(panel, rows), bpy.context)
    return {
        "panel": panel.__name__,
        "label": panel.bl_label,
        "editor": panel.bl_space_type,
        "rows": rows,
    }


def _editor(kind: str) -> Any:
    """Returns a context in which an area of the screen is an editor of that kind."""
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = kind
    if kind == "IMAGE_EDITOR":
        area.spaces.active.image = bpy.data.images[PAINT]
    region = next(region for region in area.regions if region.type == "WINDOW")
    return bpy.context.temp_override(window=window, area=area, region=region)


def _make_scene() -> None:
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    image = bpy.data.images.new(PAINT, 64, 64)
    mesh = bpy.data.meshes.new("Square")
    corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    mesh.from_pydata([(*corner, 0.0) for corner in corners], [], [range(4)])
    mesh.uv_layers.new().uv.foreach_set("vector", [value for corner in corners for value in corner])
    material = bpy.data.materials.new("Painted")
    if material.node_tree is None:
        material.use_nodes = True
    nodes = material.node_tree.nodes
    texture = nodes.new("ShaderNodeTexImage")
    texture.image = image
    material.node_tree.links.new(
        texture.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"]
    )
    mesh.materials.append(material)
    square = bpy.data.objects.new("Square", mesh)
    bpy.context.scene.collection.objects.link(square)
    square.select_set(True)
    bpy.context.view_layer.objects.active = square
    bpy.context.view_layer.update()


def _default(setting: bpy.types.Property) -> Any:
    if setting.type in {"POINTER", "COLLECTION"}:
        return None
    if getattr(setting, "is_enum_flag", False):
        return sorted(setting.default_flag)
    if getattr(setting, "is_array", False):
        return [_rounded(value) for value in setting.default_array]
    return _rounded(setting.default)


def _rounded(value: Any) -> Any:
    return round(value, 6) if isinstance(value, float) else value
