# SPDX-License-Identifier: GPL-3.0-or-later

"""Nodes as functions of texels, compared with Cycles's bakes of the same nodes."""

import bpy
import numpy as np
import pytest
import scenes

SIDE = 8
ENDS = (0.0, 0.4, 1.3)
"""Operands beside the texel, so that operations meet their edges."""


def choices(kind, name, *left_out):
    """Returns the values that a setting of a node may have."""
    items = getattr(bpy.types, f"ShaderNode{kind}").bl_rna.properties[name].enum_items
    return [item.identifier for item in items if item.identifier not in left_out]


MATH = choices("Math", "operation")
VECTORS = choices("VectorMath", "operation", "FACEFORWARD", "REFRACT", "PROJECT")
BLENDS = choices("Mix", "blend_type", "HUE", "SATURATION", "COLOR", "VALUE")
"""All operations except the documented exceptions."""


class Chain:
    """A material that emits an image changed by nodes."""

    def __init__(self):
        picture = scenes.image("Texels", scenes.noise(SIDE, SIDE), colorspace="Non-Color")
        self.obj = scenes.quads("Square")
        material = scenes.material("Chain", picture)
        self.obj.data.materials.append(material)
        self.tree = material.node_tree
        self.tree.nodes.remove(next(n for n in self.tree.nodes if n.type == "BSDF_PRINCIPLED"))
        self.texture = next(node for node in self.tree.nodes if node.type == "TEX_IMAGE")
        self.texture.interpolation = "Closest"
        output = next(node for node in self.tree.nodes if node.type == "OUTPUT_MATERIAL")
        self.emission = self.add("Emission")
        self.link(self.emission.outputs[0], output.inputs["Surface"])
        self.color = self.texture.outputs["Color"]

    def add(self, kind, **values):
        node = self.tree.nodes.new(f"ShaderNode{kind}")
        for name, value in values.items():
            setattr(node, name, value)
        return node

    def link(self, source, target):
        self.tree.links.new(source, target)

    def channel(self, number):
        apart = self.add("SeparateColor")
        self.link(self.color, apart.inputs[0])
        return apart.outputs[number]

    def joined(self, outputs):
        made = self.add("CombineXYZ")
        for output, target in zip(outputs, made.inputs, strict=True):
            self.link(output, target)
        return made.outputs[0]

    def baked(self):
        """Returns Cycles's bake of it, texel by texel."""
        scene = bpy.context.scene
        scene.render.engine, scene.cycles.samples = "CYCLES", 1
        scene.cycles.device, scene.cycles.use_denoising = "CPU", False
        scene.render.bake.margin = 0
        target = bpy.data.images.new("Baked", SIDE, SIDE, float_buffer=True)
        target.colorspace_settings.name = "Non-Color"
        node = scenes.image_node(self.tree, target)
        self.tree.nodes.active = node
        bpy.context.view_layer.objects.active = self.obj
        self.obj.select_set(True)
        assert bpy.ops.object.bake(type="EMIT") == {"FINISHED"}
        return scenes.pixels("Baked")[..., :3]


@pytest.fixture
def chain():
    return Chain()


def check(addon, chain, output, *, tolerance=2e-4):
    chain.link(output, chain.emission.inputs["Color"])
    functions, images = addon("bridge.texel_functions"), addon("bridge.images")
    function = functions.TexelFunction(lambda image: images.read(image).stored)
    found = function.values(chain.emission.inputs["Color"], ())
    expected = chain.baked()
    np.testing.assert_allclose(
        np.broadcast_to(found, expected.shape), expected, rtol=tolerance, atol=tolerance
    )
    return function


@pytest.mark.parametrize("operation", MATH)
def test_math(addon, chain, operation):
    outputs = []
    for number, end in enumerate(ENDS):
        node = chain.add("Math", operation=operation)
        node.inputs[1].default_value = end
        node.inputs[2].default_value = 0.3
        chain.link(chain.channel(number), node.inputs[0])
        outputs.append(node.outputs[0])
    check(addon, chain, chain.joined(outputs))


@pytest.mark.parametrize("operation", VECTORS)
def test_vector_math(addon, chain, operation):
    node = chain.add("VectorMath", operation=operation)
    chain.link(chain.color, node.inputs[0])
    node.inputs[1].default_value = (0.5, 0.23, 1.5)
    node.inputs[2].default_value = (0.3, 0.0, 1.0)
    node.inputs[3].default_value = 0.7
    output = next(one for one in node.outputs if one.enabled)
    check(addon, chain, output)


@pytest.mark.parametrize("blend", BLENDS)
@pytest.mark.parametrize("factor", [1.0, 0.4])
def test_mix(addon, chain, blend, factor):
    node = chain.add("Mix", data_type="RGBA", blend_type=blend, clamp_result=factor < 1)
    by_name = {socket.identifier: socket for socket in node.inputs}
    by_name["Factor_Float"].default_value = factor
    by_name["B_Color"].default_value = (0.2, 0.8, 0.0, 1)
    chain.link(chain.color, by_name["A_Color"])
    output = next(one for one in node.outputs if one.enabled)
    check(addon, chain, output)


def curves(chain):
    node = chain.add("RGBCurve")
    node.inputs[0].default_value = 0.8
    for number, places in ((1, ((0, 1), (1, 0))), (3, ((0, 0.1), (0.4, 0.8), (1, 0.9)))):
        curve = node.mapping.curves[number]
        while len(curve.points) < len(places):
            curve.points.new(0.5, 0.5)
        for point, place in zip(curve.points, places, strict=True):
            point.location = place
    node.mapping.update()
    chain.link(chain.color, node.inputs["Color"])
    return node.outputs[0]


def ramp(chain):
    node = chain.add("ValToRGB")
    node.color_ramp.elements[0].color = (0.2, 1, 0, 1)
    node.color_ramp.elements.new(0.3).color = (1, 0, 0.5, 1)
    chain.link(chain.channel(1), node.inputs[0])
    return node.outputs[0]


def inverted(chain):
    node = chain.add("Invert")
    node.inputs[0].default_value = 0.7
    chain.link(chain.color, node.inputs["Color"])
    return node.outputs[0]


def gamma(chain):
    node = chain.add("Gamma")
    node.inputs["Gamma"].default_value = 2.2
    chain.link(chain.color, node.inputs["Color"])
    return node.outputs[0]


def contrast(chain):
    node = chain.add("BrightContrast")
    node.inputs[1].default_value, node.inputs[2].default_value = 0.1, 0.5
    chain.link(chain.color, node.inputs["Color"])
    return node.outputs[0]


def hue(chain):
    node = chain.add("HueSaturation")
    node.inputs["Hue"].default_value = 0.7
    node.inputs["Saturation"].default_value = 1.4
    node.inputs["Value"].default_value = 0.8
    chain.link(chain.color, node.inputs["Color"])
    return node.outputs[0]


def ranges(chain):
    outputs = []
    for number, kind in enumerate(("LINEAR", "SMOOTHSTEP", "STEPPED")):
        node = chain.add("MapRange", interpolation_type=kind)
        for name, value in (("From Min", 0.2), ("From Max", 0.7), ("To Max", 0.1)):
            next(one for one in node.inputs if one.name == name).default_value = value
        chain.link(chain.channel(number), node.inputs[0])
        outputs.append(node.outputs[0])
    return chain.joined(outputs)


def clamped(chain):
    node = chain.add("Clamp")
    node.inputs[1].default_value, node.inputs[2].default_value = 0.3, 0.6
    chain.link(chain.channel(0), node.inputs[0])
    return chain.joined([node.outputs[0], chain.channel(0), chain.channel(2)])


def hsv(chain):
    apart, together = chain.add("SeparateColor", mode="HSV"), chain.add("CombineColor", mode="HSL")
    chain.link(chain.color, apart.inputs[0])
    for output, target in zip(apart.outputs, together.inputs, strict=True):
        chain.link(output, target)
    return together.outputs[0]


def gray(chain):
    node = chain.add("RGBToBW")
    chain.link(chain.color, node.inputs[0])
    return node.outputs[0]


def grouped(chain):
    """A group that turns its input over, with a muted node and a reroute on the way."""
    tree = bpy.data.node_groups.new("Over", "ShaderNodeTree")
    tree.interface.new_socket("In", in_out="INPUT", socket_type="NodeSocketColor")
    tree.interface.new_socket("Out", in_out="OUTPUT", socket_type="NodeSocketColor")
    names = ("NodeGroupInput", "NodeGroupOutput", "ShaderNodeInvert", "ShaderNodeGamma")
    start, end, invert, muted = (tree.nodes.new(name) for name in names)
    muted.inputs["Gamma"].default_value, muted.mute = 3.0, True
    tree.links.new(start.outputs[0], muted.inputs["Color"])
    tree.links.new(muted.outputs[0], invert.inputs["Color"])
    tree.links.new(invert.outputs[0], end.inputs[0])
    node = chain.add("Group")
    node.node_tree = tree
    reroute = chain.tree.nodes.new("NodeReroute")
    chain.link(chain.color, reroute.inputs[0])
    chain.link(reroute.outputs[0], node.inputs[0])
    return node.outputs[0]


@pytest.mark.parametrize(
    "build",
    [curves, ramp, inverted, gamma, contrast, hue, ranges, clamped, hsv, gray, grouped],
    ids=lambda build: build.__name__,
)
def test_nodes(addon, chain, build):
    # Cycles looks curves and ramps up in tables of 256.
    tolerance = 6e-3 if build in (curves, ramp) else 2e-4
    function = check(addon, chain, build(chain), tolerance=tolerance)
    assert function.image.name == "Texels"
    assert function.changing


def test_nodes_that_are_not_functions_of_the_texel(addon, chain):
    functions, images = addon("bridge.texel_functions"), addon("bridge.images")
    other = scenes.image_node(chain.tree, scenes.image("Other", scenes.noise(SIDE, SIDE)))
    for node in (other, chain.add("TexNoise"), chain.add("Fresnel")):
        mix = chain.add("MixRGB")
        chain.link(chain.color, mix.inputs[1])
        chain.link(node.outputs[0], mix.inputs[2])
        chain.link(mix.outputs[0], chain.emission.inputs["Color"])
        function = functions.TexelFunction(lambda image: images.read(image).stored)
        with pytest.raises(functions.OtherNodeError) as raised:
            function.values(chain.emission.inputs["Color"], ())
        assert raised.value.node == node
