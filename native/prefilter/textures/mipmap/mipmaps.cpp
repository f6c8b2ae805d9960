// SPDX-License-Identifier: GPL-3.0-or-later

// Chapter 7. SurfaceFilter::kBox is equation 7.1 with a box. The texels of the image are boxes too,
// so a uniform parameterization yields the plain box filter.
#include "prefilter/textures/mipmaps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/geometry/texels/texel_triangles.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/textures/mipmap/argument_checks.h"
#include "prefilter/textures/mipmap/bilinear_system.h"
#include "prefilter/textures/mipmap/fitted_levels.h"
#include "prefilter/textures/mipmap/pam_box.h"
#include "prefilter/textures/mipmap/seam_links.h"
#include "prefilter/textures/mipmap/texture_space.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

// The image texels that a filter reads.
enum class Reads { kAll, kTouched, kWeighted, kLookedUp };

Reads reads_of(const MipmapFilter& filter) {
  if (const auto* in_texture = std::get_if<TextureSpaceFilter>(&filter)) {
    return in_texture->weighting == Weighting::kAll ? Reads::kAll : Reads::kTouched;
  }
  return is_fit(filter) ? Reads::kLookedUp : Reads::kWeighted;
}

std::optional<int> alpha_channel(int channels, bool premultiplied) {
  return channels == 4 && !premultiplied ? std::optional(3) : std::nullopt;
}

// Whether the filter needs more than one pass over the unmodified texels.
bool needs_floats(const MipmapOptions& options) {
  switch (reads_of(options.filter)) {
    case Reads::kAll:
    case Reads::kTouched:
      return true;
    case Reads::kWeighted:
      return false;
    case Reads::kLookedUp:
      break;
  }
  return options.reader != Reader::kLinear || options.seam_budget != 0.0 ||
         options.footprint != 0.0;
}

TexelTriangles mapped(const std::vector<const Surface*>& surfaces, const TexelSource& image,
                      const MipmapOptions& options, const Run& run) {
  TexelTriangles triangles =
      map_to_texels(surfaces, image.width, image.height, options.wrap, MassOf::kArea, run);
  check_mapped(triangles);
  return triangles;
}

std::vector<unsigned char> covered_texels(const std::vector<const Surface*>& surfaces,
                                          const TexelSource& image, const MipmapOptions& options,
                                          const Run& run) {
  std::vector<unsigned char> covered =
      touched_texels(surfaces, image.width, image.height, options.wrap, run);
  if (std::find(covered.begin(), covered.end(), 1) == covered.end()) throw_outside();
  return covered;
}

// 1 for each texel that the filter reads. `covered` are the touched texels, for filters that read
// those.
std::vector<unsigned char> read_texels(const std::vector<const Surface*>& surfaces,
                                       const TexelSource& image,
                                       const std::vector<unsigned char>& covered,
                                       const MipmapOptions& options, const Run& run) {
  switch (reads_of(options.filter)) {
    case Reads::kAll:
      break;
    case Reads::kTouched:
      return covered;
    case Reads::kWeighted: {
      const Stages stages(run, {3, 7});
      const std::vector<float> masses =
          texel_masses(mapped(surfaces, image, options, stages[0]), stages[1]);
      std::vector<unsigned char> read(masses.size());
      for (std::size_t i = 0; i < masses.size(); ++i) read[i] = masses[i] > 0.0F ? 1 : 0;
      return read;
    }
    case Reads::kLookedUp:
      return looked_up_texels(surfaces, image.width, image.height, options.wrap, run);
  }
  return std::vector<unsigned char>(static_cast<std::size_t>(image.width) * image.height, 1);
}

// `covered` are the texels to filter; empty for all.
std::vector<Image> texture_space_levels(const ImageView& image,
                                        const std::vector<unsigned char>& covered,
                                        const MipmapOptions& options, int level_count,
                                        const Run& run) {
  const Kernel& kernel = *std::get<TextureSpaceFilter>(options.filter).kernel;
  std::vector<Image> levels;
  for (int level = 1; level < level_count; ++level) {
    const Run part = run.part(static_cast<double>(level - 1) / (level_count - 1),
                              static_cast<double>(level) / (level_count - 1));
    levels.push_back(covered.empty()
                         ? filter_level(image, level, kernel, options.wrap, part)
                         : filter_covered_level(image, covered, level, kernel, options.wrap, part));
  }
  return levels;
}

SolveOptions solve_options(const FilteredImage& image, const MipmapOptions& options) {
  SolveOptions solve;
  for (int c = 0; c < image.texels().channels; ++c) {
    solve.ranges[c] = image.solved_range(c, range_of(options.bounds));
  }
  solve.ranges_times_alpha = image.is_multiplied();
  return solve;
}

void clip(const ValueRange& range, const Run& run, Image* level) {
  parallel_for(level->height, run, [&](std::int64_t y) {
    float* row = level->texel(0, static_cast<int>(y));
    for (int i = 0; i < level->width * level->channels; ++i) {
      row[i] = std::min(std::max(row[i], range.low), range.high);
    }
  });
}

// Computes the levels; the arguments have been checked.
std::vector<Image> make_levels(const TexelSource& source,
                               const std::vector<const Surface*>& surfaces,
                               const MipmapOptions& options) {
  const Run& run = options.run;
  const Reads reads = reads_of(options.filter);
  const int level_count =
      options.levels > 0 ? options.levels : full_level_count(source.width, source.height);
  std::vector<SeamEdge> seams;  // to be hidden by the fits
  if (options.seam_budget != 0.0 && is_fit(options.filter)) {
    seams = find_seams(surfaces, run.part(0.0, 0.0));
  }
  std::vector<unsigned char> covered;
  if (reads == Reads::kTouched) {
    covered = covered_texels(surfaces, source, options, run.part(0.0, 0.1));
  }
  const FilteredImage image(
      source, [&] { return read_texels(surfaces, source, covered, options, run.part(0.11, 0.15)); },
      {.alpha = alpha_channel(source.channels, options.premultiplied),
       .needs_floats = needs_floats(options),
       .name = options.image_name,
       .run = run.part(0.1, 0.16)});
  const Run making = run.part(0.16, 0.97);
  std::vector<Image> levels;
  switch (reads) {
    case Reads::kAll:
    case Reads::kTouched:
      levels = texture_space_levels(image.floats(), covered, options, level_count, making);
      break;
    case Reads::kWeighted:
      levels =
          pam_box_levels(image.texels(), mapped(surfaces, source, options, making.part(0.0, 0.05)),
                         level_count, options.wrap, making.part(0.05, 1.0));
      break;
    case Reads::kLookedUp:
      levels = fitted_levels(image, surfaces, seams, solve_options(image, options), options,
                             level_count, making);
      break;
  }
  for (Image& level : levels) {
    image.divide_by_alpha(options.wrap, run.part(0.97, 0.98), &level);
    clip(range_of(options.bounds), run.part(0.98, 0.99), &level);
  }
  run.report(1.0);
  return levels;
}

std::string fit_names() {
  std::string names;
  for (const MipmapFilter& filter : mipmap_filters()) {
    if (is_fit(filter)) names += (names.empty() ? "" : ", ") + name_of(filter);
  }
  return names;
}

Surface unit_square() {
  Surface square;
  square.positions = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, {0.0, 1.0, 0.0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  square.uvs = {{{{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}}}, {{{0.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}}}};
  square.areas = {0.5, 0.5};
  return square;
}

void check_options(const TexelSource& image, const std::vector<const Surface*>& surfaces,
                   const MipmapOptions& options) {
  const int full = full_level_count(image.width, image.height);
  if (options.levels < 0 || options.levels > full) {
    throw_invalid("levels: " + std::to_string(options.levels) + " asked for, but an image of " +
                  std::to_string(image.width) + " x " + std::to_string(image.height) +
                  " texels has 1 to " + std::to_string(full));
  }
  range_of(options.bounds);
  if (!(options.seam_budget >= 0.0) || !std::isfinite(options.seam_budget)) {
    throw_invalid("seam_budget: " + to_text(options.seam_budget) +
                  "; a finite number of at least 0 is needed");
  }
  if (!(options.footprint >= 0.0 && options.footprint <= kMaxFootprint)) {
    throw_invalid("footprint: " + to_text(options.footprint) + "; 0 to " + to_text(kMaxFootprint) +
                  " texels of a level are allowed");
  }
  if (options.footprint != 0.0 && (!is_fit(options.filter) || options.reader != Reader::kLinear)) {
    throw_invalid("footprint: " + to_text(options.footprint) +
                  "; values other than 0 require least squares (" + fit_names() +
                  ") and the linear reader");
  }
  if (options.run.threads() < 0) {
    throw_invalid("threads: " + std::to_string(options.run.threads()) +
                  "; a positive number is needed, or 0 for all processors");
  }
  if (options.filter == MipmapFilter(SurfaceFilter::kTrilinear) &&
      options.reader != Reader::kLinear) {
    throw_invalid(
        "reader: 'srgb-after' requires pam-bilinear: such readers do not interpolate between "
        "levels; use linear for pam-trilinear");
  }
  if (!needs_surface(options.filter)) return;
  if (surfaces.empty()) {
    std::string others;
    for (const MipmapFilter& filter : mipmap_filters()) {
      if (!needs_surface(filter)) others += (others.empty() ? "" : ", ") + name_of(filter);
    }
    throw_invalid("surface: none was given, and " + name_of(options.filter) +
                  " needs one; without a surface use one of " + others);
  }
  check_surface_area(surfaces);
}

}  // namespace

std::vector<Image> coarser_levels(const TexelSource& image,
                                  const std::vector<const Surface*>& surfaces,
                                  const MipmapOptions& options) {
  check_channels({nullptr, image.width, image.height, image.channels}, options.image_name);
  check_options(image, surfaces, options);
  if (is_fit(options.filter) && !needs_surface(options.filter)) {
    const Surface square = unit_square();
    return make_levels(image, {&square}, options);
  }
  return make_levels(image, surfaces, options);
}

std::vector<Image> mipmaps(const ImageView& image, const std::vector<const Surface*>& surfaces,
                           const MipmapOptions& options) {
  std::vector<Image> levels = coarser_levels(image, surfaces, options);
  levels.insert(levels.begin(), Image(image));
  return levels;
}

}  // namespace prefilter
