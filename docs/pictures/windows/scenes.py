# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the scenes of photographs, in a Blender with a window. See photograph.py.

usage: blender --python scenes.py -- panels|windows NAME
"""

import json
import os
import sys
import tempfile
import traceback
from collections.abc import Iterator, Sequence
from pathlib import Path

import bmesh
import bpy
import numpy as np
from mathutils import Euler

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parents[2] / "scripts")]

import demo_scene  # noqa: E402
import drawn  # noqa: E402
from pictures import CROPPED, WHOLE, Photograph  # noqa: E402

READY = "prefilter: ready "
SCALE = 1.5
PROPERTIES_WIDTH = 0.4
"""Share of the largest area in which a panel of the Properties editor is photographed."""


def session(kind: str, name: str) -> Iterator[float]:
    """Makes a photograph's scene, and prints the regions to photograph; yields seconds to wait."""
    shown = (CROPPED if kind == "panels" else WHOLE)[name]
    told = {"version": ".".join(map(str, bpy.app.version[:2]))}
    if bpy.app.version[:2] < shown.since:
        tell(told | {"left_out": True})
        return
    told["drawn"] = drawn.drawn(shown.panels)
    largest_area().type = "VIEW_3D"
    clear()
    dismiss_welcome(unless="PREFILTER_PT_welcome" in shown.panels)
    yield 1.0
    if kind == "panels":
        area = yield from show_panel(shown)
        told["region"] = place_of(area)
    else:
        yield from globals()[f"show_{shown.scene}"](shown)
    yield 2.0
    tell(told)
    yield 3600.0


def tell(told: dict[str, object]) -> None:
    """Prints a line for photograph.py."""
    print(READY + json.dumps(told), flush=True)


def clear() -> None:
    """Removes all objects, materials and images."""
    for kind in (bpy.data.objects, bpy.data.materials, bpy.data.images):
        for one in list(kind):
            kind.remove(one)


def dismiss_welcome(*, unless: bool) -> None:
    """Hides the welcome from photographs of other panels."""
    for addon in bpy.context.preferences.addons:
        if hasattr(addon.preferences, "show_welcome"):
            addon.preferences.show_welcome = unless


def largest_area() -> bpy.types.Area:
    """Returns the largest area of the window."""
    areas = bpy.context.window_manager.windows[0].screen.areas
    return max(areas, key=lambda area: area.width * area.height)


def region_of(area: bpy.types.Area, kind: str) -> bpy.types.Region:
    """Returns the region of a kind."""
    return next(region for region in area.regions if region.type == kind)


def inside(area: bpy.types.Area):
    """Returns a context in an area."""
    window = bpy.context.window_manager.windows[0]
    return bpy.context.temp_override(window=window, area=area, region=region_of(area, "WINDOW"))


def open_tab(*areas: bpy.types.Area) -> Iterator[float]:
    """Shows the tab Prefilter in the sidebars of areas."""
    for area in areas:
        area.spaces.active.show_region_ui = True
    yield 0.5
    for area in areas:
        sidebar = region_of(area, "UI")
        while sidebar.active_panel_category == "UNSUPPORTED":  # Until it is drawn at first.
            yield 0.5
        sidebar.active_panel_category = "Prefilter"
        area.tag_redraw()
    yield 0.5


def rearrange(opened: Sequence[str], only: Sequence[str] = (), first: str = "") -> None:
    """Opens panels; the others of the add-on are closed, or absent.

    Args:
        opened: The names of the panels; those around them open too.
        only: Names of panels that stay, with those below; all if empty.
        first: The panel on top, with the one around it.
    """
    opened = [one for name in opened for one in (name, parent_of(name))]
    first = parent_of(first) or first
    ours = [one for one in drawn.registered_panels() if one.__name__.startswith("PREFILTER_PT_")]
    kept = [one for name in only for one in drawn.family(getattr(bpy.types, name))] or ours
    for panel in reversed(ours):
        bpy.utils.unregister_class(panel)
    for panel in sorted(ours, key=lambda one: hasattr(one, "bl_parent_id")):
        is_alone = panel.__name__ in only and hasattr(panel, "bl_parent_id")
        if is_alone and panel.bl_parent_id.startswith("PREFILTER_"):
            del panel.bl_parent_id
        closed = set() if panel.__name__ in opened else {"DEFAULT_CLOSED"}
        panel.bl_options = set(getattr(panel, "bl_options", ())) - {"DEFAULT_CLOSED"} | closed
        if panel.__name__ == first:
            panel.bl_order = -1
        # Panels of headers are lists of presets, which buttons in other panels open.
        if panel in kept or panel.bl_region_type == "HEADER":
            bpy.utils.register_class(panel)


def parent_of(name: str) -> str:
    """Returns the parent panel of the add-on; empty if there is none."""
    parent = getattr(getattr(bpy.types, name, None), "bl_parent_id", "")
    return parent if parent.startswith("PREFILTER_") else ""


class Unfolded:
    """A layout whose collapsible parts are open."""

    def __init__(self, layout: bpy.types.UILayout) -> None:
        """Takes a panel's layout."""
        object.__setattr__(self, "_layout", layout)

    def panel(self, name: str, **_: object) -> tuple[bpy.types.UILayout, bpy.types.UILayout]:
        """Begins a collapsible part."""
        return self._layout.panel(f"{name}_unfolded", default_closed=False)

    def __getattr__(self, name: str) -> object:
        """Returns an attribute of the layout."""
        return getattr(self._layout, name)

    def __setattr__(self, name: str, value: object) -> None:
        """Sets an attribute of the layout."""
        setattr(self._layout, name, value)


def unfold(panel: type) -> None:
    """Makes a panel draw its collapsible parts open."""
    draw = panel.draw

    class Drawing:
        def __init__(self, drawing: bpy.types.Panel) -> None:
            self._panel, self.layout = drawing, Unfolded(drawing.layout)

        def __getattr__(self, name: str) -> object:
            return getattr(self._panel, name)

    panel.draw = lambda self, context: draw(Drawing(self), context)


# Single panels.


def show_panel(shown: Photograph) -> Iterator[float]:
    """Shows one panel in the largest area, and returns that."""
    (name,) = shown.panels
    panel = getattr(bpy.types, name)
    bpy.context.preferences.view.ui_scale = SCALE
    bpy.context.preferences.system.use_region_overlap = False
    globals()[f"make_{shown.scene}"]()
    area = largest_area()
    if panel.bl_space_type == "PROPERTIES":
        area = split(area)
        keep_panels_around(panel)
    yield 0.5
    area.type = panel.bl_space_type
    if panel.bl_space_type == "IMAGE_EDITOR":
        area.spaces.active.image = bpy.data.images[demo_scene.IMAGE]
    if shown.unfolded:
        unfold(panel)
    # Without an active object, the panel refers to the others, which are not drawn.
    rearrange(shown.opened, only=shown.panels if bpy.context.object else ())
    if panel.bl_space_type == "PROPERTIES":
        yield 0.5
        area.spaces.active.context = panel.bl_context.upper()
    else:
        yield from open_tab(area)
    return area


def split(area: bpy.types.Area) -> bpy.types.Area:
    """Cuts a narrow area off another."""
    before = set(bpy.context.window_manager.windows[0].screen.areas)
    with inside(area):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=PROPERTIES_WIDTH)
    (made,) = set(bpy.context.window_manager.windows[0].screen.areas) - before
    return min((made, area), key=lambda one: one.width)


def keep_panels_around(panel: type) -> None:
    """Removes all panels of the Properties editor except the parents of a panel, which open."""
    around = set()
    parent = getattr(panel, "bl_parent_id", "")
    while parent:
        around.add(parent)
        parent = getattr(getattr(bpy.types, parent), "bl_parent_id", "")
    others = [one for one in drawn.registered_panels() if one.bl_space_type == "PROPERTIES"]
    kept = [one for one in others if one.bl_rna.identifier in around]
    for other in others:
        if not other.__name__.startswith("PREFILTER_PT_"):
            bpy.utils.unregister_class(other)
    for other in kept:
        other.bl_options = set(getattr(other, "bl_options", ())) - {"DEFAULT_CLOSED"}
        bpy.utils.register_class(other)


def place_of(area: bpy.types.Area) -> list[int]:
    """Returns where panels are in a window: left, bottom, width and height, without tabs."""
    if area.type == "PROPERTIES":
        region = region_of(area, "WINDOW")
        return [region.x, region.y, region.width, region.height]
    region = region_of(area, "UI")
    # The tabs are slightly wider than the height of a line of text.
    tabs = round(24 * SCALE)
    return [region.x, region.y, region.width - tabs, region.height]


def make_nothing() -> None:
    """No object."""


def make_mesh() -> None:
    """A painted monkey."""
    obj = demo_scene.add_monkey()
    image = bpy.data.images.new(demo_scene.IMAGE, 1024, 1024)
    demo_scene.add_material(obj, image)


def make_points() -> None:
    """A mesh of vertices alone, with normals."""
    make_mesh()
    mesh = bpy.context.object.data
    while mesh.polygons:
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.delete(type="EDGE_FACE")
        bpy.ops.object.mode_set(mode="OBJECT")


def make_text() -> None:
    """A text."""
    bpy.ops.object.text_add()


def make_cache() -> None:
    """A scene for Cycles, with an image in a file."""
    import tempfile

    make_mesh()
    folder = Path(tempfile.mkdtemp())
    image = bpy.data.images[demo_scene.IMAGE]
    image.filepath_raw, image.file_format = str(folder / "paint.png"), "PNG"
    image.save()
    bpy.context.scene.render.engine = "CYCLES"


# Windows.


def show_image(shown: Photograph) -> Iterator[float]:
    """The demo's texture in the Image editor, with the tab open."""
    obj = demo_scene.add_monkey()
    image = demo_scene.new_image(demo_scene.paint(demo_scene.read_model(obj)))
    demo_scene.add_material(obj, image)
    obj.select_set(True)
    area = largest_area()
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = image
    if shown.opened:
        rearrange(shown.opened)
    yield from open_tab(area)
    with inside(area):
        bpy.ops.image.view_all(fit_view=True)


def show_levels(shown: Photograph) -> Iterator[float]:
    """The Image editor with the preview of a level."""
    yield from show_image(shown)
    settings = bpy.context.window_manager.prefilter_view
    settings.mip_value, settings.use_wipe, settings.wipe = 4.0, True, 0.4
    with inside(largest_area()):
        bpy.ops.prefilter.preview_levels()
        bpy.ops.image.view_all(fit_view=True)


def show_weights(shown: Photograph) -> Iterator[float]:
    """The Image editor with the weights of the image's texels."""
    yield from show_image(shown)
    with inside(largest_area()):
        bpy.ops.prefilter.show_weights()
        bpy.ops.image.view_all(fit_view=True)


def show_voxels(shown: Photograph) -> Iterator[float]:
    """A leaky monkey beside its voxelized copy, with the tab in the sidebar."""
    del shown
    for x in (1.4, -1.4):
        bpy.ops.mesh.primitive_monkey_add(location=(x, 0.0, 0.0))
        monkey = bpy.context.object
        monkey.modifiers.new("Subdivision", "SUBSURF").levels = 3
        bpy.ops.object.modifier_apply(modifier="Subdivision")
        bpy.ops.object.shade_smooth()
        mesh = bmesh.new()
        mesh.from_mesh(monkey.data)
        chosen = np.random.default_rng(1).random(len(mesh.faces)) < 0.02
        holes = [face for face, is_hole in zip(mesh.faces, chosen, strict=True) if is_hole]
        bmesh.ops.delete(mesh, geom=holes, context="FACES")
        mesh.to_mesh(monkey.data)
        mesh.free()
    for other in bpy.data.objects:
        other.select_set(other != monkey)
    bpy.ops.prefilter.voxelize(depth=8)
    bpy.context.view_layer.objects.active = bpy.context.selected_objects[0]
    area = largest_area()
    view = plain_view(area)
    area.spaces.active.shading.light = "MATCAP"
    view.view_rotation = Euler((1.0, 0.0, 0.0)).to_quaternion()
    view.view_location, view.view_distance = (0.6, 0.0, 0.0), 6.5
    view.view_perspective = "ORTHO"
    yield from open_tab(area)


def show_report(shown: Photograph) -> Iterator[float]:
    """A lamp whose thin wires are selected from the report, with the tab in the sidebar."""
    del shown
    bpy.ops.mesh.primitive_cylinder_add(vertices=48, radius=0.35, depth=0.5, location=(0, 0, -1.3))
    base = bpy.context.object
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=7)
    guard = bpy.context.object
    guard.name = "Lamp"
    wires = guard.modifiers.new("Wires", "WIREFRAME")
    wires.thickness = 0.05
    bpy.ops.object.modifier_apply(modifier="Wires")
    base.select_set(True)
    bpy.ops.object.join()
    bpy.ops.prefilter.voxelize(depth=6)
    area = largest_area()
    view = plain_view(area)
    view.view_rotation = Euler((1.2, 0.0, 0.4)).to_quaternion()
    view.view_location, view.view_distance = (0.5, 0.0, -0.25), 4.8
    view.view_perspective = "ORTHO"
    overlay = area.spaces.active.overlay
    overlay.show_overlays, overlay.show_floor = True, False
    overlay.show_axis_x = overlay.show_axis_y = overlay.show_cursor = False
    overlay.show_object_origins = False
    yield from open_tab(area)
    with bpy.context.temp_override(area=area, region=area.regions[-1]):
        bpy.ops.prefilter.select_found(index=0)


def show_shapes(shown: Photograph) -> Iterator[float]:
    """A text and a ring with the tab in the sidebar, and their image beside it."""
    del shown
    bpy.ops.curve.primitive_nurbs_circle_add(radius=1.5)
    ring = bpy.context.object
    ring.data.dimensions, ring.data.fill_mode = "2D", "BOTH"
    bpy.ops.curve.primitive_nurbs_circle_add(radius=1.3)
    hole = bpy.context.object
    hole.select_set(True)
    ring.select_set(True)
    bpy.context.view_layer.objects.active = ring
    bpy.ops.object.join()
    bpy.ops.object.text_add(location=(0.0, -0.3, 0.01))
    text = bpy.context.object
    text.data.body, text.data.align_x, text.data.size = "Curves", "CENTER", 0.75
    for obj, color in ((ring, (0.9, 0.35, 0.1)), (text, (0.05, 0.25, 0.6))):
        material = bpy.data.materials.new(obj.name)
        material.diffuse_color = (*color, 1.0)
        if material.node_tree is not None:
            material.node_tree.nodes.clear()
        obj.data.materials.append(material)
        obj.select_set(True)
    area = largest_area()
    before = set(bpy.context.window_manager.windows[0].screen.areas)
    with inside(area):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.55)
    bpy.ops.prefilter.rasterize(width=180, height=180, filter="mitchell")
    (other,) = set(bpy.context.window_manager.windows[0].screen.areas) - before
    bpy.context.preferences.system.use_region_overlap = False
    rearrange(
        ("PREFILTER_PT_rasterize", "PREFILTER_PT_drawn"),
        only=("PREFILTER_PT_rasterize", "PREFILTER_PT_drawn", "PREFILTER_PT_shapes"),
    )
    view = plain_view(area)
    view.view_rotation = (1.0, 0.0, 0.0, 0.0)
    view.view_location, view.view_distance = (0.1, 0.0, 0.0), 7.5
    view.view_perspective = "ORTHO"
    other.type = "IMAGE_EDITOR"
    other.spaces.active.image = bpy.data.images[text.name]
    yield from open_tab(area, other)


def show_plane(shown: Photograph) -> Iterator[float]:
    """A picture on the preview plane, with its panel in the sidebar."""
    import prefilter
    import resize

    encoded = prefilter.to_srgb(resize.drawn().clip(0, 1))
    pixels = np.ones((*encoded.shape[:2], 4), np.float32)
    pixels[..., :3] = encoded
    image = bpy.data.images.new("Picture", *pixels.shape[1::-1])
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    bpy.context.preferences.system.use_region_overlap = False
    area = largest_area()
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = image
    rearrange(shown.opened, first=shown.panels[0])
    yield from open_tab(area)
    with inside(area):
        bpy.ops.prefilter.preview_plane()
    settings = bpy.context.window_manager.prefilter_plane
    settings.tilt, settings.rotation, settings.tiles = 1.2, 0.2, 3.0
    area.tag_redraw()


def show_model(shown: Photograph) -> Iterator[float]:
    """The demo's monkey with the images of a PBR material, and their list."""
    obj = demo_scene.add_monkey()
    albedo = demo_scene.new_image(demo_scene.paint(demo_scene.read_model(obj)))
    demo_scene.add_material(obj, albedo)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    tree = obj.active_material.node_tree
    shader = tree.nodes.new("ShaderNodeBsdfPrincipled")
    texture = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
    tree.links.new(texture.outputs["Color"], shader.inputs["Base Color"])
    apart = tree.nodes.new("ShaderNodeSeparateColor")
    bumps = tree.nodes.new("ShaderNodeNormalMap")
    for name, socket in (("Monkey ORM", apart.inputs[0]), ("Monkey Normal", bumps.inputs["Color"])):
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = bpy.data.images.new(name, *albedo.size, is_data=True)
        tree.links.new(node.outputs["Color"], socket)
    tree.links.new(apart.outputs["Green"], shader.inputs["Roughness"])
    tree.links.new(apart.outputs["Blue"], shader.inputs["Metallic"])
    tree.links.new(bumps.outputs[0], shader.inputs["Normal"])
    glow = tree.nodes.new("ShaderNodeTexImage")
    glow.image = bpy.data.images.new("Monkey Emission", *albedo.size)
    tree.links.new(glow.outputs["Color"], shader.inputs["Emission Color"])
    bpy.context.preferences.system.use_region_overlap = False
    area = largest_area()
    view = plain_view(area)
    area.spaces.active.shading.color_type = "TEXTURE"
    tree.nodes.active = texture
    view.view_rotation = Euler((1.3, 0.0, 0.4)).to_quaternion()
    view.view_location, view.view_distance = (0.0, 0.0, 0.0), 3.5
    rearrange(shown.opened, only=shown.panels)
    bpy.context.scene.prefilter_model.folder = "/textures/"
    yield from open_tab(area)


def show_gltf(shown: Photograph) -> Iterator[float]:
    """The dialog of Blender's own glTF export, with the part of the add-on in it open."""
    obj = demo_scene.add_monkey()
    albedo = demo_scene.new_image(demo_scene.paint(demo_scene.read_model(obj)))
    demo_scene.add_material(obj, albedo)
    package = sys.modules["bl_ext.user_default.prefilter"]
    draw = package.draw_export
    package.draw_export = lambda context, layout: draw(context, Unfolded(layout))
    settings = bpy.context.scene.prefilter_gltf
    settings.use_mipmaps, settings.texture_format = True, "etc1s"
    bpy.context.preferences.view.filebrowser_display_type = "SCREEN"
    folder = Path(tempfile.gettempdir()) / "models"
    folder.mkdir(exist_ok=True)
    with inside(largest_area()):
        bpy.ops.export_scene.gltf("INVOKE_DEFAULT", filepath=str(folder / "monkey.glb"))
    yield 2.0
    for area in bpy.context.window_manager.windows[0].screen.areas:
        if area.type == "FILE_BROWSER":  # Folders of the machine are nobody's business.
            area.spaces.active.show_region_toolbar = False
    yield 1.0


def show_on_model(shown: Photograph) -> Iterator[float]:
    """The demo's monkey with levels as from a distance, Box on the left of the line."""
    obj = demo_scene.add_monkey()
    demo_scene.add_material(obj, demo_scene.new_image(demo_scene.paint(demo_scene.read_model(obj))))
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    bpy.context.preferences.system.use_region_overlap = False
    area = largest_area()
    view = plain_view(area)
    view.view_rotation = Euler((1.3, 0.0, 0.4)).to_quaternion()
    view.view_location, view.view_distance = (0.0, 0.0, 0.0), 3.5
    rearrange(shown.opened, only=shown.panels)
    settings = bpy.context.window_manager.prefilter_view
    settings.distance, settings.use_wipe, settings.wipe = 16.0, True, 0.5
    with inside(area):
        bpy.ops.prefilter.preview_on_model()
    yield from open_tab(area)


def show_demonstration(shown: Photograph) -> Iterator[float]:
    """The welcome, after its first button was pressed."""
    area = largest_area()
    rearrange(shown.opened, only=(*shown.panels, "PREFILTER_PT_model"))
    yield from open_tab(area)
    with inside(area):
        bpy.ops.prefilter.demonstrate(kind="mipmaps")
    while "Stone Prefilter.mip04" not in bpy.data.images:
        yield 0.5
    area.spaces.active.overlay.show_overlays = False


def plain_view(area: bpy.types.Area) -> bpy.types.RegionView3D:
    """Shows objects alone in a 3D view, and returns its view."""
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    return space.region_3d


def play(steps: Iterator[float]) -> None:
    """Runs a session; Blender draws while it waits."""

    def step() -> float | None:
        try:
            return next(steps)
        except StopIteration:
            os._exit(0)
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
            os._exit(1)

    bpy.context.preferences.view.show_splash = False
    bpy.app.timers.register(step, first_interval=1.0)


if __name__ == "__main__":
    play(session(*sys.argv[sys.argv.index("--") + 1 :]))
