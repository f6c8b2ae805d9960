# SPDX-License-Identifier: GPL-3.0-or-later

"""The OSL shader of a sampling table, rendered by Cycles."""

import _cycles
import bpy
import cycles_scenes
import numpy as np
import OpenImageIO as oiio
import prefilter
import pytest
import scenes

pytestmark = pytest.mark.skipif(not _cycles.with_osl, reason="this Blender has no OSL")

COLUMNS, ROWS = 48, 32
WIDTH, HEIGHT = 100, 37
WRAP_MODES = ("clamp", "repeat", "border")


def write_levels(levels, folder):
    for level, pixels in enumerate(levels):
        buffer = oiio.ImageBuf(np.ascontiguousarray(pixels[::-1]))
        assert buffer.write(str(folder / f"level.{level}.exr"), "float"), buffer.geterror()


def files_of_levels(folder):
    # Cycles of Blender 5.2 has t = 0 at the bottom.
    flip = int(bpy.app.version < (5, 2))
    return {"Levels": str(folder / "level."), "Width": WIDTH, "Height": HEIGHT, "Flip": flip}


def add_samples(coordinates, scales):
    """One square a pixel; all of a square has the same UV and the same scale."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    x, y = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    squares = np.stack([x.ravel(), y.ravel()], axis=1)[:, None] + corners
    positions = squares / COLUMNS + [0.0, 0.5 - 0.5 * ROWS / COLUMNS]
    vertices = np.zeros((positions.shape[0] * 4, 3))
    vertices[:, :2] = positions.reshape(-1, 2)
    mesh = bpy.data.meshes.new("Samples")
    mesh.from_pydata(vertices, [], np.arange(len(vertices)).reshape(-1, 4).tolist())
    mesh.uv_layers.new(name="UV").data.foreach_set("uv", np.repeat(coordinates, 4, axis=0).ravel())
    attribute = mesh.attributes.new("scale", "FLOAT", "FACE")
    attribute.data.foreach_set("value", scales)
    made = bpy.data.objects.new("Samples", mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def add_plane(corners):
    """One rectangle that fills the picture, with these UVs at its corners."""
    y = 0.5 - 0.5 * ROWS / COLUMNS
    mesh = bpy.data.meshes.new("Plane")
    mesh.from_pydata([(0, y, 0), (1, y, 0), (1, 1 - y, 0), (0, 1 - y, 0)], [], [(0, 1, 2, 3)])
    mesh.uv_layers.new(name="UV").data.foreach_set("uv", np.ravel(corners))
    made = bpy.data.objects.new("Plane", mesh)
    bpy.context.scene.collection.objects.link(made)
    return made


def script_material(source, settings, *, output="Color", has_scale=True):
    """Emits the shader's result for the UV map and the attribute "scale"."""
    text = bpy.data.texts.new("shader.osl")
    text.write(source)
    material = bpy.data.materials.new("Script")
    scenes.use_nodes(material)
    tree = material.node_tree
    tree.nodes.clear()
    script = tree.nodes.new("ShaderNodeScript")
    script.script = text
    for name, value in settings.items():
        script.inputs[name].default_value = value
    uv = tree.nodes.new("ShaderNodeUVMap")
    emission = tree.nodes.new("ShaderNodeEmission")
    end = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(uv.outputs["UV"], script.inputs["Vector"])
    if has_scale:
        scale = tree.nodes.new("ShaderNodeAttribute")
        scale.attribute_name = "scale"
        tree.links.new(scale.outputs["Fac"], script.inputs["Scale"])
    tree.links.new(script.outputs[output], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], end.inputs["Surface"])
    return material


def set_up():
    """The sockets of script nodes are known only where Cycles is the engine."""
    scene = bpy.context.scene
    cycles_scenes.set_up(scene)
    scene.cycles.shading_system = True
    scene.cycles.samples = 1
    scene.render.resolution_x, scene.render.resolution_y = COLUMNS, ROWS
    scene.render.resolution_percentage = 100


def rendered(folder):
    scene = bpy.context.scene
    scene.render.filepath = str(folder / "rendered.exr")
    bpy.ops.render.render(write_still=True)
    return oiio.ImageBuf(scene.render.filepath).get_pixels()[::-1, :, :3].reshape(-1, 3)


@pytest.fixture
def levels(tmp_path):
    """Levels, also as files in tmp_path."""
    set_up()
    image = np.random.default_rng(5).random((HEIGHT, WIDTH, 4), np.float32)
    found = prefilter.sampling_levels(image, "lanczos2", premultiplied=True)
    write_levels(found, tmp_path)
    return found


@pytest.mark.parametrize(("texels", "wrap", "output"), [(8, (0, 1), "Color"), (4, (2, 0), "Alpha")])
def test_cycles_renders_the_samples_of_the_package(levels, texels, wrap, output, tmp_path):
    rng = np.random.default_rng(texels)
    table = prefilter.SamplingTable.standard("lanczos2", texels)
    count = COLUMNS * ROWS
    coordinates = rng.integers(-(2**14), 5 * 2**14, (count, 2)) / 2**16
    scales = np.exp2(rng.uniform(-1.0, len(levels), count)).astype(np.float32)
    samples = add_samples(coordinates, scales)
    settings = files_of_levels(tmp_path) | {"WrapU": wrap[0], "WrapV": wrap[1]}
    samples.data.materials.append(script_material(table.osl(), settings, output=output))

    modes = (WRAP_MODES[wrap[0]], WRAP_MODES[wrap[1]])
    wanted = prefilter.sample(levels, table, coordinates, scales, wrap=modes)
    wanted = wanted[:, :3] if output == "Color" else wanted[:, 3:]
    got = rendered(tmp_path)
    np.testing.assert_allclose(got, np.broadcast_to(wanted, got.shape), rtol=0, atol=2e-5)


def test_the_scale_is_that_of_pixels_where_none_is_given(levels, tmp_path):
    scene = bpy.context.scene
    scene.cycles.pixel_filter_type = "GAUSSIAN"
    scene.cycles.filter_width = 0.01
    table = prefilter.SamplingTable.standard("lanczos2", 8)
    # Texels of level 0 a pixel: 3.2 along one axis, 1.1 across it.
    angles = np.radians([20.0, 65.0])
    turn, turn_back = (np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]) for a in angles)
    jacobian = turn @ np.diag([3.2, 1.1]) @ turn_back / [[WIDTH], [HEIGHT]]
    corners = np.array([[0, 0], [COLUMNS, 0], [COLUMNS, ROWS], [0, ROWS]]) @ jacobian.T
    plane = add_plane(corners)
    settings = files_of_levels(tmp_path) | {"WrapU": 1, "WrapV": 1}
    plane.data.materials.append(script_material(table.osl(), settings, has_scale=False))

    x, y = np.meshgrid(np.arange(COLUMNS) + 0.5, np.arange(ROWS) + 0.5)
    coordinates = np.stack([x.ravel(), y.ravel()], axis=1) @ jacobian.T
    wanted = prefilter.sample(levels, table, coordinates, 3.2, wrap="repeat")[:, :3]
    assert np.abs(rendered(tmp_path) - wanted).max() < 1e-4
    other = prefilter.sample(levels, table, coordinates, 3.0, wrap="repeat")[:, :3]
    assert np.abs(other - wanted).max() > 0.01
