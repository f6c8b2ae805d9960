# SPDX-License-Identifier: GPL-3.0-or-later

"""The tab is in the 3D view's sidebar for any active object, and says which one it needs."""

from types import SimpleNamespace

import bodies
import bpy
import pytest


class _Layout:
    """Keeps the texts that a panel draws."""

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.operators: list[tuple[str, SimpleNamespace]] = []

    def column(self, **_: object) -> "_Layout":
        return self

    def label(self, *, text: str, icon: str) -> None:
        del icon
        self.texts.append(text)

    def operator(self, name: str, **_: object) -> SimpleNamespace:
        self.operators.append((name, SimpleNamespace()))
        return self.operators[-1][1]


def shown() -> list[str]:
    """Returns the names of the panels of the tab that are drawn in the 3D view.

    Subpanels are left out, and the welcome, which is always there.
    """
    panels = [one for one in bpy.types.Panel.__subclasses__() if one.is_registered]
    return [
        panel.__name__
        for panel in panels
        if panel.bl_space_type == "VIEW_3D"
        and panel.__name__.startswith("PREFILTER_PT_")
        and not panel.__name__.endswith(("_presets", "_welcome"))
        and (getattr(panel, "bl_context", "") != "objectmode" or bpy.context.mode == "OBJECT")
        and panel.poll(bpy.context)
    ]


def said() -> str:
    """Returns the texts of the placeholder panel."""
    return " ".join(stand_in().texts)


def stand_in() -> _Layout:
    """Returns its texts."""
    layout = _Layout()
    panel = bpy.types.PREFILTER_PT_nothing

    class Drawn:
        draw = panel.draw

    drawn = Drawn()
    drawn.layout = layout
    drawn.draw(bpy.context)
    return layout


def activate(obj: bpy.types.Object | None) -> None:
    if obj is not None and obj.name not in bpy.context.scene.collection.objects:
        bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj


@pytest.mark.parametrize("kind", ["none", "EMPTY", "CAMERA", "LIGHT", "ARMATURE"])
def test_the_tab_exists_without_a_mesh(kind):
    data = {
        "CAMERA": lambda: bpy.data.cameras.new("a"),
        "LIGHT": lambda: bpy.data.lights.new("a", "POINT"),
        "ARMATURE": lambda: bpy.data.armatures.new("a"),
    }
    made = data[kind]() if kind in data else None
    activate(None if kind == "none" else bpy.data.objects.new("a", made))
    assert shown() == ["PREFILTER_PT_nothing"]
    for words in ("Voxelize: a mesh", "Rasterize: a curve", "Surface: a point cloud"):
        assert words in said()


@pytest.mark.parametrize("mode", ["EDIT", "VERTEX_PAINT"])
def test_the_tab_exists_in_other_modes(mode):
    activate(bodies.cube())
    bpy.ops.object.mode_set(mode=mode)
    assert shown() == ["PREFILTER_PT_nothing"]
    assert "Object Mode" in said()
    ((name, made),) = stand_in().operators
    assert (name, made.mode) == ("object.mode_set", "OBJECT")


def test_sculpt_mode_has_its_panels():
    activate(bodies.cube())
    bpy.ops.object.mode_set(mode="SCULPT")
    assert shown() == ["PREFILTER_PT_voxelize_sculpt"]


def test_no_placeholder_beside_another_panel():
    activate(bodies.cube())
    assert "PREFILTER_PT_voxelize_sidebar" in shown()
    assert "PREFILTER_PT_nothing" not in shown()


def test_only_panels_of_the_tab_are_polled(addon):
    """Each redraw asks, so it is a small part of all panels that there are."""
    sidebar = addon("core.sidebar")
    everywhere = bpy.types.Panel.__subclasses__()
    expected = {
        one for one in everywhere if issubclass(one, sidebar.SidebarPanel) and one.is_registered
    }
    found = list(sidebar._panels())
    assert {one.bl_label for one in found} >= {"Voxelize", "Rasterize", "Reconstruct Surface"}
    assert set(found) == expected
    assert len(found) == len(expected)


def test_unregistered_panels_are_ignored(addon):
    sidebar = addon("core.sidebar")

    class Passing(sidebar.SidebarPanel, bpy.types.Panel):
        bl_idname = "PREFILTER_PT_passing"

        def draw(self, context):
            del context

    before = list(sidebar._panels())
    assert Passing not in before
    bpy.utils.register_class(Passing)
    assert Passing in sidebar._panels()
    bpy.utils.unregister_class(Passing)
    assert list(sidebar._panels()) == before
