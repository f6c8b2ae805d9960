# SPDX-License-Identifier: GPL-3.0-or-later

"""Takes a picture of the Prefilter tab in a Blender window that nobody sees.

usage: python3 panel.py TARGET.png        (outside of Blender: starts Xvfb and Blender)

TARGET is named after what it shows: panel.png (the bake), preview.png (a level, with the wipe),
weights.png (the weights of texels, with their legend), voxelize.png (a mesh with a hole, and
voxelized, beside the settings), rasterize.png (a text and a curve, and their image), plane.png
(the preview plane) or model.png (a model, and the images that it shows).
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

WIDTH, HEIGHT = 1280, 720
READY = "prefilter: the window is ready"


def main(target: Path) -> None:
    """Runs Blender on this file, and saves what its window shows."""
    with tempfile.TemporaryDirectory() as folder:
        reading, writing = os.pipe()
        screen = ["-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-fbdir", folder]
        server = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writing), "-nolisten", "tcp", *screen], pass_fds=[writing]
        )
        os.close(writing)
        with os.fdopen(reading) as answer:
            display = f":{answer.readline().strip()}"
        blender = subprocess.Popen(
            [
                "blender",
                "--window-geometry",
                *("0", "0", str(WIDTH), str(HEIGHT)),
                *("--python", __file__, "--", target.stem),
            ],
            env={**os.environ, "DISPLAY": display},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        try:
            if not any(READY in line for line in blender.stdout):
                raise SystemExit("Blender ended before its window was ready")
            time.sleep(2.0)
            pixels = framebuffer(Path(folder) / "Xvfb_screen0")
        finally:
            blender.kill()
            server.terminate()
            blender.wait()
            server.wait()
    if not oiio.ImageBuf(np.ascontiguousarray(pixels)).write(str(target)):
        raise SystemExit(f"cannot write {target}")


def framebuffer(path: Path) -> np.ndarray:
    """The screen as (height, width, 3) bytes, from X's window dump format (XWDFile.h)."""
    dump = path.read_bytes()
    header = np.frombuffer(dump, ">u4", 25)
    size, width, height, bytes_per_line, colours = header[[0, 4, 5, 12, 19]]
    start = size + 12 * colours
    rows = np.frombuffer(dump, np.uint8, height * bytes_per_line, start)
    pixels = rows.reshape(height, -1)[:, : 4 * width].reshape(height, width, 4)
    return pixels[..., 2::-1]


def show_panel() -> None:
    """Inside Blender: the demo's texture in the Image editor, with the tab open."""
    import bpy

    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
    import demo_scene

    bpy.context.preferences.view.show_splash = False
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    obj = demo_scene.add_monkey()
    image = demo_scene.new_image(demo_scene.paint(demo_scene.read_model(obj)))
    demo_scene.add_material(obj, image)
    obj.select_set(True)

    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = image
    area.spaces.active.show_region_ui = True
    shown = sys.argv[-1]
    if shown == "weights":
        open_panel(bpy.types.PREFILTER_PT_texel_use)

    def show_level() -> None:
        settings = bpy.context.window_manager.prefilter_view
        settings.mip_value, settings.use_wipe, settings.wipe = 4.0, True, 0.4
        bpy.ops.prefilter.preview_levels()

    def open_tab() -> float | None:
        sidebar = next(region for region in area.regions if region.type == "UI")
        if sidebar.active_panel_category == "UNSUPPORTED":  # Until it is drawn for the first time.
            return 0.5
        sidebar.active_panel_category = "Prefilter"
        region = next(region for region in area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(window=window, area=area, region=region):
            if shown == "preview":
                show_level()
            elif shown == "weights":
                bpy.ops.prefilter.show_weights()
            bpy.ops.image.view_all(fit_view=True)
        area.tag_redraw()
        bpy.app.timers.register(lambda: print(READY, flush=True), first_interval=3.0)
        return None

    bpy.app.timers.register(open_tab, first_interval=2.0)


def open_panel(panel: type) -> None:
    """Inside Blender: has a panel start open, and the others make room."""
    import bpy

    names = ("bake", "preview", "error", "texel_use")
    for other in [getattr(bpy.types, f"PREFILTER_PT_{name}") for name in names]:
        bpy.utils.unregister_class(other)
        other.bl_options = set() if other == panel else {"DEFAULT_CLOSED"}
        bpy.utils.register_class(other)


def show_voxels() -> None:
    """Inside Blender: a leaky monkey beside its voxelized copy, with the tab in the sidebar."""
    import bmesh
    import bpy
    from mathutils import Euler

    bpy.context.preferences.view.show_splash = False
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
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
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    space.shading.light = "MATCAP"
    space.show_region_ui = True
    view = space.region_3d
    view.view_rotation = Euler((1.0, 0.0, 0.0)).to_quaternion()
    view.view_location, view.view_distance = (0.6, 0.0, 0.0), 6.5
    view.view_perspective = "ORTHO"

    def open_tab() -> float | None:
        sidebar = next(region for region in area.regions if region.type == "UI")
        if sidebar.active_panel_category == "UNSUPPORTED":  # Until it is drawn for the first time.
            return 0.5
        sidebar.active_panel_category = "Prefilter"
        area.tag_redraw()
        bpy.app.timers.register(lambda: print(READY, flush=True), first_interval=3.0)
        return None

    bpy.app.timers.register(open_tab, first_interval=2.0)


def close_panels(*names: str) -> None:
    """Inside Blender: has panels start closed."""
    import bpy

    for panel in [getattr(bpy.types, name) for name in names]:
        bpy.utils.unregister_class(panel)
        panel.bl_options = {"DEFAULT_CLOSED"}
        bpy.utils.register_class(panel)


def show_shapes() -> None:
    """Inside Blender: a text and a ring with the tab in the sidebar, and their image beside it."""
    import bpy

    bpy.context.preferences.view.show_splash = False
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
    bpy.ops.curve.primitive_nurbs_circle_add(radius=1.5)
    ring = bpy.context.object
    ring.data.dimensions, ring.data.fill_mode = "2D", "BOTH"
    bpy.ops.curve.primitive_nurbs_circle_add(radius=1.3)
    inner = bpy.context.object
    inner.select_set(True)
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
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    before = set(window.screen.areas)
    region = next(region for region in area.regions if region.type == "WINDOW")
    with bpy.context.temp_override(window=window, area=area, region=region):
        bpy.ops.screen.area_split(direction="VERTICAL", factor=0.55)
    bpy.ops.prefilter.rasterize(width=180, height=180, filter="mitchell")
    (other,) = set(window.screen.areas) - before
    bpy.context.preferences.system.use_region_overlap = False
    close_panels("PREFILTER_PT_bake", "PREFILTER_PT_preview")
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    space.show_region_ui = True
    view = space.region_3d
    view.view_rotation = (1.0, 0.0, 0.0, 0.0)
    view.view_location, view.view_distance = (0.1, 0.0, 0.0), 7.5
    view.view_perspective = "ORTHO"
    other.type = "IMAGE_EDITOR"
    other.spaces.active.image = bpy.data.images[text.name]
    other.spaces.active.show_region_ui = True

    def open_tab() -> float | None:
        for one in (area, other):
            sidebar = next(region for region in one.regions if region.type == "UI")
            # Until it is drawn for the first time.
            if sidebar.active_panel_category == "UNSUPPORTED":
                return 0.5
            sidebar.active_panel_category = "Prefilter"
            one.tag_redraw()
        bpy.app.timers.register(lambda: print(READY, flush=True), first_interval=3.0)
        return None

    bpy.app.timers.register(open_tab, first_interval=2.0)


def show_plane() -> None:
    """Inside Blender: a picture on the preview plane, with its panel in the sidebar."""
    import bpy

    sys.path.insert(0, str(Path(__file__).resolve().parent))
    import prefilter
    import resize

    bpy.context.preferences.view.show_splash = False
    encoded = prefilter.to_srgb(resize.drawn().clip(0, 1))
    pixels = np.ones((*encoded.shape[:2], 4), np.float32)
    pixels[..., :3] = encoded
    image = bpy.data.images.new("Picture", *pixels.shape[1::-1])
    image.pixels.foreach_set(pixels.ravel())
    image.pack()
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    bpy.context.preferences.system.use_region_overlap = False
    area.type = "IMAGE_EDITOR"
    area.spaces.active.image = image
    area.spaces.active.show_region_ui = True
    close_panels("PREFILTER_PT_bake", "PREFILTER_PT_preview")
    panel = bpy.types.PREFILTER_PT_plane
    bpy.utils.unregister_class(panel)
    panel.bl_options, panel.bl_order = set(), -1
    bpy.utils.register_class(panel)

    def open_tab() -> float | None:
        sidebar = next(region for region in area.regions if region.type == "UI")
        if sidebar.active_panel_category == "UNSUPPORTED":  # Until it is drawn for the first time.
            return 0.5
        sidebar.active_panel_category = "Prefilter"
        region = next(region for region in area.regions if region.type == "WINDOW")
        with bpy.context.temp_override(window=window, area=area, region=region):
            bpy.ops.prefilter.preview_plane()
        settings = bpy.context.window_manager.prefilter_plane
        settings.tilt, settings.rotation, settings.tiles = 1.2, 0.2, 3.0
        area.tag_redraw()
        bpy.app.timers.register(lambda: print(READY, flush=True), first_interval=3.0)
        return None

    bpy.app.timers.register(open_tab, first_interval=2.0)


def show_model() -> None:
    """Inside Blender: the demo's monkey with the images of a PBR material, and their list."""
    import bpy
    from mathutils import Euler

    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
    import demo_scene

    bpy.context.preferences.view.show_splash = False
    for obj in list(bpy.data.objects):
        bpy.data.objects.remove(obj)
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
    window = bpy.context.window_manager.windows[0]
    area = max(window.screen.areas, key=lambda area: area.width * area.height)
    bpy.context.preferences.system.use_region_overlap = False
    space = area.spaces.active
    space.overlay.show_overlays = space.show_gizmo = False
    space.show_region_ui = True
    space.shading.color_type = "TEXTURE"
    tree.nodes.active = texture
    view = space.region_3d
    view.view_rotation = Euler((1.3, 0.0, 0.4)).to_quaternion()
    view.view_location, view.view_distance = (0.0, 0.0, 0.0), 3.5
    panel = bpy.types.PREFILTER_PT_model
    bpy.utils.unregister_class(panel)
    panel.bl_options = set()
    bpy.utils.register_class(panel)
    bpy.context.scene.prefilter_model.folder = "/textures/"

    def open_tab() -> float | None:
        sidebar = next(region for region in area.regions if region.type == "UI")
        if sidebar.active_panel_category == "UNSUPPORTED":  # Until it is drawn for the first time.
            return 0.5
        sidebar.active_panel_category = "Prefilter"
        area.tag_redraw()
        bpy.app.timers.register(lambda: print(READY, flush=True), first_interval=3.0)
        return None

    bpy.app.timers.register(open_tab, first_interval=2.0)


if "bpy" in sys.modules:
    if sys.argv[-1] == "plane":
        show_plane()
    elif sys.argv[-1] == "model":
        show_model()
    elif sys.argv[-1] == "voxelize":
        show_voxels()
    elif sys.argv[-1] == "rasterize":
        show_shapes()
    else:
        show_panel()
else:
    main(Path(sys.argv[1]))
