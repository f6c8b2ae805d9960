// SPDX-License-Identifier: GPL-3.0-or-later

// Figure 7.7. Between two levels the lookup is linear in the fraction f of the mip value, so the
// squared error is quadratic in f. Its three coefficients are quadratic forms in the texels, with
// the moments as matrices.
#include "prefilter/textures/mipmap_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/moments/four_point_rule.h"
#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/images/srgb_decoder.h"
#include "prefilter/images/transfer.h"
#include "prefilter/textures/mipmap/argument_checks.h"
#include "prefilter/textures/texels/levels.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {
namespace {

// The polynomial p00 + p10 x + p01 y + p11 x y, its coefficients at [2 * b + a].
using Bilinear = std::array<double, 4>;

// The bilinear interpolant of a level on a cell.
template <int C>
std::array<Bilinear, C> interpolant(const ImageView& level, WrapModes wrap, const CellPlace& in_x,
                                    const CellPlace& in_y) {
  const float* corners[4];
  for (int k = 0; k < 4; ++k) {
    const int i = wrap_index(in_x.texel + k % 2, level.width, wrap.u);
    const int j = wrap_index(in_y.texel + k / 2, level.height, wrap.v);
    corners[k] = i < 0 || j < 0 ? nullptr : level.texel(i, j);
  }
  const auto [x, size_x] = in_x.placement;
  const auto [y, size_y] = in_y.placement;
  std::array<Bilinear, C> result;
  for (int c = 0; c < C; ++c) {
    double v[4];
    for (int k = 0; k < 4; ++k) v[k] = corners[k] == nullptr ? 0.0 : corners[k][c];
    const double slope_x = v[1] - v[0];
    const double slope_y = v[2] - v[0];
    const double twist = v[3] - v[2] - v[1] + v[0];
    result[c] = {v[0] + slope_x * x + slope_y * y + twist * x * y, (slope_x + twist * y) * size_x,
                 (slope_y + twist * x) * size_y, twist * size_x * size_y};
  }
  return result;
}

double integral_of_product(const Bilinear& p, const Bilinear& q, const WeightMoments& moments) {
  double sum = 0.0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      sum += p[i] * q[j] * moments[3 * (i / 2 + j / 2) + i % 2 + j % 2];
    }
  }
  return sum;
}

double integral_with_image(const Bilinear& p, const ImageMoments& image) {
  return p[0] * image[0] + p[1] * image[1] + p[2] * image[2] + p[3] * image[3];
}

// Integrals for levels l and l + 1, with interpolants L and M and the image I.
struct Integrals {
  double level_level = 0.0;  // of L^2
  double level_image = 0.0;  // of L I
  double step_level = 0.0;   // of (M - L) L
  double step_image = 0.0;   // of (M - L) I
  double step_step = 0.0;    // of (M - L)^2

  void operator+=(const Integrals& other) {
    level_level += other.level_level;
    level_image += other.level_image;
    step_level += other.step_level;
    step_image += other.step_image;
    step_step += other.step_step;
  }
};

// Coefficients of the squared error h + 2 f c + f^2 s at the fraction f between two levels.
struct Squares {
  double here = 0.0;   // h, of (L - I)^2
  double cross = 0.0;  // c, of (L - I) (M - L)
  double step = 0.0;   // s, of (M - L)^2

  void operator+=(const Squares& other) {
    here += other.here;
    cross += other.cross;
    step += other.step;
  }
};

// Sums over the blocks for each level. `parts` holds all levels of a block consecutively.
template <class Sums>
std::vector<Sums> totals_of_levels(const std::vector<Sums>& parts, std::size_t level_count) {
  std::vector<Sums> totals(level_count);
  for (std::size_t i = 0; i < parts.size(); ++i) totals[i % level_count] += parts[i];
  return totals;
}

// Root mean squares, given the total mass over which the squares were integrated.
std::vector<double> errors_at(const std::vector<double>& mip_values,
                              const std::vector<Squares>& levels, double mass) {
  const auto last = static_cast<double>(levels.size() - 1);
  std::vector<double> errors;
  for (const double mip_value : mip_values) {
    const double value = std::clamp(mip_value, 0.0, last);
    const auto level = static_cast<std::size_t>(value);
    const double f = value - static_cast<double>(level);
    const Squares& sums = levels[level];
    const double squared = sums.here + 2.0 * f * sums.cross + f * f * sums.step;
    errors.push_back(std::sqrt(std::max(squared, 0.0) / mass));
  }
  return errors;
}

template <int C>
std::vector<double> measure(const std::vector<ImageView>& levels, const ImageView& image,
                            const TexelTriangles& triangles, const std::vector<double>& mip_values,
                            WrapModes wrap, const Run& run) {
  const auto level_count = static_cast<int>(levels.size());
  const std::int64_t block_count = sweep_block_count(image.width, image.height);
  std::vector<Integrals> parts(static_cast<std::size_t>(block_count * level_count));
  std::vector<double> image_parts(static_cast<std::size_t>(block_count));

  sweep_moments<C>(
      triangles, image, wrap, {.first_level = 0, .last_level = level_count - 1}, run,
      [&](const MomentBlock<C>& block) {
        const ImageView& level = levels[block.level];
        const bool has_next = block.level + 1 < level_count;
        const ImageView& next = levels[has_next ? block.level + 1 : block.level];
        const CellPlace* x_places = block.x_places(block.level);
        const CellPlace* y_places = block.y_places(block.level);
        const CellPlace* next_x_places = block.x_places(block.level + (has_next ? 1 : 0));
        const CellPlace* next_y_places = block.y_places(block.level + (has_next ? 1 : 0));
        Integrals& sums = parts[block.index * level_count + block.level];
        for (int y = 0; y < block.height; ++y) {
          for (int x = 0; x < block.width; ++x) {
            const CellMoments<C>& cell = block.at(x, y);
            if (cell.empty()) continue;
            const auto here = interpolant<C>(level, wrap, x_places[x], y_places[y]);
            const auto coarse = interpolant<C>(next, wrap, next_x_places[x], next_y_places[y]);
            if (block.level == 0) {
              const auto source = interpolant<C>(image, wrap, x_places[x], y_places[y]);
              for (int c = 0; c < C; ++c) {
                image_parts[block.index] += integral_of_product(source[c], source[c], cell.weight);
              }
            }
            for (int c = 0; c < C; ++c) {
              Bilinear step;
              for (int i = 0; i < 4; ++i) step[i] = coarse[c][i] - here[c][i];
              sums.level_level += integral_of_product(here[c], here[c], cell.weight);
              sums.level_image += integral_with_image(here[c], cell.image[c]);
              sums.step_level += integral_of_product(step, here[c], cell.weight);
              sums.step_image += integral_with_image(step, cell.image[c]);
              sums.step_step += integral_of_product(step, step, cell.weight);
            }
          }
        }
      });

  double image_image = 0.0;
  for (const double part : image_parts) image_image += part;
  std::vector<Squares> squares;
  for (const Integrals& sums : totals_of_levels(parts, levels.size())) {
    squares.push_back({sums.level_level - 2.0 * sums.level_image + image_image,
                       sums.step_level - sums.step_image, sums.step_step});
  }
  run.report(1.0);
  return errors_at(mip_values, squares, triangles.total_mass * C);
}

// The decoded lookup at a position, in texels of the image, in a level with encoded colors.
template <int C>
std::array<double, C> decoded_lookup(const ImageView& level, const ImageView& image, WrapModes wrap,
                                     double u, double v) {
  const SrgbDecoder& decode = SrgbDecoder::instance();
  const double x = u * level.width / image.width - 0.5;
  const double y = v * level.height / image.height - 0.5;
  const CellPlace in_x{static_cast<int>(std::floor(x)), {x - std::floor(x), 0.0}};
  const CellPlace in_y{static_cast<int>(std::floor(y)), {y - std::floor(y), 0.0}};
  const auto polynomials = interpolant<C>(level, wrap, in_x, in_y);
  std::array<double, C> value;
  for (int c = 0; c < C; ++c) {
    value[c] = polynomials[c][0];
    if (c < encoded_channels(C)) value[c] = decode(static_cast<float>(value[c])).value;
  }
  return value;
}

// Adds the squared errors at a position with this weight to all levels.
template <int C>
void add_decoded(const std::vector<ImageView>& levels, const ImageView& image, WrapModes wrap,
                 double u, double v, double weight, Squares* squares) {
  const auto source = decoded_lookup<C>(image, image, wrap, u, v);
  auto here = decoded_lookup<C>(levels[0], image, wrap, u, v);
  for (std::size_t level = 0; level < levels.size(); ++level) {
    const bool has_next = level + 1 < levels.size();
    const auto next = has_next ? decoded_lookup<C>(levels[level + 1], image, wrap, u, v) : here;
    for (int c = 0; c < C; ++c) {
      const double off = here[c] - source[c];
      const double step = next[c] - here[c];
      squares[level] += {weight * off * off, weight * off * step, weight * step * step};
    }
    here = next;
  }
}

// The same for a reader that decodes after the lookup: `levels` and `image` are encoded, and the
// integrals are sums over FourPointRule in the finest cells.
template <int C>
std::vector<double> measure_decoded(const std::vector<ImageView>& levels, const ImageView& image,
                                    const TexelTriangles& triangles,
                                    const std::vector<double>& mip_values, WrapModes wrap,
                                    const Run& run) {
  const std::size_t level_count = levels.size();
  const std::int64_t block_count = sweep_block_count(image.width, image.height);
  std::vector<Squares> parts(static_cast<std::size_t>(block_count) * level_count);
  sweep_moments<C>(triangles, image, wrap, {.first_level = 0, .last_level = 0}, run,
                   [&](const MomentBlock<C>& block) {
                     const double* const x_lines = block.x_cells->lines(0).data() + block.x0;
                     const double* const y_lines = block.y_cells->lines(0).data() + block.y0;
                     for (int y = 0; y < block.height; ++y) {
                       for (int x = 0; x < block.width; ++x) {
                         const CellMoments<C>& cell = block.at(x, y);
                         if (cell.empty()) continue;
                         const FourPointRule rule(cell.weight);
                         for (int k = 0; k < 4; ++k) {
                           const double u = x_lines[x] + rule.x(k) * (x_lines[x + 1] - x_lines[x]);
                           const double v = y_lines[y] + rule.y(k) * (y_lines[y + 1] - y_lines[y]);
                           add_decoded<C>(levels, image, wrap, u, v, rule.weight(k),
                                          parts.data() + block.index * level_count);
                         }
                       }
                     }
                   });
  run.report(1.0);
  return errors_at(mip_values, totals_of_levels(parts, level_count), triangles.total_mass * C);
}

void check(const std::vector<ImageView>& levels, const ImageView& image,
           const std::vector<const Surface*>& surfaces, const std::vector<double>& mip_values) {
  check_channels(image);
  if (surfaces.empty()) throw_invalid("surface: none was given; at least one is needed");
  check_surface_area(surfaces);
  const int full = full_level_count(image.width, image.height);
  if (levels.empty() || static_cast<int>(levels.size()) > full) {
    throw_invalid("levels: " + std::to_string(levels.size()) + " were given, but an image of " +
                  std::to_string(image.width) + " x " + std::to_string(image.height) +
                  " texels has 1 to " + std::to_string(full));
  }
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const int width = level_size(image.width, static_cast<int>(k));
    const int height = level_size(image.height, static_cast<int>(k));
    const ImageView& level = levels[k];
    if (level.width != width || level.height != height || level.channels != image.channels) {
      throw_invalid("levels: level " + std::to_string(k) + " has " + std::to_string(level.width) +
                    " x " + std::to_string(level.height) + " texels of " +
                    std::to_string(level.channels) + " channels; " + std::to_string(width) + " x " +
                    std::to_string(height) + " of " + std::to_string(image.channels) +
                    " are expected");
    }
  }
  for (const double value : mip_values) {
    if (std::isnan(value)) throw_invalid("mip_values: holds nan; numbers are needed");
  }
}

// Returns the view itself if all values are finite; otherwise a view of a copy in `owner` with the
// texels that no lookup reads set to 0.
ImageView readable(const ImageView& view, const std::string& name,
                   const std::vector<const Surface*>& surfaces, WrapModes wrap, const Run& run,
                   Image* owner) {
  const Stages stages(run, {1, 1});
  if (all_filterable(view, stages[0])) return view;
  const std::vector<unsigned char> read =
      looked_up_texels(surfaces, view.width, view.height, wrap, stages[1]);
  *owner = Image(view);
  for (std::size_t i = 0; i < owner->data.size(); ++i) {
    float& value = owner->data[i];
    if (is_filterable(value)) continue;
    const std::size_t texel = i / static_cast<std::size_t>(view.channels);
    if (read[texel] != 0) {
      throw_invalid(name + ": the texel in row " + std::to_string(texel / view.width) +
                    ", column " + std::to_string(texel % view.width) + " holds " + to_text(value) +
                    "; texels that the surface reads must be finite, and at most 1e30");
    }
    value = 0.0F;
  }
  return owner->view();
}

}  // namespace

std::vector<double> mipmap_error(const std::vector<ImageView>& levels, const ImageView& image,
                                 const std::vector<const Surface*>& surfaces,
                                 const std::vector<double>& mip_values, WrapModes wrap,
                                 Reader reader, const Run& run) {
  check(levels, image, surfaces, mip_values);
  std::vector<Image> owners(levels.size() + 1);
  const ImageView readable_image =
      readable(image, "image", surfaces, wrap, run.part(0.0, 0.05), &owners.back());
  std::vector<ImageView> views;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    views.push_back(readable(levels[k], "levels: level " + std::to_string(k), surfaces, wrap,
                             run.part(0.05, 0.1), &owners[k]));
  }
  const TexelTriangles triangles =
      map_to_texels(surfaces, image.width, image.height, wrap, MassOf::kArea, run.part(0.1, 0.15));
  check_mapped(triangles);
  std::vector<Image> encoded;
  if (reader == Reader::kSrgbAfter) {
    for (const ImageView& view : views) encoded.push_back(encode_srgb(view, run.threads()));
    encoded.push_back(encode_srgb(readable_image, run.threads()));
    for (std::size_t k = 0; k < views.size(); ++k) views[k] = encoded[k].view();
  }
  const auto measure_channels = [&]<int C>() {
    if (reader == Reader::kSrgbAfter) {
      return measure_decoded<C>(views, encoded.back().view(), triangles, mip_values, wrap,
                                run.part(0.15, 1.0));
    }
    return measure<C>(views, readable_image, triangles, mip_values, wrap, run.part(0.15, 1.0));
  };
  switch (image.channels) {
    case 1:
      return measure_channels.operator()<1>();
    case 2:
      return measure_channels.operator()<2>();
    case 3:
      return measure_channels.operator()<3>();
    default:
      return measure_channels.operator()<4>();
  }
}

}  // namespace prefilter
