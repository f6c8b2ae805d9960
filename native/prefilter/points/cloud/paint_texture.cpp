// SPDX-License-Identifier: GPL-3.0-or-later

// The bilinear least squares of chapter 7, with points instead of an image.
#include "prefilter/points/paint_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/text.h"
#include "prefilter/geometry/nearest.h"
#include "prefilter/geometry/texels/coverage.h"
#include "prefilter/images/filters/push_pull.h"

namespace prefilter {
namespace {

using System = NinePointSystem<float>;

constexpr double kMaxSmoothing = 1e6;
constexpr int kMaxTextureSide = 1 << 16;
constexpr double kMaxPaintCoordinate = 1e150;
constexpr float kMaxPaintValue = 1e30F;

// Position of a point between four texel centers, and the point's index.
struct Sample {
  int column;
  int row;
  float x;
  float y;
  std::size_t point;
};

void check(std::size_t points, std::size_t values, int channels, const PaintOptions& options) {
  for (const int side : {options.width, options.height}) {
    if (side >= 1 && side <= kMaxTextureSide) continue;
    throw_invalid("size: found " + std::to_string(options.width) + " x " +
                  std::to_string(options.height) + "; sides from 1 to 65536 are needed");
  }
  if (channels < 1 || channels > kMaxChannels ||
      values != points * static_cast<std::size_t>(channels)) {
    throw_invalid("values: found " + std::to_string(values) + " for " + std::to_string(points) +
                  " points; 1 to 4 for each are needed");
  }
  if (!(options.smoothing > 0.0 && options.smoothing <= kMaxSmoothing)) {
    throw_invalid("smoothing: found " + to_text(options.smoothing) +
                  "; a number above 0 and up to 1e6 is needed");
  }
  if (options.reach && !(*options.reach > 0.0 && std::isfinite(*options.reach))) {
    throw_invalid("reach: found " + to_text(*options.reach) + "; a number above 0 is needed");
  }
}

// Indices of the valid points.
std::vector<std::size_t> usable_indices(std::span<const Vector3> points,
                                        std::span<const float> values, std::size_t channels) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool is_usable = true;
    for (const double x : points[i]) is_usable = is_usable && std::abs(x) <= kMaxPaintCoordinate;
    for (const float value : values.subspan(i * channels, channels)) {
      is_usable = is_usable && std::abs(value) <= kMaxPaintValue;
    }
    if (is_usable) indices.push_back(i);
  }
  return indices;
}

std::vector<Sample> find_samples(const Surface& surface, std::span<const Vector3> points,
                                 const std::vector<std::size_t>& chosen,
                                 const PaintOptions& options, const Run& run) {
  std::vector<Vector3> places;
  for (const std::size_t i : chosen) places.push_back(points[i]);
  const std::vector<SurfacePoint> nearest =
      nearest_points(places, {surface.positions, surface.triangles}, run);
  const double reach = options.reach.value_or(std::numeric_limits<double>::infinity());
  std::vector<Sample> samples;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    if (!(nearest[k].distance <= reach)) continue;
    const auto& uvs = surface.uvs[static_cast<std::size_t>(nearest[k].triangle)];
    double u = 0.0;
    double v = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      u += nearest[k].weights[i] * uvs[i].u;
      v += nearest[k].weights[i] * uvs[i].v;
    }
    const double x = u * options.width - 0.5;
    const double y = v * options.height - 0.5;
    // larger texel indices do not fit an int
    if (!(std::abs(x) < 1e9 && std::abs(y) < 1e9)) continue;
    samples.push_back({static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)),
                       static_cast<float>(x - std::floor(x)), static_cast<float>(y - std::floor(y)),
                       chosen[k]});
  }
  return samples;
}

System::TentProducts products_of(const std::array<float, 3>& x, const std::array<float, 3>& y) {
  System::TentProducts products{};
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i) products[3 * j + i] = x[i] * y[j];
  }
  return products;
}

// Products of the weights low x low, low x high and high x high.
std::array<float, 3> squares(float at) {
  return {(1.0F - at) * (1.0F - at), (1.0F - at) * at, at * at};
}

void add_samples(const std::vector<Sample>& samples, std::span<const float> values, int channels,
                 System* system) {
  const auto count = static_cast<std::size_t>(channels);
  for (const Sample& sample : samples) {
    LaneValues value;
    for (std::size_t c = 0; c < count; ++c) value.v[c] = values[sample.point * count + c];
    System::TentIntegrals right{};
    for (std::size_t k = 0; k < 4; ++k) {
      const float x = k % 2 == 0 ? 1.0F - sample.x : sample.x;
      const float y = k / 2 == 0 ? 1.0F - sample.y : sample.y;
      right[k].v = (x * y) * value.v;
    }
    system->add_cell(sample.column, sample.row, products_of(squares(sample.x), squares(sample.y)),
                     right);
  }
}

// Adds the integral of the squared gradient over cells whose corners the surface reads.
void add_smoothness(const std::vector<unsigned char>& is_read, const PaintOptions& options,
                    System* system) {
  constexpr std::array<float, 3> kSlope = {1.0F, -1.0F, 1.0F};
  constexpr std::array<float, 3> kMass = {1.0F / 3.0F, 1.0F / 6.0F, 1.0F / 3.0F};
  System::TentProducts products = products_of(kSlope, kMass);
  const System::TentProducts along_y = products_of(kMass, kSlope);
  for (std::size_t i = 0; i < products.size(); ++i) {
    products[i] = static_cast<float>(options.smoothing) * (products[i] + along_y[i]);
  }
  const auto reads = [&](int column, int row) {
    const int x = wrap_index(column, options.width, options.wrap.u);
    const int y = wrap_index(row, options.height, options.wrap.v);
    return x >= 0 && y >= 0 &&
           is_read[static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
                   static_cast<std::size_t>(x)] != 0;
  };
  // If the image repeats, there is another cell beyond its edge.
  const int columns = options.width - (options.wrap.u == Wrap::kRepeat ? 0 : 1);
  const int rows = options.height - (options.wrap.v == Wrap::kRepeat ? 0 : 1);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (reads(column, row) && reads(column + 1, row) && reads(column, row + 1) &&
          reads(column + 1, row + 1)) {
        system->add_cell(column, row, products, {});
      }
    }
  }
}

// Distributes samples to texels: total weights, and weighted means.
Image splat(const std::vector<Sample>& samples, std::span<const float> values, int channels,
            const PaintOptions& options, std::vector<float>* weights) {
  const auto count = static_cast<std::size_t>(channels);
  Image image(options.width, options.height, channels);
  weights->assign(
      static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height), 0.0F);
  for (const Sample& sample : samples) {
    for (int k = 0; k < 4; ++k) {
      const int x = wrap_index(sample.column + k % 2, options.width, options.wrap.u);
      const int y = wrap_index(sample.row + k / 2, options.height, options.wrap.v);
      if (x < 0 || y < 0) continue;
      const float weight =
          (k % 2 == 0 ? 1.0F - sample.x : sample.x) * (k / 2 == 0 ? 1.0F - sample.y : sample.y);
      const std::size_t texel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
          static_cast<std::size_t>(x);
      (*weights)[texel] += weight;
      for (std::size_t c = 0; c < count; ++c) {
        image.data[texel * count + c] += weight * values[sample.point * count + c];
      }
    }
  }
  for (std::size_t texel = 0; texel < weights->size(); ++texel) {
    if (!((*weights)[texel] > 0.0F)) continue;
    for (std::size_t c = 0; c < count; ++c) image.data[texel * count + c] /= (*weights)[texel];
  }
  return image;
}

std::array<ValueRange, kMaxChannels> ranges_of(const std::vector<Sample>& samples,
                                               std::span<const float> values, int channels) {
  const auto count = static_cast<std::size_t>(channels);
  std::array<ValueRange, kMaxChannels> ranges{};
  for (std::size_t c = 0; c < count; ++c) {
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (const Sample& sample : samples) {
      low = std::min(low, values[sample.point * count + c]);
      high = std::max(high, values[sample.point * count + c]);
    }
    ranges[c] = {low, high};
  }
  return ranges;
}

// Solves the system, and fills the other texels. Reuses `weights`.
Image solved(const PaintOptions& options, const SolveOptions& solving, int channels,
             std::vector<float>* weights, System* system) {
  const Run& run = options.run;
  system->invert_diagonal();
  system->solve(solving, run.part(0.5, 0.95));
  auto weight = weights->begin();
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      *weight++ = system->is_part(system->at(x, y)) ? 1.0F : 0.0F;
    }
  }
  Image image = system->take_image(channels);
  fill_holes(*weights, options.wrap, channels, run.part(0.95, 1.0), &image);
  run.report(1.0);
  return image;
}

}  // namespace

PaintedTexture paint_texture(const Surface& surface, std::span<const Vector3> points,
                             std::span<const float> values, int channels,
                             const PaintOptions& options) {
  check(points.size(), values.size(), channels, options);
  const Run& run = options.run;
  const std::vector<std::size_t> chosen =
      usable_indices(points, values, static_cast<std::size_t>(channels));
  const std::vector<Sample> samples =
      find_samples(surface, points, chosen, options, run.part(0.0, 0.4));
  if (samples.empty()) {
    throw_invalid("points: none has a finite place and values and is within reach of the surface");
  }
  const std::vector<unsigned char> is_read = looked_up_texels(
      {&surface}, options.width, options.height, options.wrap, run.part(0.4, 0.45));
  System system(options.width, options.height, options.wrap);
  add_samples(samples, values, channels, &system);
  add_smoothness(is_read, options, &system);
  std::vector<float> weights;
  Image image = splat(samples, values, channels, options, &weights);
  fill_holes(weights, options.wrap, channels, run.part(0.45, 0.5), &image);
  system.make_texels();
  for (int y = 0; y < options.height; ++y) {
    for (int x = 0; x < options.width; ++x) {
      for (int c = 0; c < channels; ++c) {
        system.texel(system.at(x, y)).v[c] = image.texel(x, y)[c];
      }
    }
  }
  SolveOptions solving;
  solving.ranges = ranges_of(samples, values, channels);
  return {solved(options, solving, channels, &weights, &system), samples.size()};
}

}  // namespace prefilter
