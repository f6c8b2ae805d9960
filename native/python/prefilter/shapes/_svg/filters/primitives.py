# SPDX-License-Identifier: GPL-3.0-or-later

"""Reading of filter primitives."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .... import _native
from ...affine import Matrix
from ..model.blending import BLEND_MODES
from ..model.colors import Color
from ..model.tree import Box
from ..model.values import leading_numbers, parse_color, parse_number
from ..read.context import Sources
from ..read.document import SvgElement

_OPERATORS = ("over", "in", "out", "atop", "xor", "lighter", "arithmetic")
_CHANNELS = ("feFuncR", "feFuncG", "feFuncB", "feFuncA")
_EDGE_MODES = ("duplicate", "wrap", "none")
_LIGHTS = ("feDistantLight", "fePointLight", "feSpotLight")
_MAX_WEIGHTS = 400
_MAX_OCTAVES = 10
# Luminance weights in Filter Effects.
_RED, _GREEN, _BLUE = 0.213, 0.715, 0.072
_SATURATION = np.array([[_RED, _GREEN, _BLUE]] * 3)


class UnsupportedPrimitiveError(Exception):
    """A filter uses an unsupported feature, named in the message."""


@dataclass(frozen=True)
class FilterUnits:
    """Units and region of a filter.

    Attributes:
        matrix: From the primitives' units, which may be fractions of a box, to the element's.
        region: The filter region, in the element's units.
    """

    matrix: Matrix
    region: Box


Parameters = tuple[list[str], list[float], str]
"""Names of inputs, numeric parameters, and the name of an operator or mode."""
Matrix5 = npt.NDArray[np.float64]


def _numbers(text: str | None, default: list[float]) -> list[float]:
    numbers, is_complete = leading_numbers(text or "")
    return numbers if numbers and is_complete else default


def _number(element: SvgElement, name: str, default: float) -> float:
    number = parse_number(element.get(name, ""))
    return default if number is None else number


def _input(element: SvgElement, name: str = "in") -> str:
    return element.get(name, "").strip()


def _blur(element: SvgElement, units: FilterUnits, _: Sources) -> Parameters:
    return [_input(element)], _deviations(element, 0.0, units), ""


def _deviations(element: SvgElement, default: float, units: FilterUnits) -> list[float]:
    numbers = _numbers(element.get("stdDeviation"), [default])
    if len(numbers) > 2 or min(numbers) < 0.0:
        numbers = [0.0]
    return _scales(numbers[0], numbers[-1], units)


def _scales(x: float, y: float, units: FilterUnits) -> list[float]:
    """Scales lengths along x and y to the element's units."""
    return [x * units.matrix[0], y * units.matrix[3]]


def _offset(element: SvgElement, units: FilterUnits, _: Sources) -> Parameters:
    x, y = _number(element, "dx", 0.0), _number(element, "dy", 0.0)
    return [_input(element)], _scales(x, y, units), ""


def _flood(element: SvgElement, _: FilterUnits, sources: Sources) -> Parameters:
    color = _color(element, "flood-color", (0.0, 0.0, 0.0, 1.0), sources)
    opacity = parse_number(sources.sheets.declared(element).get("flood-opacity", "1"))
    alpha = color[3] * (1.0 if opacity is None else min(max(opacity, 0.0), 1.0))
    return [], [*color[:3], alpha], ""


def _color(element: SvgElement, name: str, default: Color, sources: Sources) -> Color:
    color = parse_color(sources.sheets.declared(element).get(name, "none"))
    if color is None:
        return default
    return sources.sheets.style(element).color if isinstance(color, str) else color


def _shadow(element: SvgElement, units: FilterUnits, sources: Sources) -> Parameters:
    _, color, _ = _flood(element, units, sources)
    move = _scales(_number(element, "dx", 2.0), _number(element, "dy", 2.0), units)
    return [_input(element)], [*_deviations(element, 2.0, units), *move, *color], ""


def _merge(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    nodes = [node for node in element if node.tag == "feMergeNode"]
    return [_input(node) for node in nodes if isinstance(node, SvgElement)], [], ""


def _composite(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    name = element.get("operator", "over").strip()
    factors = [_number(element, f"k{k}", 0.0) for k in range(1, 5)]
    inputs = [_input(element), _input(element, "in2")]
    return inputs, factors, name if name in _OPERATORS else "over"


def _blend(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    name = element.get("mode", "normal").strip()
    return [_input(element), _input(element, "in2")], [], name if name in BLEND_MODES else "normal"


def saturation_matrix(share: float) -> Matrix5:
    """Returns a color matrix that scales saturation."""
    matrix = np.eye(4, 5)
    matrix[:3, :3] = _SATURATION + share * (np.eye(3) - _SATURATION)
    return matrix


def hue_rotation_matrix(degrees: float) -> Matrix5:
    """Returns a color matrix that rotates hues."""
    angle = degrees * (np.pi / 180.0)
    cos, sin = _native.cos(angle), _native.sin(angle)
    turn = np.array([[-0.213, -0.715, 0.928], [0.143, 0.140, -0.283], [-0.787, 0.715, 0.072]])
    matrix = np.eye(4, 5)
    matrix[:3, :3] = _SATURATION + cos * (np.eye(3) - _SATURATION) + sin * turn
    return matrix


def _color_matrix(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    kind = element.get("type", "matrix").strip()
    matrix = np.eye(4, 5)
    if kind == "luminanceToAlpha":
        matrix = np.zeros((4, 5))
        matrix[3, :3] = _RED, _GREEN, _BLUE
    elif kind == "saturate":
        matrix = saturation_matrix(_numbers(element.get("values"), [1.0])[0])
    elif kind == "hueRotate":
        matrix = hue_rotation_matrix(_numbers(element.get("values"), [0.0])[0])
    else:
        values = _numbers(element.get("values"), [])
        if len(values) == 20:
            matrix = np.array(values).reshape(4, 5)
    return [_input(element)], matrix.ravel().tolist(), ""


def _transfer(element: SvgElement, _: FilterUnits, sources: Sources) -> Parameters:
    """Parameters: per channel a count and as many table values; a negative count means steps, 0
    gamma.
    """
    del sources
    numbers: list[float] = []
    for name in _CHANNELS:
        functions = [child for child in element if child.tag == name]
        function = functions[-1] if functions else None
        kind = function.get("type", "identity").strip() if function is not None else "identity"
        if isinstance(function, SvgElement) and kind == "gamma":
            # No table, but a power.
            numbers += [0.0, _number(function, "amplitude", 1.0)]
            numbers += [_number(function, "exponent", 1.0), _number(function, "offset", 0.0)]
            continue
        values = [0.0, 1.0]
        if isinstance(function, SvgElement) and kind == "linear":
            start = _number(function, "intercept", 0.0)
            values = [start, start + _number(function, "slope", 1.0)]
        elif function is not None and kind in ("table", "discrete"):
            values = _numbers(function.get("tableValues"), values)
        is_discrete = (
            kind == "discrete" and function is not None and "tableValues" in function.attrib
        )
        numbers += [-len(values) if is_discrete else len(values), *values]
    return [_input(element)], numbers, ""


def _morphology(element: SvgElement, units: FilterUnits, _: Sources) -> Parameters:
    numbers = _numbers(element.get("radius"), [0.0])
    if len(numbers) > 2 or min(numbers) < 0.0:
        numbers = [0.0]
    is_dilating = element.get("operator", "erode").strip() == "dilate"
    lengths = _scales(numbers[0], numbers[-1], units)
    return [_input(element)], lengths, "dilate" if is_dilating else "erode"


def _nothing(element: SvgElement) -> Parameters:
    """Invalid attributes: the result is transparent."""
    return [_input(element)], [], "nothing"


def _tile(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    return [_input(element)], [], ""


def _convolution(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    """Parameters: columns, rows, target column and row, preserveAlpha, bias, weights."""
    sizes = _numbers(element.get("order"), [] if "order" in element.attrib else [3.0])
    weights = _numbers(element.get("kernelMatrix"), [])
    if len(sizes) not in (1, 2) or any(size != int(size) or size < 1.0 for size in sizes):
        return _nothing(element)
    columns, rows = int(sizes[0]), int(sizes[-1])
    if columns * rows != len(weights):
        return _nothing(element)
    if len(weights) > _MAX_WEIGHTS:
        raise UnsupportedPrimitiveError(f"more than {_MAX_WEIGHTS} weights of <feConvolveMatrix>")
    x = _number(element, "targetX", columns // 2)
    y = _number(element, "targetY", rows // 2)
    if not (0 <= x < columns and 0 <= y < rows):
        return _nothing(element)
    divisor = _number(element, "divisor", 0.0) or sum(weights) or 1.0
    keeps_alpha = element.get("preserveAlpha", "false").strip() == "true"
    numbers = [columns, rows, math.floor(x), math.floor(y), float(keeps_alpha)]
    numbers += [_number(element, "bias", 0.0), *(weight / divisor for weight in weights)]
    mode = element.get("edgeMode", "duplicate").strip()
    return [_input(element)], numbers, mode if mode in _EDGE_MODES else "duplicate"


def _turbulence(element: SvgElement, _: FilterUnits, __: Sources) -> Parameters:
    """Parameters: frequencies, octaves, seed, and whether tiles are seamless."""
    numbers = _numbers(element.get("baseFrequency"), [0.0])
    if len(numbers) > 2 or min(numbers) < 0.0:
        numbers = [0.0]
    octaves = _number(element, "numOctaves", 1.0)
    if octaves < 1.0:
        return _nothing(element)
    fits = element.get("stitchTiles", "noStitch").strip() == "stitch"
    parameters = [numbers[0], numbers[-1], float(min(int(octaves), _MAX_OCTAVES))]
    parameters += [float(int(_number(element, "seed", 0.0))), float(fits)]
    is_fractal = element.get("type", "turbulence").strip() == "fractalNoise"
    return [], parameters, "fractalNoise" if is_fractal else "turbulence"


def _lighting(element: SvgElement, units: FilterUnits, sources: Sources) -> Parameters:
    """Parameters: surface scale, strength, shininess, color, and those of the light source."""
    color = _color(element, "lighting-color", (1.0, 1.0, 1.0, 1.0), sources)
    lights = [child for child in element if child.tag in _LIGHTS]
    if not lights or not isinstance(lights[0], SvgElement):
        return _nothing(element)
    is_diffuse = element.tag == "feDiffuseLighting"
    strength = _number(element, "diffuseConstant" if is_diffuse else "specularConstant", 1.0)
    shininess = min(max(_number(element, "specularExponent", 1.0), 1.0), 128.0)
    numbers = [_number(element, "surfaceScale", 1.0), max(strength, 0.0), shininess, *color[:3]]
    return [_input(element)], [*numbers, *_light(lights[0], units)], lights[0].tag


def _light(light: SvgElement, units: FilterUnits) -> list[float]:
    """Returns the direction of a distant light; for others the position, then that of a spot's
    target.
    """
    if light.tag == "feDistantLight":
        angles = (
            _number(light, name, 0.0) * (math.pi / 180.0) for name in ("azimuth", "elevation")
        )
        azimuth, elevation = angles
        flat = _native.cos(elevation)
        x, y = flat * _native.cos(azimuth), flat * _native.sin(azimuth)
        return [x, y, _native.sin(elevation)]
    parameters = _position(light, ("x", "y", "z"), units)
    if light.tag == "feSpotLight":
        parameters += _position(light, ("pointsAtX", "pointsAtY", "pointsAtZ"), units)
        exponent = _number(light, "specularExponent", 1.0)
        # Browsers treat an angle of 0 as missing.
        cone = _number(light, "limitingConeAngle", 0.0) or 180.0
        parameters += [min(max(exponent, 1.0), 128.0)]
        parameters += [_native.cos(min(abs(cone), 180.0) * (math.pi / 180.0))]
    return parameters


def _position(light: SvgElement, names: tuple[str, str, str], units: FilterUnits) -> list[float]:
    x, y, z = (_number(light, name, 0.0) for name in names)
    a, _, _, d, e, f = units.matrix
    return [a * x + e, d * y + f, math.sqrt((a * a + d * d) / 2.0) * z]


def _image(_: SvgElement, __: FilterUnits, ___: Sources) -> Parameters:
    return [], [], ""


PRIMITIVE_READERS: Mapping[str, Callable[[SvgElement, FilterUnits, Sources], Parameters]] = {
    "feGaussianBlur": _blur,
    "feOffset": _offset,
    "feFlood": _flood,
    "feDropShadow": _shadow,
    "feMerge": _merge,
    "feComposite": _composite,
    "feBlend": _blend,
    "feColorMatrix": _color_matrix,
    "feComponentTransfer": _transfer,
    "feMorphology": _morphology,
    "feTile": _tile,
    "feConvolveMatrix": _convolution,
    "feTurbulence": _turbulence,
    "feDiffuseLighting": _lighting,
    "feSpecularLighting": _lighting,
    "feImage": _image,
}
