# SPDX-License-Identifier: GPL-3.0-or-later

"""OSL source: a shader that reads texels from files, one file per level."""

from string import Template

from .table_numbers import Table, TableNumbers, checked_name, commented, number, wrapped

_ABOUT = """
Samples a texture at any scale from $texels texels of its mipmap, by a table for the filter
"$target": $about.

Written by Prefilter. Prefilter's license does not extend to this text: use, change and pass it
on as you like. It comes without any warranty.

Every level is a picture file of its own, named Levels, number, Extension: wood.0.exr, wood.1.exr
and so on, level 0 first. OSL has no way to ask for a level of one file, so that is what works
in every renderer. The levels must be those that
prefilter.sampling_levels(image, filter="$filter") makes, of a picture of any size up to
$most_texels x $most_texels. Files should be scene-linear, with premultiplied alpha; texels are
read as the renderer decodes them.

  Levels     the files' names up to the number, with their folder: "/textures/wood."
  Extension  what follows the number
  Width      the size of the picture, in texels of level 0. Without it the result is magenta
  Height
  Count      how many levels there are; 0: down to 1 x 1
  Flip       whether t = 0 is the top of a picture for texture(): 1, as it is in OpenImageIO.
             0 for Blender 5.2, whose Cycles has it at the bottom
  Vector     u and v; (0, 0) is the lower left corner of the picture, (1, 1) the upper right
  Scale      the width of the filter's unit (a pixel, usually) in texels of level 0; 0: from how
             u and v change from pixel to pixel, by the longer axis of the pixel's footprint
  WrapU      texels beside the picture: 0 its nearest texel, 1 the picture again, 2 zero
  WrapV      the same for texels below and above it
"""

_SHADER = """
struct ${name}_Level {
  int number;
  int width;
  int height;
  float columns;  // how many of its texels the picture takes
  float rows;
  int x;  // the texel that an offset of 0 and 0 is packed for
  int y;
};

${name}_Level ${name}_level(int number, int width, int height, float u, float v,
    float x, float y, int mirror_x, int mirror_y, int cell)
{
  ${name}_Level level;
  level.number = max(number, 0);
  float texel = 1 << level.number;
  level.columns = width / texel;
  level.rows = height / texel;
  level.width = (int)ceil(level.columns);
  level.height = (int)ceil(level.rows);
  level.x = (int)floor(u * level.columns - cell * x + 0.5) - 64 + (mirror_x & (128 + cell));
  level.y = (int)floor(v * level.rows - cell * y + 0.5) - 64 + (mirror_y & (128 + cell));
  return level;
}

int ${name}_wrap(int i, int size, float extent, int wrap)
{
  int read = i;
  if (wrap == 1 && (i < 0 || i >= size)) {
    float x = i + 0.5;
    read = (int)(x - floor(x / extent) * extent);
  }
  return clamp(read, 0, size - 1);
}

// One call for each file: Cycles wants to know all names before it renders.
color ${name}_read(string levels, string extension, int level, float s, float t,
    output float alpha)
{
  color found = 0;
  alpha = 1;
$reads
  return found;
}

shader $name(
    string Levels = "",
    string Extension = ".exr",
    int Width = 0,
    int Height = 0,
    int Count = 0,
    int Flip = 1,
    point Vector = point(u, v, 0),
    float Scale = 0,
    int WrapU = 1,
    int WrapV = 1,
    output color Color = 0,
    output float Alpha = 0)
{
  int offsets[$rows] = {
$offsets};
  float coefficients[$numbers] = {
$coefficients};

  if (Width < 1 || Height < 1) {
    Color = color(1, 0, 1);
    Alpha = 1;
    return;
  }
  int last = min(Count, $most_levels) - 1;
  if (Count < 1) {
    for (last = 0; (1 << last) < max(Width, Height); ++last) {
    }
  }

  float scale = Scale;
  if (scale <= 0) {
    // The larger singular value of the pixel's Jacobian.
    vector a = Dx(Vector) * vector(Width, Height, 0);
    vector b = Dy(Vector) * vector(Width, Height, 0);
    float half_sum = 0.5 * (dot(a, a) + dot(b, b));
    scale = sqrt(half_sum + hypot(0.5 * (dot(a, a) - dot(b, b)), dot(a, b)));
  }
  float mip = clamp(log2(max(scale, 1)), 0, last);
  int cell_level = (int)ceil(mip);
  float f = mip - max(cell_level - 1, 0);

  // Farther out nothing changes, and whole numbers stay small.
  float s = clamp(WrapU == 1 ? Vector[0] - floor(Vector[0]) : Vector[0], -128, 129);
  float t = clamp(WrapV == 1 ? Vector[1] - floor(Vector[1]) : Vector[1], -128, 129);
  float x = s * Width / (1 << cell_level);
  float y = t * Height / (1 << cell_level);
  x -= floor(x);
  y -= floor(y);
  int mirror_x = x > 0.5 ? -1 : 0;
  int mirror_y = y > 0.5 ? -1 : 0;
  ${name}_Level levels[3];
  for (int finer = 0; finer < 3; ++finer) {
    levels[finer] = ${name}_level(cell_level - finer, Width, Height, s, t, x, y, mirror_x,
        mirror_y, 1 << finer);
  }

  float folded_x = 0.5 - abs(x - 0.5);
  float folded_y = 0.5 - abs(y - 0.5);
  int shift_x = folded_y > folded_x ? 8 : 0;
  float p = max(folded_x, folded_y);
  float q = min(folded_x, folded_y);
  int slice = clamp((int)(f * $slices), 0, $last_slice);
  int i = clamp((int)(p * $grid), 0, $last_column);
  int j = clamp((int)(q * $grid), 0, i);
  int section = cell_level == 0 ? 0 : (cell_level == 1 ? 1 : 1 + $slices);
  if (cell_level == 0) {
    f = p * q;
  }
  int row = $texels * ((section + slice) * $subdomains_of_slice + i * (i + 1) / 2 + j);

  Color = 0;
  Alpha = 0;
  for (int texel = row; texel < row + $texels; ++texel) {
    ${name}_Level level = levels[offsets[texel] >> 16];
    int at_x = (((offsets[texel] >> shift_x) & 255) ^ mirror_x) + level.x;
    int at_y = (((offsets[texel] >> (8 - shift_x)) & 255) ^ mirror_y) + level.y;
    int read_x = ${name}_wrap(at_x, level.width, level.columns, WrapU);
    int read_y = ${name}_wrap(at_y, level.height, level.rows, WrapV);
    if ((WrapU != 2 || read_x == at_x) && (WrapV != 2 || read_y == at_y)) {
      int term = $terms * texel;
$weight
      float alpha;
      float up = (read_y + 0.5) / level.height;
      color read = ${name}_read(Levels, Extension, level.number, (read_x + 0.5) / level.width,
          Flip ? 1 - up : up, alpha);
      Color += weight * read;
      Alpha += weight * alpha;
    }
  }
}
"""

_READ = """\
  if (level == $level) {
    found = texture(concat(levels, "$level", extension), s, t, 0, 0, 0, 0, "interp", "closest",
        "wrap", "clamp", "alpha", alpha);
  }"""
_MOST_LEVELS = 17

# In the order of the terms (sampling_table.h).
_MONOMIALS = ("1", "p", "q", "f", "p * p", "q * q", "f * f", "p * q", "p * f", "q * f")


def osl(table: Table, name: str) -> str:
    """Returns OSL of a shader called `name`."""
    numbers = TableNumbers.of(table)
    terms = numbers.coefficients.shape[1]
    weight = " +\n          ".join(
        f"coefficients[term + {term}] * {_MONOMIALS[term]}".removesuffix(" * 1")
        for term in range(terms)
    )
    words = {
        **numbers.constants(),
        "name": checked_name(name),
        "filter": numbers.filter,
        "target": numbers.target,
        "about": numbers.about(),
        "numbers": numbers.coefficients.size,
        "terms": terms,
        "offsets": wrapped(str(offset) for offset in numbers.offsets),
        "coefficients": wrapped(map(number, numbers.coefficients.ravel())),
        "most_levels": _MOST_LEVELS,
        "most_texels": 2 ** (_MOST_LEVELS - 1),
        "reads": "\n".join(Template(_READ).substitute(level=k) for k in range(_MOST_LEVELS)),
        "weight": f"      float weight = {weight};",
    }
    return "\n".join(
        [commented(Template(_ABOUT).substitute(words)), Template(_SHADER).substitute(words)]
    )
