# SPDX-License-Identifier: GPL-3.0-or-later

"""Filter functions, and primitives for neighborhoods, light and noise, against closed forms and a
pixel-by-pixel version of the recommendation.
"""

import base64
import io
import math

import numpy as np
import prefilter
import pytest
from drawings import SIZE, same, svg
from test_svg_filters import AS_ENCODED, BOX, WIDE, box, drawn, plain

COLOR = np.array([51, 102, 204]) / 255
FLAT = box(0, 0, 100, 100, 'fill="rgb(51,102,204)" filter="{}"')
SEPIA = [[0.393, 0.769, 0.189], [0.349, 0.686, 0.168], [0.272, 0.534, 0.131]]


def functions(text, element=FLAT):
    result, warnings = prefilter.rasterize_svg(svg(element.format(text)), SIZE, SIZE)
    assert warnings == ()
    return result[::-1]


@pytest.mark.parametrize(
    ("text", "color"),
    [
        ("brightness(0.5)", 0.5 * COLOR),
        ("brightness(300%)", np.minimum(3 * COLOR, 1)),
        ("contrast(0.5)", 0.5 * COLOR + 0.25),
        ("contrast()", COLOR),
        ("invert(25%)", 0.25 + 0.5 * COLOR),
        ("grayscale(1)", np.full(3, COLOR @ (0.213, 0.715, 0.072))),
        ("grayscale(7)", np.full(3, COLOR @ (0.213, 0.715, 0.072))),
        ("saturate(0)", np.full(3, COLOR @ (0.213, 0.715, 0.072))),
        ("sepia(1)", np.array(SEPIA) @ COLOR),
        ("sepia(0.25)", 0.25 * (np.array(SEPIA) @ COLOR) + 0.75 * COLOR),
        ("hue-rotate(1turn)", COLOR),
        ("invert(1) brightness(0.5)", 0.5 * (1 - COLOR)),
        ("brightness(0.5) invert(1)", 1 - 0.5 * COLOR),
    ],
)
def test_functions_of_colors(text, color):
    np.testing.assert_allclose(functions(text)[50, 50], (*color, 1), atol=1e-5)


def test_missing_filters_are_skipped():
    element = FLAT.format("invert(1) url(#none) brightness(0.5)")
    actual, (warning,) = prefilter.rasterize_svg(svg(element), SIZE, SIZE)
    assert warning.kind == "broken"
    same(actual[::-1], functions("invert(1) brightness(0.5)"))


def test_opacity_is_a_function_too():
    same(functions("opacity(40%)"), functions("none") * np.float32(0.4))


def test_functions_equal_primitives_without_a_region():
    for text, step in (
        ("blur(5px)", '<feGaussianBlur stdDeviation="5"/>'),
        ("drop-shadow(teal 7px 4px 3px)", SHADOW),
        ("drop-shadow(7 4 3 teal)", SHADOW),
        ("drop-shadow(0.25em 4px) drop-shadow(9px 0 red)", ""),
    ):
        element = box(20, 20, 60, 50, 'fill="orange" filter="{}"')
        actual = functions(text, element)
        if step:
            same(actual, drawn(step, element.format("url(#f)")))
        else:
            under = plain(box(24, 24, 64, 54, "")), plain(box(20, 20, 60, 50, 'fill="orange"'))
            whole = under[1] + under[0] * (1 - under[1][..., 3:])
            moved = np.roll(whole[..., 3:], 9, axis=1) * np.array([1, 0, 0, 1], np.float32)
            same(actual, whole + moved * (1 - whole[..., 3:]))


SHADOW = '<feDropShadow dx="7" dy="4" stdDeviation="3" flood-color="teal"/>'


@pytest.mark.parametrize(
    "text", ["blur(1px 2px)", "invert(-1)", "blue", "url(#none)", "drop-shadow(1px)", "x(1)", ""]
)
def test_invalid_filters_are_ignored(text):
    element = box(0, 0, 9, 9, f'filter="{text}"')
    actual, warnings = prefilter.rasterize_svg(svg(element), SIZE, SIZE)
    assert [str(each)[:15] for each in warnings] == ["filter: ignored"]
    same(actual[::-1], plain(box(0, 0, 9, 9, "")))


SHAPES = "".join(
    box(x, y, x + w, y + h, f'fill="rgb({r},90,{255 - r})" fill-opacity="{a}"')
    for x, y, w, h, r, a in (
        (3, 5, 40, 30, 20, 1),
        (30, 20, 45, 60, 220, 0.6),
        (5, 70, 90, 9, 99, 0.3),
    )
)
GROUP = f'<g filter="url(#f)">{SHAPES}</g>'
ALL = f'filterUnits="userSpaceOnUse" x="0" y="0" width="100" height="100" {AS_ENCODED}'


def around(image, x, y, mode):
    """A pixel of an image, or its replacement beyond the edges."""
    if mode == "duplicate":
        return image[min(max(y, 0), SIZE - 1), min(max(x, 0), SIZE - 1)]
    if mode == "wrap":
        return image[y % SIZE, x % SIZE]
    return image[y, x] if 0 <= x < SIZE and 0 <= y < SIZE else np.zeros(4)


@pytest.mark.parametrize("operator", ["dilate", "erode"])
def test_morphology(operator):
    actual = drawn(f'<feMorphology operator="{operator}" radius="4 7"/>', GROUP, ALL)
    image = plain(SHAPES)
    pick = np.max if operator == "dilate" else np.min
    for y in range(0, SIZE, 7):
        for x in range(0, SIZE, 7):
            near = [
                around(image, x + dx, y + dy, "none") for dx in range(-4, 5) for dy in range(-7, 8)
            ]
            np.testing.assert_allclose(actual[y, x], pick(near, axis=0), atol=1e-6)
    same(drawn('<feMorphology radius="0"/>', GROUP, ALL), image)
    grown = drawn('<feMorphology operator="dilate" radius="5 3"/>', BOX)
    same(grown, plain(box(25, 17, 65, 53, "")))


@pytest.mark.parametrize("mode", ["duplicate", "wrap", "none"])
@pytest.mark.parametrize("keeps", ["true", "false"])
def test_convolution(mode, keeps):
    weights = np.array([[1, -2, 0.5, 3], [0, 4, -1, 0.25]])
    step = (
        f'<feConvolveMatrix order="4 2" kernelMatrix="{" ".join(map(str, weights.ravel()))}" '
        f'targetX="3" targetY="0" divisor="5" bias="0.125" edgeMode="{mode}" '
        f'preserveAlpha="{keeps}"/>'
    )
    actual = drawn(step, GROUP, ALL)
    image = plain(SHAPES).astype(float)
    straight = image.copy()
    np.divide(image[..., :3], image[..., 3:], out=straight[..., :3], where=image[..., 3:] > 0)
    source = straight if keeps == "true" else image
    for y in (0, 1, 20, 34, 35, 50, 78, 99):
        for x in (0, 1, 3, 29, 43, 60, 75, 98, 99):
            total = sum(
                weights[1 - i, 3 - j] * around(source, x - 3 + j, y + i, mode)
                for i in range(2)
                for j in range(4)
            )
            alpha = image[y, x, 3]
            if keeps == "true":
                expected = np.array([*(np.clip(total[:3] / 5 + 0.125, 0, 1) * alpha), alpha])
            else:
                expected = np.clip(total / 5 + 0.125, 0, 1)
                expected[:3] = np.minimum(expected[:3], expected[3])
            np.testing.assert_allclose(actual[y, x], expected, atol=1e-5)


def test_invalid_convolutions_are_transparent():
    for attributes in ('order="3" kernelMatrix="1 2"', 'order="1.5" kernelMatrix="1"', 'order="0"'):
        assert not drawn(f"<feConvolveMatrix {attributes}/>", BOX).any()
    body = (
        '<filter id="f"><feConvolveMatrix order="30" kernelMatrix="' + "1 " * 900 + '"/></filter>'
    )
    _, (warning,) = prefilter.rasterize_svg(svg(body + BOX), 9, 9)
    assert warning.kind == "unsupported"


def test_tiles():
    steps = '<feFlood x="10" y="20" width="7" height="5" flood-color="teal"/>'
    steps += '<feFlood x="10" y="20" width="3" height="2"/>'
    steps += '<feOffset x="10" y="20" width="7" height="5"/>'
    actual = drawn(f"{steps}<feTile/>", BOX, ALL)
    for y in range(SIZE):
        for x in range(SIZE):
            inside = (x - 10) % 7 < 3 and (y - 20) % 5 < 2
            assert actual[y, x, 3] == inside
    assert not drawn('<feFlood width="0"/><feTile/>', BOX, ALL).any()


def test_subregions_default_to_those_of_inputs():
    steps = '<feFlood x="10" y="10" width="20" height="20" result="a"/><feFlood x="20" y="40" {}'
    move = '<feOffset dx="10"/>'
    actual = drawn(steps.split('<feFlood x="20"')[0] + move, BOX, ALL)
    same(actual, plain(box(20, 10, 30, 30, "")))
    both = steps.format('width="30" height="10" result="b"/>')
    both += '<feMerge result="c"><feMergeNode in="a"/><feMergeNode in="b"/></feMerge>' + move
    same(drawn(both, BOX, ALL), plain(box(20, 10, 40, 30, "") + box(30, 40, 50, 50, "")))


def test_gamma():
    step = (
        '<feComponentTransfer><feFuncB type="gamma" amplitude="0.5" exponent="2.5" offset="0.1"/>'
    )
    actual = drawn(step + "</feComponentTransfer>", FLAT.format("url(#f)"))
    expected = (*COLOR[:2], 0.5 * COLOR[2] ** 2.5 + 0.1, 1)
    np.testing.assert_allclose(actual[50, 50], expected, atol=1e-6)


def test_colors_may_be_inherited():
    rest = f'{ALL} flood-color="teal"'
    same(
        drawn('<feFlood flood-color="inherit"/>', BOX, rest),
        plain(f'<g fill="teal">{box(0, 0, 100, 100, "")}</g>'),
    )
    assert drawn("<feFlood/>", BOX, rest)[5, 5, 1] == 0


def noise_at(x, y, frequency, octaves, seed, fractal):
    """Noise of red to alpha at a position, as in Filter Effects."""

    def following(value):
        value = 16807 * (value % 127773) - 2836 * (value // 127773)
        return value if value > 0 else value + 2147483647

    seed = seed if seed > 0 else -int(math.fmod(seed, 2147483646)) + 1
    lattice, slopes = list(range(256)), []
    for _ in range(4):
        own = []
        for _ in range(256):
            pair = []
            for _ in range(2):
                seed = following(seed)
                pair.append((seed % 512 - 256) / 256)
            own.append(np.array(pair) / math.hypot(*pair))
        slopes.append(own)
    for i in range(255, 0, -1):
        seed = following(seed)
        j = seed % 256
        lattice[i], lattice[j] = lattice[j], lattice[i]
    result = []
    for own in slopes:
        total, u, v, scale = 0.0, x * frequency, y * frequency, 1.0
        for _ in range(octaves):
            i, j = math.floor(u), math.floor(v)
            share = [(s - math.floor(s)) ** 2 * (3 - 2 * (s - math.floor(s))) for s in (u, v)]
            values = []
            for b in (0, 1):
                for a in (0, 1):
                    at = lattice[(lattice[(i + a) % 256] + j + b) % 256]
                    values.append(own[at] @ (u - i - a, v - j - b))
            rows = [values[k] + share[0] * (values[k + 1] - values[k]) for k in (0, 2)]
            value = rows[0] + share[1] * (rows[1] - rows[0])
            total += (value if fractal else abs(value)) / scale
            u, v, scale = 2 * u, 2 * v, 2 * scale
        result.append(min(max((total + 1) / 2 if fractal else total, 0), 1))
    return np.array([*(value * result[3] for value in result[:3]), result[3]])


@pytest.mark.parametrize("seed", [0, 7, -3])
@pytest.mark.parametrize("kind", ["fractalNoise", "turbulence"])
def test_noise(kind, seed):
    step = f'<feTurbulence type="{kind}" baseFrequency="0.07" numOctaves="3" seed="{seed}.9"/>'
    actual = drawn(
        step, f'<g transform="scale(2) translate(-3 0)">{BOX}</g>', f"{WIDE} {AS_ENCODED}"
    )
    for x, y in ((0, 0), (17, 3), (50, 50), (99, 98)):
        expected = noise_at(x / 2 + 3, y / 2, 0.07, 3, seed, kind == "fractalNoise")
        np.testing.assert_allclose(actual[y, x], expected, atol=1e-5)


def test_noise_in_tiles_has_no_seams():
    region = 'filterUnits="userSpaceOnUse" x="20" y="30" width="40" height="32" ' + AS_ENCODED
    step = '<feTurbulence type="fractalNoise" baseFrequency="0.06 0.11" stitchTiles="{}"/>'
    jumps = {}
    for mode in ("stitch", "noStitch"):
        tile = drawn(step.format(mode), BOX, region)[30:62, 20:60].astype(float)
        across, along = np.abs(tile[:, -1] - tile[:, 0]), np.abs(tile[-1] - tile[0])
        jumps[mode] = max(across.max(), along.max())
        inner = max(np.abs(np.diff(tile, axis=0)).max(), np.abs(np.diff(tile, axis=1)).max())
        assert (jumps[mode] <= 1.5 * inner) == (mode == "stitch")


def test_light_on_a_plane():
    flat = box(0, 0, 100, 100)
    tail = "</feDiffuseLighting>"
    for elevation in (0, 30, 90):
        light = f'<feDistantLight azimuth="70" elevation="{elevation}"/>'
        actual = drawn(
            f'<feDiffuseLighting diffuseConstant="0.8" lighting-color="orange">{light}{tail}',
            flat,
            ALL,
        )
        color = np.array([255, 165, 0]) / 255 * 0.8 * math.sin(math.radians(elevation))
        np.testing.assert_allclose(actual[50, 50], (*color, 1), atol=1e-5)
    actual = drawn(f'<feDiffuseLighting diffuseConstant="-1">{light}{tail}', flat, ALL)
    np.testing.assert_array_equal(actual[50, 50], (0, 0, 0, 1))
    light = '<fePointLight x="30" y="40" z="21"/>'
    actual = drawn(f'<feDiffuseLighting surfaceScale="1">{light}{tail}', flat, ALL)
    for x, y in ((10, 10), (30, 40), (90, 70)):
        expected = 20 / math.hypot(30 - x, 40 - y, 20)
        assert actual[y, x, 0] == pytest.approx(expected, abs=1e-5)
    spot = '<feSpotLight x="50" y="50" z="31" pointsAtX="50" pointsAtY="50" '
    spot += 'limitingConeAngle="45" specularExponent="3"/>'
    actual = drawn(f"<feDiffuseLighting>{spot}{tail}", flat, ALL)
    for x in (50, 60, 70):
        cosine = 30 / math.hypot(x - 50, 30)
        assert actual[50, x, 0] == pytest.approx(cosine**4, abs=1e-5)
    np.testing.assert_array_equal(actual[50, 95], (0, 0, 0, 1))


def test_light_on_a_slope():
    """Alpha rises by a fifth over ten pixels, so that the surface rises by 0.1 per pixel."""
    slope = (
        '<linearGradient id="g" gradientUnits="userSpaceOnUse" x1="0" x2="100">'
        '<stop stop-opacity="0"/><stop offset="1"/></linearGradient>'
    )
    element = slope + box(0, 0, 100, 100, 'fill="url(#g)" filter="url(#f)"')
    light = '<feDistantLight azimuth="180" elevation="60"/>'
    to_light = np.array([-0.5, 0, math.sqrt(0.75)])
    # The recommendation takes differences of pixels two apart.
    normal = np.array([-10 * 0.02, 0, 1]) / math.hypot(10 * 0.02, 1)
    actual = drawn(
        f'<feDiffuseLighting surfaceScale="10">{light}</feDiffuseLighting>', element, ALL
    )
    for x in (0, 1, 50, 98, 99):
        assert actual[50, x, 0] == pytest.approx(normal @ to_light, abs=0.002)
    half = to_light + np.array([0, 0, 1])
    shine = 0.9 * (normal @ half / math.sqrt(half @ half)) ** 20
    actual = drawn(
        f'<feSpecularLighting surfaceScale="10" specularConstant="0.9" specularExponent="20" '
        f'lighting-color="red">{light}</feSpecularLighting>',
        element,
        ALL,
    )
    np.testing.assert_allclose(actual[50, 50], (shine, 0, 0, shine), atol=0.005)


@pytest.mark.parametrize("kind", ["Diffuse", "Specular"])
def test_light_is_the_same_at_every_size(kind):
    """Slopes belong to the drawing, not to its pixels."""
    slope = (
        '<linearGradient id="g" gradientUnits="userSpaceOnUse" x1="0" x2="100">'
        '<stop stop-opacity="0"/><stop offset="1"/></linearGradient>'
    )
    for light in (
        '<feDistantLight azimuth="200" elevation="50"/>',
        '<fePointLight x="20" y="50" z="40"/>',
        '<feSpotLight x="20" y="50" z="40" pointsAtX="70" pointsAtY="60"/>',
    ):
        step = f'<fe{kind}Lighting surfaceScale="20">{light}</fe{kind}Lighting>'
        body = f'<filter id="f" {ALL}>{step}</filter>{slope}'
        body += box(0, 0, 100, 100, 'fill="url(#g)" filter="url(#f)"')
        one, other = (
            prefilter.rasterize_svg(svg(body), size, size)[0] for size in (SIZE, 3 * SIZE)
        )
        # Positions of lights count from corners of pixels, which is half a pixel off at most.
        np.testing.assert_allclose(one[30:70, 30:70], other[91:211:3, 91:211:3], atol=0.02)


def test_numbers_of_lights_are_as_in_browsers():
    """Shininess is limited to [1, 128], and a cone of 0 counts as missing."""

    def lit(shininess, more):
        light = f'<feSpotLight x="50" y="50" z="30" pointsAtX="60" pointsAtY="50" {more}/>'
        return drawn(
            f'<feSpecularLighting specularExponent="{shininess}">{light}</feSpecularLighting>', BOX
        )

    for one, other in (("0", "1"), ("-5", "1"), ("0.5", "1"), ("1000", "128")):
        same(lit(one, ""), lit(other, ""))
        same(lit("2", f'specularExponent="{one}"'), lit("2", f'specularExponent="{other}"'))
    same(lit("2", 'limitingConeAngle="0"'), lit("2", ""))
    assert lit("2", "").any()


def test_blur_function_needs_a_unit():
    actual, (warning,) = prefilter.rasterize_svg(svg(FLAT.format("blur(5)")), SIZE, SIZE)
    assert warning.kind == "broken"
    same(actual[::-1], functions("none"))
    same(functions("blur(0)"), functions("none"))


def test_missing_lights_and_images_are_transparent():
    for step in ("<feDiffuseLighting/>", "<feTurbulence numOctaves='0'/>"):
        assert not drawn(step, BOX).any()
    body = f'<filter id="f"><feImage href="x.png"/></filter>{BOX}'
    actual, warnings = prefilter.rasterize_svg(svg(body), SIZE, SIZE)
    assert len(warnings) == 1
    assert not actual.any()


def test_feimage_of_elements_and_files():
    tree = '<defs><g id="e"><circle cx="20" cy="30" r="9" fill="teal"/></g></defs>'
    rest = 'filterUnits="userSpaceOnUse" x="5" y="10" width="90" height="80"'
    actual = drawn('<feImage href="#e"/>', tree + BOX, rest)
    same(actual, plain('<circle cx="25" cy="40" r="9" fill="teal"/>'))
    pillow = pytest.importorskip("PIL.Image")
    file = io.BytesIO()
    pixels = np.random.default_rng(4).integers(0, 256, (5, 8, 4), np.uint8)
    pillow.fromarray(pixels).save(file, "png")
    address = "data:image/png;base64," + base64.b64encode(file.getvalue()).decode()
    for more in ("", 'image-rendering="pixelated"'):
        place = f'href="{address}" x="20" y="30" width="40" height="20" {more}'
        actual = drawn(f"<feImage {place}/>", BOX, ALL)
        np.testing.assert_allclose(actual, plain(f"<image {place}/>"), atol=2e-6)


def test_circular_feimage_is_ignored():
    body = '<filter id="f"><feImage href="#r"/></filter><g id="r">' + BOX + "</g>"
    actual, (warning,) = prefilter.rasterize_svg(svg(body), SIZE, SIZE)
    assert warning.name == "filter"
    same(actual[::-1], plain(box(30, 20, 60, 50, "")))


@pytest.mark.parametrize("turn", ["rotate(30 50 50)", "rotate(-45 50 50)", "skewX(30)"])
def test_filters_rotate_with_their_element(turn):
    group = f'<g transform="{turn}">{{}}</g>'
    rest = f'filterUnits="userSpaceOnUse" x="25" y="25" width="40" height="30" {AS_ENCODED}'
    same(drawn("<feFlood/>", group.format(BOX), rest), plain(group.format(box(25, 25, 65, 55, ""))))
    moved = drawn('<feOffset dx="10" dy="5"/>', group.format(BOX))
    expected = plain(group.format(box(40, 25, 70, 55, "")))
    assert np.abs(moved - expected).mean() < 0.004
    assert np.abs(moved - expected).max() < 0.35
    # An isotropic blur does not depend on rotation.
    if turn.startswith("rotate"):
        element = f'<g transform="{turn}"><circle cx="45" cy="55" r="20" filter="url(#f)"/></g>'
        step = '<feGaussianBlur stdDeviation="4"/>'
        angle = math.radians(float(turn[7:].split()[0]))
        x = 50 + math.cos(angle) * (-5) - math.sin(angle) * 5
        y = 50 + math.sin(angle) * (-5) + math.cos(angle) * 5
        other = f'<circle cx="{x}" cy="{y}" r="20" filter="url(#f)"/>'
        np.testing.assert_allclose(drawn(step, element), drawn(step, other), atol=0.015)


def test_colors_of_nearly_transparent_pixels():
    from prefilter.shapes._svg.filters.evaluation import apply_filter
    from prefilter.shapes._svg.model.tree import Filter, Group, Step

    def blurred(pixels):
        identity = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0)
        blur = Step("feGaussianBlur", ("SourceGraphic",), "", (1.0, 1.0), "", True, None)
        filter_ = Filter((blur,), None, identity, is_linear=False)
        return apply_filter(lambda _: pixels, Group([]), filter_, identity, (0, 0, 7, 6))

    clean = np.zeros((6, 7, 4), np.float32)
    clean[4, 5] = 0.1, 0.2, 0.3, 0.4
    noisy = clean.copy()
    noisy[2, 2] = -4.2e-13, -3.6e-12, 4.5e-12, 7.1e-26
    np.testing.assert_allclose(blurred(noisy), blurred(clean), atol=1e-6)


@pytest.mark.parametrize(
    "steps",
    [
        '<feMorphology radius="1e300"/><feMorphology radius="-1 2 3" operator="x"/>',
        '<feTurbulence baseFrequency="1e300 1e-300" numOctaves="1e9" seed="1e300"/>',
        '<feTurbulence baseFrequency="nan" stitchTiles="stitch"/><feTile/>',
        '<feSpecularLighting specularExponent="128" surfaceScale="1e300"><feSpotLight '
        'specularExponent="1e300" limitingConeAngle="-1e300" z="1e300"/></feSpecularLighting>',
        '<feDiffuseLighting diffuseConstant="1e300"><fePointLight x="1e300"/></feDiffuseLighting>',
        '<feComponentTransfer><feFuncA type="gamma" amplitude="1e300" exponent="-9" offset="-1"/>'
        "</feComponentTransfer>",
        '<feConvolveMatrix order="1" kernelMatrix="1e300" bias="-1e300"/><feImage href="data:,"/>',
    ],
    ids=lambda steps: steps[:30],
)
def test_odd_primitives(steps):
    for rest in ("", WIDE, 'width="0"', 'primitiveUnits="objectBoundingBox"'):
        for turn in ("", "rotate(33)", "matrix(1 1 1 1.000001 0 0)", "scale(1e-9)"):
            body = f'<filter id="f" {rest}>{steps}</filter><g transform="{turn}">{BOX}</g>'
            actual, _ = prefilter.rasterize_svg(svg(body), 16, 16)
            assert np.isfinite(actual).all()
