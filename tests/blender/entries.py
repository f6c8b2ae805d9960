# SPDX-License-Identifier: GPL-3.0-or-later

"""Every menu entry, panel and file handler that the add-on has registered, found by asking Blender.

CASES has the scene that each operator of a menu needs: a new operator in a menu needs a case.
"""

import gzip
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import bodies
import bpy
import clouds
import numpy as np
import outlines
import scan_files
import scenes

ADDON = "bl_ext.user_default.prefilter"
TRIANGLE = '<svg viewBox="0 0 4 4"><path d="M0 0h4L0 4z"/></svg>'
HAS_CACHE = "use_texture_cache" in bpy.types.RenderSettings.bl_rna.properties


@dataclass
class Call:
    """An operator that a menu offers, with the properties that the menu gives to it.

    Attributes:
        menu: The name of the menu, or of another class that draws the operator.
        operator: Its identifier.
        properties: By name.
        draw: The function that draws it there.
        index: Which of the operators it is that the function draws.
    """

    menu: str
    operator: str
    properties: dict[str, Any] = field(default_factory=dict)
    draw: Callable[[Any, Any], None] | None = None
    index: int = 0

    def properties_now(self) -> dict[str, Any]:
        """Returns the properties that the menu gives to it in the context of now."""
        if self.menu.startswith("UI_"):
            return self.properties  # of the button that was under the mouse
        stand_in = Shown(getattr(bpy.types, self.menu))
        self.draw(stand_in, bpy.context)
        found = stand_in.layout.calls[self.index]
        assert found.operator == self.operator, (found, self)
        return found.properties


class Recorder:
    """Stands for a layout, and records the operators and the menus that are put into it."""

    def __init__(self, name: str = "") -> None:
        """Takes the name of the menu."""
        self.name, self.calls, self.menus = name, [], set()

    def operator(self, name: str, **_: Any) -> Any:
        """Records an operator; returns the object on which the menu sets its properties."""
        self.calls.append(Call(self.name, name))
        return _Properties(self.calls[-1].properties)

    def menu(self, name: str, **_: Any) -> None:
        """Records a menu in the menu."""
        self.menus.add(name)

    def panel(self, name: str, **_: Any) -> tuple["Recorder", "Recorder"]:
        """Opens a part of a panel."""
        return self, self

    def __getattr__(self, name: str) -> Any:
        """Takes whatever else is put into a layout."""
        return lambda *_, **__: self


class _Properties:
    def __init__(self, values: dict[str, Any]) -> None:
        object.__setattr__(self, "_values", values)

    def __setattr__(self, name: str, value: Any) -> None:
        self._values[name] = value


class Shown:
    """Stands for a panel, a menu or a header while it draws into a recorder."""

    def __init__(self, owner: type) -> None:
        """Takes the class."""
        self._owner, self.layout = owner, Recorder(owner.__name__)

    def __getattr__(self, name: str) -> Any:
        """Returns an attribute of the class."""
        value = getattr(self._owner, name)
        return value.__get__(self) if hasattr(value, "__get__") else value


def is_own(thing: Any) -> bool:
    """Tells whether a class or a function is the add-on's."""
    return thing.__module__.startswith(ADDON)


def subclasses(kind: type) -> Iterator[type]:
    """Yields the registered classes of a kind."""
    for name in dir(bpy.types):
        found = getattr(bpy.types, name)
        if isinstance(found, type) and issubclass(found, kind) and found is not kind:
            yield found


def appended() -> list[tuple[str, Callable[[Any, Any], None]]]:
    """Returns the add-on's entries in Blender's menus, headers and panels, and in its own menus.

    Each comes with the name of the class in which it is drawn.
    """
    found = []
    for kind in (bpy.types.Menu, bpy.types.Header, bpy.types.Panel):
        for owner in subclasses(kind):
            draws = getattr(getattr(owner, "draw", None), "_draw_funcs", [])
            found += [(owner.__name__, draw) for draw in draws if is_own(draw)]
            if is_own(owner) and not draws and kind is not bpy.types.Panel:
                found.append((owner.__name__, owner.draw))
    return found


def panels() -> list[type]:
    """Returns the add-on's panels, parents before their subpanels."""
    return sorted((one for one in bpy.types.Panel.__subclasses__() if _is_shown(one)), key=depth_of)


def handlers() -> list[type]:
    """Returns the add-on's file handlers."""
    return [one for one in bpy.types.FileHandler.__subclasses__() if _is_shown(one)]


def _is_shown(owner: type) -> bool:
    return is_own(owner) and owner.is_registered


def ancestors(panel: type) -> Iterator[type]:
    """Yields the panels that a panel is in, of whomever, the nearest first."""
    while name := getattr(panel, "bl_parent_id", ""):
        panel = getattr(bpy.types, name)
        yield panel


def depth_of(panel: type) -> int:
    """Returns how many panels a panel is in."""
    return len(list(ancestors(panel)))


def editor_of(menu: str) -> str:
    """Returns the editor that a menu is in."""
    own = {"PREFILTER_MT_object": "VIEW_3D", "PREFILTER_MT_image": "IMAGE_EDITOR"}
    others = {
        **{"VIEW3D": "VIEW_3D", "IMAGE": "IMAGE_EDITOR", "MATERIAL": "PROPERTIES"},
        **{"TOPBAR": "VIEW_3D", "UI": "VIEW_3D"},
    }
    return own.get(menu) or others[menu.partition("_")[0]]


@contextmanager
def editor(area: bpy.types.Area, kind: str, shown: bpy.types.Image | None) -> Iterator[None]:
    """Makes an area an editor of a kind, which shows an image if it can, and is the context."""
    area.type = kind
    more = {}
    if kind == "IMAGE_EDITOR" and shown is not None:
        area.spaces.active.image = shown
    if kind == "PROPERTIES" and bpy.context.view_layer.objects.active is not None:
        more["material"] = bpy.context.view_layer.objects.active.active_material
    region = next(one for one in area.regions if one.type == "WINDOW")
    window = bpy.context.window_manager.windows[0]
    with bpy.context.temp_override(window=window, area=area, region=region, **more):
        yield


def calls(area: bpy.types.Area) -> tuple[list[Call], set[str]]:
    """Returns the operators that the menus offer, and the menus that draw nothing.

    The scene becomes one in which all have something to offer.
    """
    found: list[Call] = []
    silent, menus = set(), set()
    shown = drawn()
    scenes.textured_quad(shown)
    for name, draw in appended():
        more = {}
        if name.startswith("UI_"):
            # The button under the mouse is one of the add-on's.
            manager = bpy.context.window_manager
            more["button_operator"] = manager.operator_properties_last("prefilter.boolean")
        stand_in = Shown(getattr(bpy.types, name))
        with editor(area, editor_of(name), shown), bpy.context.temp_override(**more):
            draw(stand_in, bpy.context)
        for index, call in enumerate(stand_in.layout.calls):
            call.draw, call.index = draw, index
            found.append(call)
        menus |= stand_in.layout.menus
        if not stand_in.layout.calls and not stand_in.layout.menus:
            silent.add(f"{name}: {draw.__module__}.{draw.__qualname__}")
    # Menus of the add-on's own draw nothing by themselves; they count as reached by their entries.
    silent -= {f"{name}: {ADDON}.core.menus.{name}.draw" for name in menus}
    return found, silent


@dataclass(frozen=True)
class Case:
    """The scene that an operator of a menu needs, and the file and the key that it waits for."""

    scene: Callable[[], bpy.types.Image | None]
    file: str = ""
    key: str = ""


def clear() -> None:
    """Removes all objects, images and texts."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    for blocks in (bpy.data.objects, bpy.data.images, bpy.data.texts, bpy.data.meshes):
        for block in list(blocks):
            blocks.remove(block)


def textured() -> bpy.types.Image:
    """Makes a cube with an image."""
    image = scenes.image("Paint", scenes.noise(16, 16))
    scenes.cube(image).select_set(True)
    return image


def saved() -> bpy.types.Image:
    """Makes the same in a file that is saved, beside which other files are written."""
    image = textured()
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(bpy.app.tempdir) / "scene.blend"))
    return image


def cached() -> bpy.types.Image:
    """Makes the same for Cycles' texture cache, with the image in a file."""
    path = Path(bpy.app.tempdir) / "paint.png"
    saved().save(filepath=str(path))
    clear()
    image = bpy.data.images.load(str(path))
    scenes.cube(image).select_set(True)
    bpy.context.scene.render.engine = "CYCLES"
    if HAS_CACHE:
        bpy.context.scene.render.use_texture_cache = True
    return image


def previewed() -> bpy.types.Image:
    """Makes a cube with an image whose levels are shown, in editors and on the model."""
    image = textured()
    bpy.ops.prefilter.preview_levels(image="Paint")
    bpy.ops.prefilter.preview_on_model(image="Paint")
    return image


def on_plane() -> bpy.types.Image:
    """Makes an image that is shown on a plane."""
    image = textured()
    bpy.ops.prefilter.preview_plane(image="Paint", filter="box")
    return image


def with_levels() -> bpy.types.Image:
    """Makes an image that has levels."""
    image = textured()
    bpy.ops.prefilter.bake_mipmaps(image="Paint")
    return image


def weighed() -> bpy.types.Image:
    """Makes the picture of an image's weights."""
    textured()
    bpy.ops.prefilter.show_weights(image="Paint")
    return bpy.data.images["Paint.weights"]


def outlined() -> None:
    """Makes a curve."""
    outlines.square()


def drawn() -> bpy.types.Image:
    """Makes a curve, and an image of it."""
    outlines.square()
    bpy.ops.prefilter.rasterize(source="curves", side=32)
    return next(image for image in bpy.data.images if image.prefilter_drawn.source == "curves")


def two_bodies() -> None:
    """Makes two cubes that overlap."""
    bodies.cube("Tool", location=(1, 0, 0))
    bodies.cube("Base").select_set(True)
    bpy.data.objects["Tool"].select_set(True)


def voxelized() -> None:
    """Makes the solid of a cube that is open."""
    bodies.without_faces(bodies.cube(), 1)
    bpy.ops.prefilter.voxelize(depth=4)


def sculpted() -> None:
    """Makes a cube in Sculpt Mode."""
    bodies.cube()
    bpy.ops.object.mode_set(mode="SCULPT")


def scanned() -> None:
    """Makes points of a torus."""
    clouds.scan(*clouds.torus(5_000))


def scanned_with_box() -> None:
    """Makes points, and a box that has some of them, which is active."""
    scan = clouds.scan(*clouds.torus(5_000))
    bodies.cube(location=(1, 0, 0))
    scan.select_set(True)


def scanned_twice() -> None:
    """Makes two scans of the same, one of them moved a little."""
    points = clouds.torus(5_000)[0] * (1, 1.3, 1)
    other = clouds.scan(points, name="Other", location=(0.03, 0.0, 0.02))
    clouds.scan(clouds.torus(5_000, 2)[0] * (1, 1.3, 1), name="Active")
    other.select_set(True)


def scanned_in_color() -> None:
    """Makes points with colors, and a mesh there, which is active."""
    points, normals = clouds.torus(5_000)
    colors = np.column_stack([normals * 0.5 + 0.5, np.ones(len(points))])
    scan = clouds.scan(points, attributes={"Col": ("FLOAT_COLOR", colors)}, name="Scan")
    bodies.cube()
    scan.select_set(True)


def reconstructed() -> None:
    """Makes a surface of points."""
    scanned()
    bpy.ops.prefilter.reconstruct(depth=5)


def empty() -> None:
    """Makes nothing."""


CASES = {
    "bake_mipmaps": Case(textured),
    "bake_model": Case(saved),
    "bake_texture_cache": Case(cached),
    "preview_levels": Case(textured),
    "end_preview": Case(previewed),
    "remove_levels": Case(with_levels),
    "plot_error": Case(textured),
    "show_weights": Case(textured),
    "show_source": Case(weighed),
    "fill_unused": Case(textured),
    "preview_on_model": Case(textured),
    "end_model_preview": Case(previewed),
    "export_mipmaps": Case(textured, file="paint.dds"),
    "export_model": Case(textured, file="/"),
    "resample_image": Case(textured),
    "resize_image": Case(textured),
    "drag_corners": Case(textured, key="RET"),
    "preview_plane": Case(textured),
    "end_plane": Case(on_plane),
    "sampling_table": Case(textured),
    "rasterize": Case(outlined),
    "rasterize_svg": Case(empty, file="triangle.svg"),
    "use_as_decal": Case(drawn),
    "update_drawn": Case(drawn),
    "voxelize": Case(bodies.cube),
    "boolean": Case(two_bodies),
    "update_voxels": Case(voxelized),
    "switch_source": Case(voxelized),
    "forget_source": Case(voxelized),
    "import_points": Case(empty, file="torus.xyz"),
    "reconstruct": Case(scanned),
    "trim_reconstruction": Case(reconstructed),
    "paint_texture": Case(scanned_in_color),
    "align_scans": Case(scanned_twice),
    "crop_points": Case(scanned_with_box),
    "remove_outliers": Case(scanned),
    "subsample_points": Case(scanned),
    "assign_shortcut": Case(empty, key="K"),
    "remove_shortcut": Case(empty),
}
"""The menu entries, by operator."""

PANEL_SCENES = (
    *(empty, textured, cached, previewed, outlined, drawn, voxelized, sculpted, scanned),
    reconstructed,
)
"""Each panel has content in at least one of these."""


def case_of(call: Call) -> Case:
    """Returns the case of a menu entry."""
    found = CASES[call.operator.removeprefix("prefilter.")]
    if call.properties.get("source") == "uv":
        return Case(textured)
    if call.menu == "VIEW3D_MT_sculpt":
        return Case(sculpted)
    return found


def write_file(path: Path) -> Path:
    """Writes a file of the kind that its name says."""
    if path.suffix in {".svg", ".svgz"}:
        data = TRIANGLE.encode()
        path.write_bytes(gzip.compress(data) if path.suffix == ".svgz" else data)
        return path
    return scan_files.write(path)


def write_dropped(folder: Path, extension: str) -> Path:
    """Writes a file with an extension that a file handler names, which is the last of its name."""
    return write_file(folder / ("dropped.ply.gz" if extension == ".gz" else f"dropped{extension}"))


def as_dropped(operator: Any, path: Path) -> dict[str, Any]:
    """Returns the properties that Blender gives to a file handler's operator for a file."""
    values = {
        "filepath": str(path),
        "directory": f"{path.parent}/",
        "files": [{"name": path.name}],
    }
    declared = operator.get_rna_type().properties
    return {name: value for name, value in values.items() if name in declared}


def operator_of(name: str) -> Any:
    """Returns an operator by its identifier, such as "prefilter.voxelize"."""
    module, _, function = name.partition(".")
    return getattr(getattr(bpy.ops, module), function)
