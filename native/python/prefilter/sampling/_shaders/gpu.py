# SPDX-License-Identifier: GPL-3.0-or-later

"""GLSL and HLSL source: one text, as the languages differ only in the names of types."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from string import Template

import numpy as np

from .table_numbers import Table, TableNumbers, checked_name, commented, number, wrapped

_ABOUT = """
Samples a texture at any scale from $texels texels of its mipmap, by a table for the filter
"$target": $about.

Written by Prefilter. Prefilter's license does not extend to this text: use, change and pass it
on as you like. It comes without any warranty.

The levels must be those that prefilter.sampling_levels(image, filter="$filter") makes, and
the sides of the texture powers of two. Graphics cards round the sides of other levels down:
prefilter.mipmaps(image, filter="$filter", bounds=None) makes these, and they gain less. Colors
are filtered as the texture's format decodes them, so sRGB formats are filtered in linear light;
alpha must be premultiplied. No sampler state matters.

  vec4 ${name}_sample($texture levels, vec2 uv, float mip_value)
  vec4 ${name}_sample($texture levels, vec2 uv, float mip_value, ivec2 wrap)
    The filtered color at uv, where (0, 0) and (1, 1) are corners of the image. mip_value is log2
    of the width of the filter's unit (a pixel, usually) in texels of level 0; at 0 and below,
    the texture is magnified. wrap gives the texels outside the image, for u and v:
    ${upper}_CLAMP (its nearest texel, the default), ${upper}_REPEAT, or
    ${upper}_BORDER (zero).

  float ${name}_mip_value($texture levels, vec2 duv_dx, vec2 duv_dy)
    The mip value of a pixel, given how uv changes along it and up it: $derivatives
    in fragment shaders, ray differentials elsewhere. It goes by the longer axis of the pixel's
    footprint.

  ivec3 ${name}_pick($texture levels, vec2 uv, float mip_value, ivec2 wrap,
      float number, out float weight)
    One of the $texels texels, for filtering after shading: its x, y and level. What is shaded with
    it counts `weight` times. number is uniform in [0, 1); the mean over it is the filtered
    value. The weight is negative for texels that the filter subtracts, and 0 in the border.

To read texels in another way (from an array, an atlas, a buffer), define these before this
text; the functions then have no parameter `levels`, and the image may have any sides:
  ${upper}_FETCH(level, texel)  the color of a texel; an int, and an ivec2 inside the level
  ${upper}_SIZE(level)          an ivec2: the sides of a level, as sampling_levels has it
  ${upper}_LEVELS               an int: how many levels there are
$language_note
"""

_GLSL_NOTE = """\
GLSL 3.30 or ES 3.00 and later. ${upper}_LEVELS alone may be defined too, where there are fewer
levels than down to 1 x 1 and GLSL is older than 4.30."""

_HLSL_NOTE = "Shader model 4.0 and later."

_GLSL_TEXTURE = """
#ifdef GL_ES
precision highp float;
precision highp int;
precision highp sampler2D;
#endif

#ifdef ${upper}_FETCH
#define ${upper}_PARAMETER
#define ${upper}_ARGUMENT
#define ${upper}_EXTENT(level) (vec2(${upper}_SIZE(0)) / float(1 << (level)))
#else
#define ${upper}_OWN_TEXTURE
#define ${upper}_PARAMETER sampler2D levels,
#define ${upper}_ARGUMENT levels,
#define ${upper}_FETCH(level, texel) texelFetch(levels, texel, level)
// Mesa's llvmpipe takes the sizes of neighboring pixels' levels for each other.
#define ${upper}_SIZE(level) max(textureSize(levels, 0) >> (level), 1)
#define ${upper}_EXTENT(level) ${name}_extent(textureSize(levels, 0), level)
#ifndef ${upper}_LEVELS
#define ${upper}_OWN_LEVELS
#ifdef GL_ES
#define ${upper}_LEVELS ${name}_level_count(textureSize(levels, 0))
#elif __VERSION__ >= 430
#define ${upper}_LEVELS textureQueryLevels(levels)
#else
#define ${upper}_LEVELS ${name}_level_count(textureSize(levels, 0))
#endif
#endif

// Half a texel more keeps logarithms that are rounded down away from whole numbers.
int ${name}_level_count(ivec2 size)
{
  return 1 + int(log2(float(max(size.x, size.y)) + 0.5));
}
#endif
"""

_HLSL_TEXTURE = """
#ifdef ${upper}_FETCH
#define ${upper}_PARAMETER
#define ${upper}_ARGUMENT
#define ${upper}_EXTENT(level) (vec2(${upper}_SIZE(0)) / float(1 << (level)))
#else
#define ${upper}_OWN_TEXTURE
#define ${upper}_OWN_LEVELS
#define ${upper}_PARAMETER Texture2D<float4> levels,
#define ${upper}_ARGUMENT levels,
#define ${upper}_FETCH(level, texel) levels.Load(int3(texel, level))
#define ${upper}_SIZE(level) max(${name}_size(levels).xy >> (level), 1)
#define ${upper}_EXTENT(level) ${name}_extent(${name}_size(levels).xy, level)
#define ${upper}_LEVELS ${name}_size(levels).z

int3 ${name}_size(Texture2D<float4> levels)
{
  uint width, height, count;
  levels.GetDimensions(0, width, height, count);
  return int3(width, height, count);
}
#endif
"""

_BODY = """
// How many texels of a level the image takes. Rounded down, a level is spread over the image.
#ifdef ${upper}_OWN_TEXTURE
vec2 ${name}_extent(ivec2 size, int level)
{
  ivec2 uneven = size & (size - 1);  // 0 for powers of two
  vec2 nested = vec2(size) / float(1 << level);
  vec2 spread = vec2(max(size >> level, 1));
  return vec2(uneven.x == 0 ? nested.x : spread.x, uneven.y == 0 ? nested.y : spread.y);
}
#endif

#define ${upper}_CLAMP 0
#define ${upper}_REPEAT 1
#define ${upper}_BORDER 2

// Where a sample lies.
struct ${name}_Place {
  int row;        // of the table: that of the first of its texels
  int level;      // of the cell: the coarser one of the two levels around the mip value
  vec3 inside;    // x and y in the cell, folded to 0 <= y <= x <= 1/2, and f from level to level;
                  // where the texture is magnified, x y for f
  ivec2 shifts;   // where x and y of an offset are packed: they change places across the diagonal
  ivec2 mirror;   // all bits where x or y was folded: ~i is -1 - i
  ivec4 level_0;  // of the cell's level and the two finer ones: the texel that an offset of 0 and 0
  ivec4 level_1;  // is packed for, and the last texel
  ivec4 level_2;
};

ivec4 ${name}_level(${upper}_PARAMETER vec2 uv, vec2 x, ivec2 mirror, int level, int finer)
{
  int available = max(level - finer, 0);
  int cell = 1 << finer;
  ivec2 corner = ivec2(floor(uv * ${upper}_EXTENT(available) - float(cell) * x + 0.5));
  return ivec4(corner - 64 + (mirror & (128 + cell)), ${upper}_SIZE(available) - 1);
}

${name}_Place ${name}_find(${upper}_PARAMETER vec2 uv, float mip_value, ivec2 wrap)
{
  ${name}_Place place;
  float mip = clamp(mip_value, 0.0, float(${upper}_LEVELS - 1));
  place.level = int(ceil(mip));
  float f = mip - float(max(place.level - 1, 0));

  // Farther out nothing changes, and whole numbers stay small.
  vec2 at = clamp(vec2(wrap.x == ${upper}_REPEAT ? uv.x - floor(uv.x) : uv.x,
                       wrap.y == ${upper}_REPEAT ? uv.y - floor(uv.y) : uv.y), -128.0, 129.0);
  vec2 x = at * ${upper}_EXTENT(place.level);
  x -= floor(x);
  place.mirror = ivec2(x.x > 0.5 ? -1 : 0, x.y > 0.5 ? -1 : 0);
  vec2 folded = 0.5 - abs(x - 0.5);
  place.shifts = folded.y > folded.x ? ivec2(8, 0) : ivec2(0, 8);
  place.inside = vec3(max(folded.x, folded.y), min(folded.x, folded.y),
                      place.level == 0 ? folded.x * folded.y : f);

  place.level_0 = ${name}_level(${upper}_ARGUMENT at, x, place.mirror, place.level, 0);
  place.level_1 = ${name}_level(${upper}_ARGUMENT at, x, place.mirror, place.level, 1);
  place.level_2 = ${name}_level(${upper}_ARGUMENT at, x, place.mirror, place.level, 2);

  int slice = clamp(int(f * $slices.0), 0, $last_slice);
  int i = clamp(int(place.inside.x * $grid.0), 0, $last_column);
  int j = clamp(int(place.inside.y * $grid.0), 0, i);
  int section = place.level == 0 ? 0 : (place.level == 1 ? 1 : 1 + $slices);
  place.row = $texels * ((section + slice) * $subdomains_of_slice + i * (i + 1) / 2 + j);
  return place;
}

float ${name}_weight(${name}_Place place, int texel)
{
  int row = place.row + texel;
  vec3 p = place.inside;
$weight
}

int ${name}_wrap(int i, int last, float extent, int wrap)
{
  float x = float(i) + 0.5;
  bool repeated = wrap == ${upper}_REPEAT && (i < 0 || i > last);
  return clamp(repeated ? int(x - floor(x / extent) * extent) : i, 0, last);
}

// x, y and level of a texel, and 0 for `inside` if it lies in a border of zeros, else 1.
ivec3 ${name}_texel(${upper}_PARAMETER ${name}_Place place, int texel, ivec2 wrap,
    out float inside)
{
  int offset = ${name}_offsets[place.row + texel];
  int finer = offset >> 16;
  ivec4 level = finer == 0 ? place.level_0 : (finer == 1 ? place.level_1 : place.level_2);
  ivec2 at = ivec2((offset >> place.shifts.x) & 255, (offset >> place.shifts.y) & 255);
  at = (at ^ place.mirror) + level.xy;
  vec2 extent = ${upper}_EXTENT(place.level - finer);
  ivec2 read = ivec2(${name}_wrap(at.x, level.z, extent.x, wrap.x),
                     ${name}_wrap(at.y, level.w, extent.y, wrap.y));
  bool outside = (wrap.x == ${upper}_BORDER && read.x != at.x) ||
                 (wrap.y == ${upper}_BORDER && read.y != at.y);
  inside = outside ? 0.0 : 1.0;
  return ivec3(read, place.level - finer);
}

vec4 ${name}_sample(${upper}_PARAMETER vec2 uv, float mip_value, ivec2 wrap)
{
  ${name}_Place place = ${name}_find(${upper}_ARGUMENT uv, mip_value, wrap);
  vec4 sum = vec4(0.0, 0.0, 0.0, 0.0);
  for (int i = 0; i < $texels; ++i) {
    float inside;
    ivec3 texel = ${name}_texel(${upper}_ARGUMENT place, i, wrap, inside);
    sum += inside * ${name}_weight(place, i) * ${upper}_FETCH(texel.z, texel.xy);
  }
  return sum;
}

vec4 ${name}_sample(${upper}_PARAMETER vec2 uv, float mip_value)
{
  ivec2 wrap = ivec2(${upper}_CLAMP, ${upper}_CLAMP);
  return ${name}_sample(${upper}_ARGUMENT uv, mip_value, wrap);
}

// log2 of the larger singular value of the pixel's Jacobian, in texels of level 0.
float ${name}_mip_value(${upper}_PARAMETER vec2 duv_dx, vec2 duv_dy)
{
  vec2 size = vec2(${upper}_SIZE(0));
  vec2 a = duv_dx * size;
  vec2 b = duv_dy * size;
  float p = 0.5 * (dot(a, a) + dot(b, b));
  vec2 q = vec2(0.5 * (dot(a, a) - dot(b, b)), dot(a, b));
  return 0.5 * log2(max(p + length(q), 1e-30));
}

ivec3 ${name}_pick(${upper}_PARAMETER vec2 uv, float mip_value, ivec2 wrap, float number,
    out float weight)
{
  ${name}_Place place = ${name}_find(${upper}_ARGUMENT uv, mip_value, wrap);
  float total = 0.0;
  for (int i = 0; i < $texels; ++i) {
    total += abs(${name}_weight(place, i));
  }
  float before = 0.0;
  int picked = 0;
  float sign_of_picked = 1.0;
  for (int i = 0; i < $texels; ++i) {
    float w = ${name}_weight(place, i);
    bool later = before <= number * total && w != 0.0;
    picked = later ? i : picked;
    sign_of_picked = later ? (w < 0.0 ? -1.0 : 1.0) : sign_of_picked;
    before += abs(w);
  }
  float inside;
  ivec3 texel = ${name}_texel(${upper}_ARGUMENT place, picked, wrap, inside);
  weight = inside * sign_of_picked * total;
  return texel;
}

#ifdef ${upper}_OWN_TEXTURE
#undef ${upper}_OWN_TEXTURE
#undef ${upper}_FETCH
#undef ${upper}_SIZE
#endif
#ifdef ${upper}_OWN_LEVELS
#undef ${upper}_OWN_LEVELS
#undef ${upper}_LEVELS
#endif
#undef ${upper}_PARAMETER
#undef ${upper}_ARGUMENT
#undef ${upper}_EXTENT
"""

# Terms of a polynomial (sampling_table.h) grouped into vectors, and the vectors of monomials.
_LINEAR = ("linear", slice(0, 4), "vec4(1.0, p)")
_SQUARES = ("squares", slice(4, 8), "vec4(p * p, p.x * p.y)")
_PRODUCTS = ("products", slice(8, 10), "(p.xy * p.z)")
_GROUPS = {1: (_LINEAR,), 2: (_LINEAR, _SQUARES, _PRODUCTS)}


@dataclass(frozen=True)
class _Language:
    texture_type: str
    derivatives: str
    note: str
    texture: str
    array: str
    translated: Callable[[str], str]


def _hlsl_words(text: str) -> str:
    return re.sub(r"\b(i?)vec([234])\b", lambda m: f"{'int' if m[1] else 'float'}{m[2]}", text)


_GLSL = _Language(
    texture_type="sampler2D",
    derivatives="dFdx(uv) and dFdy(uv)",
    note=_GLSL_NOTE,
    texture=_GLSL_TEXTURE,
    array="const $type ${name}_$array[$size] = $type[$size](\n$items);\n",
    translated=str,
)
_HLSL = _Language(
    texture_type="Texture2D<float4>",
    derivatives="ddx(uv) and ddy(uv)",
    note=_HLSL_NOTE,
    texture=_HLSL_TEXTURE,
    array="static const $type ${name}_$array[$size] = {\n$items};\n",
    translated=_hlsl_words,
)


def glsl(table: Table, name: str) -> str:
    """Returns GLSL whose identifiers begin with `name`."""
    return _source(table, name, _GLSL)


def hlsl(table: Table, name: str) -> str:
    """Returns HLSL whose identifiers begin with `name`."""
    return _source(table, name, _HLSL)


def _source(table: Table, name: str, language: _Language) -> str:
    numbers = TableNumbers.of(table)
    groups = _GROUPS[numbers.degree]
    terms = [f"dot(${{name}}_{group}[row], {factors})" for group, _, factors in groups]
    names = {"name": checked_name(name), "upper": name.upper()}
    words = {
        **names,
        **numbers.constants(),
        "filter": numbers.filter,
        "target": numbers.target,
        "about": numbers.about(),
        "texture": language.texture_type,
        "derivatives": language.derivatives,
        "language_note": Template(language.note).substitute(names),
        "weight": Template("  return " + " +\n         ".join(terms) + ";").substitute(names),
    }

    def array(identifier: str, kind: str, items: list[str]) -> str:
        return Template(language.array).substitute(
            name=name, array=identifier, type=kind, size=len(items), items=wrapped(items)
        )

    arrays = [array("offsets", "int", [str(offset) for offset in numbers.offsets])]
    for group, terms_of_group, _ in groups:
        rows: list[list[np.float32]] = list(map(list, numbers.coefficients[:, terms_of_group]))
        kind = f"vec{len(rows[0])}"
        arrays.append(
            array(group, kind, [f"{kind}({', '.join(map(number, row))})" for row in rows])
        )
    return "\n".join(
        [
            language.translated(commented(Template(_ABOUT).substitute(words))),
            language.translated(Template(language.texture).substitute(words)),
            *[language.translated(text) for text in arrays],
            language.translated(Template(_BODY).substitute(words).lstrip("\n")),
        ]
    )
