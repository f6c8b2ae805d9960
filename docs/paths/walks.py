# SPDX-License-Identifier: GPL-3.0-or-later

"""Walks a path by mouse and keys, in a Blender with a window. See drive.py.

usage: blender --enable-event-simulate --python walks.py -- NAME FOLDER
"""

import json
import sys
import time
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import bpy
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tests" / "blender"), str(Path(__file__).parent)]

import bodies  # noqa: E402
import page  # noqa: E402
import scenes  # noqa: E402
import window  # noqa: E402
from window import PACKAGE, Stage, begun, clicked, idle, largest, moved, region, until  # noqa: E402

NAME, FOLDER = sys.argv[sys.argv.index("--") + 1], Path(sys.argv[sys.argv.index("--") + 2])
TICK = 0.01
_CORNERS = ("lower_left", "lower_right", "upper_right", "upper_left")


class Hand:
    """Presses and counts keys and buttons; `words` describe each step on the page.

    Positions of buttons are found with the mouse before the counting starts.
    """

    def __init__(self, stage: Stage) -> None:
        """Takes the editor to work in."""
        self.stage = stage
        self.clicks = self.keys = self.drags = 0
        self.wait = self.gap = self.own = 0.0
        self.steps: list[str] = []
        self._tab_place = (0, 0)
        self._last = 0.0
        self._watches = False
        bpy.app.timers.register(self._tick, persistent=True)

    def learn(self) -> Iterator[None]:
        """Finds the position of the tab, and closes the sidebar again."""
        space = self.stage.area.spaces.active
        space.show_region_ui = True
        yield from until(lambda: self.stage.tab != "UNSUPPORTED")
        yield from self.stage.redrawn()
        sidebar = region(self.stage.area, "UI")
        first = sidebar.active_panel_category
        x = sidebar.x + sidebar.width - 10
        for below_top in range(20, sidebar.height, 10):
            y = sidebar.y + sidebar.height - below_top
            yield from clicked(self.stage.window, x, y)
            if self.stage.tab == "Prefilter":
                self._tab_place = (x, y - 8)
                break
        assert self.stage.tab == "Prefilter"
        sidebar.active_panel_category = first
        space.show_region_ui = False
        yield from self.stage.redrawn()

    def middle(self) -> tuple[int, int]:
        """Returns the middle of the editor."""
        view = region(self.stage.area, "WINDOW")
        return view.x + view.width // 3, view.y + view.height // 2

    def key(self, kind: str, words: str, **more: bool) -> Iterator[None]:
        """Presses a key over the editor."""
        self.steps.append(words)
        self.keys += 1
        yield from moved(self.stage.window, *self.middle())
        for value in ("PRESS", "RELEASE"):
            self.stage.window.event_simulate(
                type=kind, value=value, x=self.middle()[0], y=self.middle()[1], **more
            )
            yield
        yield from self.stage.redrawn()

    def sidebar(self) -> Iterator[None]:
        """Opens the sidebar and the tab."""
        yield from self.key("N", "Key **N**: the sidebar opens.")
        yield from self.click(self._tab_place, "Click the tab **Prefilter**.")
        yield from until(lambda: self.stage.tab == "Prefilter")
        yield from self.stage.redrawn()

    def click(self, place: tuple[int, int], words: str) -> Iterator[None]:
        """Clicks."""
        self.steps.append(words)
        self.clicks += 1
        yield from clicked(self.stage.window, *place)

    def press(self, command: str, words: str) -> Iterator[None]:
        """Presses the button of the sidebar whose Python call begins with `command`."""
        place = yield from window.place_of(self.stage.window, self.stage.area, command)
        yield from self.click(place, words)

    def make(self, command: str, words: str) -> Iterator[None]:
        """Presses a button that starts a job, and waits for the result."""
        place = yield from window.place_of(self.stage.window, self.stage.area, command)
        yield from self.watched(self.click(place, words))

    def watched(self, steps: Iterator[None]) -> Iterator[None]:
        """Takes steps, waits for the jobs that they start, and measures the time."""
        with self._timing():
            yield from self._waited(steps)

    def _waited(self, steps: Iterator[None]) -> Iterator[None]:
        self._watches, self._last = True, time.monotonic()
        yield from steps
        began = time.monotonic()
        yield
        yield from until(idle)
        self.wait += time.monotonic() - began
        self._watches = False
        yield from self.stage.redrawn()

    @contextmanager
    def _timing(self) -> Iterator[None]:
        """Measures how long operators of the add-on block the main thread."""
        found = (
            (one, name)
            for one in (
                sys.modules[f"{PACKAGE}.core.operator"].BackgroundOperator,
                sys.modules[f"{PACKAGE}.welcome.operators"].PREFILTER_OT_demonstrate,
            )
            for name in ("invoke", "modal", "execute")
            if name in vars(one)
        )
        before = [(one, name, vars(one)[name]) for one, name in found]
        for one, name, function in before:
            setattr(one, name, self._timed(function))
        yield
        for one, name, function in before:
            setattr(one, name, function)

    def _timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        # Blender asks how many arguments a function of an operator has.
        def execute(operator: Any, context: Any) -> Any:
            with self._clock():
                return function(operator, context)

        def handle(operator: Any, context: Any, event: Any) -> Any:
            with self._clock():
                return function(operator, context, event)

        return execute if function.__name__ == "execute" else handle

    @contextmanager
    def _clock(self) -> Iterator[None]:
        began = time.monotonic()
        yield
        self.own = max(self.own, time.monotonic() - began)

    def drag(self, start: tuple[int, int], end: tuple[int, int]) -> Iterator[None]:
        """Drags from one position to another."""
        self.drags += 1
        yield from moved(self.stage.window, *start)
        for kind, value, (x, y) in (
            ("LEFTMOUSE", "PRESS", start),
            ("MOUSEMOVE", "NOTHING", end),
            ("LEFTMOUSE", "RELEASE", end),
        ):
            self.stage.window.event_simulate(type=kind, value=value, x=x, y=y)
            yield

    def told(self, start: str, result: str) -> dict[str, object]:
        """Returns the costs."""
        return {
            "version": ".".join(map(str, bpy.app.version[:2])),
            "clicks": self.clicks,
            "keys": self.keys,
            "drags": self.drags,
            "wait": round(self.wait, 2),
            "gap": round(self.gap, 2),
            "own": round(self.own, 2),
            "start": start,
            "steps": self.steps,
            "result": result,
        }

    def _tick(self) -> float:
        now = time.monotonic()
        if self._watches:
            self.gap = max(self.gap, now - self._last)
        self._last = now
        return TICK


Walk = Generator[None, None, dict[str, object]]


def game_artist() -> Walk:
    """Bakes all images of a model."""
    obj = stone()
    tree = obj.active_material.node_tree
    shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    bumps = tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(bumps.outputs[0], shader.inputs["Normal"])
    flat = np.tile(np.float32([0.5, 0.5, 1.0, 1.0]), (1024, 1024, 1))
    for name, socket, pixels in (
        ("Roughness", shader.inputs["Roughness"], scenes.noise(1024, 1024)),
        ("Normal", bumps.inputs["Color"], flat),
    ):
        node = tree.nodes.new("ShaderNodeTexImage")
        node.image = scenes.image(name, pixels, colorspace="Non-Color")
        tree.links.new(node.outputs["Color"], socket)
    hand = yield from opened("VIEW_3D")
    yield from hand.sidebar()
    yield from hand.make("prefilter.bake_model(", "Click **Make Mipmaps**.")
    files = sorted(path.name for path in (FOLDER / "mipmaps").iterdir())
    assert len(files) == 3, files
    return hand.told(
        "A file is just opened: a model with three images of 1024 x 1024.",
        "Three KTX 2 files are in the folder `mipmaps` beside the file.",
    )


def look_dev() -> Walk:
    """Makes a texture cache."""
    obj = stone()
    (node,) = (one for one in obj.active_material.node_tree.nodes if one.type == "TEX_IMAGE")
    node.image.filepath_raw, node.image.file_format = str(FOLDER / "stone.png"), "PNG"
    node.image.save()
    node.image.unpack(method="REMOVE")
    bpy.context.scene.render.engine = "CYCLES"
    hand = yield from opened("VIEW_3D")
    yield from hand.sidebar()
    yield from hand.make("prefilter.bake_texture_cache(", "Click **Make Texture Cache**.")
    assert bpy.context.scene.render.use_texture_cache
    assert len(list(FOLDER.rglob("*.tx"))) == 1
    return hand.told(
        "A file for Cycles is just opened, with a texture of 1024 x 1024.",
        "The next render reads the baked levels.",
    )


def printer() -> Walk:
    """Makes a solid."""
    broken()
    hand = yield from opened("VIEW_3D")
    yield from hand.sidebar()
    yield from hand.make("prefilter.voxelize(", "Click **Make Solid**.")
    assert bodies.is_closed(bpy.context.active_object)
    return hand.told(
        "A file is just opened: a mesh full of holes, with a ring through it that is inside out.",
        "The mesh is closed.",
    )


def sculptor() -> Walk:
    """Makes a solid of a sculpture."""
    broken()
    hand = yield from opened("VIEW_3D")
    with bpy.context.temp_override(**hand.stage.override):
        bpy.ops.object.mode_set(mode="SCULPT")
    yield from hand.stage.redrawn()
    yield from hand.sidebar()
    yield from hand.make("prefilter.voxelize(", "Click **Make Solid**.")
    assert bpy.context.mode == "SCULPT"
    assert bodies.is_closed(bpy.context.active_object)
    return hand.told(
        "A sculpture is open in Sculpt Mode.", "It is closed, and still in Sculpt Mode."
    )


def scanner() -> Walk:
    """Drops a scan, and makes its surface."""
    positions, normals, _ = models().knot(200_000)
    np.savetxt(FOLDER / "knot.xyz", np.c_[positions, normals], fmt="%.6f")
    stage = begun("VIEW_3D")
    window.without_objects()
    yield
    hand = Hand(stage)
    yield from moved(stage.window, *hand.middle())
    # Blender calls this when files are dropped; drops from other programs cannot be simulated.
    with bpy.context.temp_override(**stage.override):
        bpy.ops.prefilter.drop_points(
            "INVOKE_DEFAULT", directory=str(FOLDER), files=[{"name": "knot.xyz"}]
        )
    hand.steps.append("Drop the file onto the 3D view: a menu opens.")
    yield
    yield
    yield from hand.watched(hand.click(menu_entry(hand, 1), "Click **Reconstruct Surface**."))
    yield from until(lambda: any("surface" in obj.name for obj in bpy.data.objects))
    return hand.told(
        "An empty scene, and a file of 200,000 points with normals.",
        "The surface is there, with the points hidden.",
    )


def menu_entry(hand: Hand, number: int) -> tuple[int, int]:
    """Returns the position of an entry of a menu at the mouse; the first is 0."""
    x, y = hand.middle()
    return x, y - round(20 * bpy.context.preferences.system.ui_scale * number)


def button_of_dialog(hand: Hand) -> tuple[int, int]:
    """Returns the position of OK in the dialog at the mouse, for a dropped zip."""
    x, y = hand.middle()
    scale = bpy.context.preferences.system.ui_scale
    return x - round(22 * scale), y - round(91 * scale)


def designer() -> Walk:
    """Makes an image of a text."""
    window.without_objects()
    bpy.ops.object.text_add()
    bpy.context.object.data.body = "Prefilter"
    hand = yield from opened("VIEW_3D")
    before = len(bpy.data.images)
    yield from hand.sidebar()
    yield from hand.make("prefilter.rasterize(", "Click **Make Image**.")
    assert len(bpy.data.images) == before + 1
    return hand.told("A text is active.", "The image is in the list of images.")


def texture_artist() -> Walk:
    """Straightens a facade."""
    size = (900, 700)
    places = ((120, 90), (780, 180), (760, 560), (140, 640))
    image = scenes.image("Facade", facade(size, places))
    stage = begun("IMAGE_EDITOR")
    stage.area.spaces.active.image = image
    yield
    with bpy.context.temp_override(**stage.override):
        bpy.ops.image.view_all(fit_view=True)
    hand = Hand(stage)
    yield from hand.learn()
    yield from hand.sidebar()
    yield from hand.press("prefilter.drag_corners(", "Click **Drag Corners**.")
    yield from stage.redrawn()
    settings = bpy.context.scene.prefilter_resample
    hand.steps.append("Drag the four corners onto those of the facade.")
    for name, place in zip(_CORNERS, places, strict=True):
        start = np.array(getattr(settings, name)) * size
        yield from hand.drag(on_screen(stage, start, size), on_screen(stage, place, size))
    before = len(bpy.data.images)
    yield from hand.make("prefilter.resample_image(", "Click **Make Image**.")
    assert len(bpy.data.images) == before + 1
    return hand.told(
        "An Image editor shows a photo of 900 x 700.",
        "The straightened facade is a new image, which the editor shows.",
    )


def newcomer() -> Walk:
    """Drops the zip, and presses a button of the welcome."""
    assert PACKAGE not in bpy.context.preferences.addons
    (archive,) = (ROOT / "build").glob("prefilter-*.zip")
    stage = largest("VIEW_3D")
    yield
    hand = Hand(stage)
    yield from moved(stage.window, *hand.middle())
    # Blender calls this when a zip is dropped; drops from other programs cannot be simulated.
    with bpy.context.temp_override(**stage.override):
        bpy.ops.extensions.package_install_files("INVOKE_DEFAULT", url=str(archive))
    hand.steps.append("Drop the zip onto the window: Blender asks.")
    for _ in range(5):
        yield
    yield from hand.click(button_of_dialog(hand), "Click **OK**.")
    yield from until(lambda: PACKAGE in bpy.context.preferences.addons)
    for _ in range(20):
        yield
    yield from hand.learn()
    yield from hand.sidebar()
    words = "Click **Bake and Compare**."
    yield from hand.make("prefilter.demonstrate(kind='mipmaps'", words)
    yield from until(lambda: "Stone Prefilter.mip04" in bpy.data.images)
    return hand.told(
        "Blender just started, and never had the extension.",
        "A stone with its full texture, with a level by the box filter, and with one by Prefilter.",
    )


def models():
    """Returns the module of the included models."""
    import importlib

    begun()
    return importlib.import_module(f"{PACKAGE}.welcome.models")


def stone() -> bpy.types.Object:
    """Makes the painted stone, selected, in an empty scene."""
    window.without_objects()
    made = models()
    model, pixels = made.stone(), made.paint(1024)
    obj = object_of("Stone", model)
    layer = obj.data.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", model.uvs.astype(np.float32).ravel())
    material = bpy.data.materials.new("Stone")
    if material.node_tree is None:
        material.use_nodes = True
    tree = material.node_tree
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = scenes.image("Paint", pixels)
    shader = next(one for one in tree.nodes if one.type == "BSDF_PRINCIPLED")
    tree.links.new(node.outputs["Color"], shader.inputs["Base Color"])
    obj.data.materials.append(material)
    return obj


def broken() -> bpy.types.Object:
    """Makes the broken stone, selected, in an empty scene."""
    window.without_objects()
    return object_of("Broken", models().broken_stone())


def object_of(name: str, model) -> bpy.types.Object:
    """Makes an object of a model, selected."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(model.points.tolist(), [], model.quads.tolist())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.select_set(True)
    bpy.context.view_layer.objects.active = obj
    return obj


def opened(kind: str) -> Generator[None, None, Hand]:
    """Saves the file, opens it, and returns a hand over the largest editor."""
    path = str(FOLDER / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=path)
    yield
    bpy.ops.wm.open_mainfile(filepath=path, load_ui=False)
    yield
    begun(kind)
    hand = Hand(largest(kind))
    yield from hand.learn()
    return hand


def facade(size: tuple[int, int], places) -> np.ndarray:
    """Returns pixels of rows of windows, in perspective, between four corners."""
    rows = []
    for (x, y), (u, v) in zip(places, ((0, 0), (1, 0), (1, 1), (0, 1)), strict=True):
        rows += [[x, y, 1, 0, 0, 0, -u * x, -u * y, u], [0, 0, 0, x, y, 1, -v * x, -v * y, v]]
    system = np.array(rows, float)
    to_wall = np.append(np.linalg.solve(system[:, :8], system[:, 8]), 1.0).reshape(3, 3)
    y, x = np.mgrid[0 : size[1], 0 : size[0]] + 0.5
    u, v, w = np.einsum("ij,jyx->iyx", to_wall, np.stack([x, y, np.ones_like(x)]))
    u, v = u / w, v / w
    inside = (u > 0) & (u < 1) & (v > 0) & (v < 1)
    panes = ((u * 8 % 1 > 0.25) & (u * 8 % 1 < 0.75) & (v * 6 % 1 > 0.2) & (v * 6 % 1 < 0.8))[
        ..., None
    ]
    wall = np.where(panes, (0.15, 0.22, 0.3), (0.75, 0.55, 0.4))
    pixels = np.ones((size[1], size[0], 4), np.float32)
    pixels[..., :3] = np.where(inside[..., None], wall, (0.6, 0.75, 0.9))
    return pixels


def on_screen(stage: Stage, place, size: tuple[int, int]) -> tuple[int, int]:
    """Returns the position of a pixel of the image in the window."""
    part = region(stage.area, "WINDOW")
    x, y = part.view2d.view_to_region(place[0] / size[0], place[1] / size[1], clip=False)
    return part.x + x, part.y + y


def session() -> Iterator[None]:
    """Walks the path, and prints its costs."""
    version = ".".join(map(str, bpy.app.version[:2]))
    if (NAME, version) in page.NOT_IN:
        told = {"version": version, "left_out": page.NOT_IN[NAME, version]}
    else:
        told = yield from globals()[NAME]()
    print(page.TOLD + json.dumps(told), flush=True)


window.play(session())
