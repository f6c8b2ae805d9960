// SPDX-License-Identifier: GPL-3.0-or-later

// Directions form a spherical Fibonacci lattice; rolls, pixel sizes and steps follow further low-
// discrepancy sequences.
#include "prefilter/textures/views/view_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace prefilter {
namespace {

constexpr double kTwoPi = 6.283185307179586;
// Low-discrepancy sequences: fractions of multiples of the inverse golden ratio, and of the first
// two powers of the inverse plastic number, are evenly spread, alone and jointly.
constexpr double kInverseGolden = 0.6180339887498949;
constexpr double kInversePlastic = 0.7548776662466927;
constexpr double kInversePlasticSquared = 0.5698402909980532;
constexpr double kFrameStep = 0.3;          // pixels, between the frames of a view
constexpr double kPixelsPerOctave = 1.0e6;  // rough total over all views
constexpr double kCoveredShare = 0.5;       // rough share of a frame's pixels
constexpr double kMinViews = 4.0;
constexpr double kMaxViews = 320.0;
constexpr int kMinFrameSize = 6;      // pixels
constexpr int kMaxFrameSize = 6000;   // pixels; surfaces of many tiles would take too long
constexpr int kFrameMargin = 2;       // pixels
constexpr int kFinePixelSamples = 4;  // per side of a pixel, where pixels have two to four texels
constexpr int kCoarsePixelSamples = 8;

double fraction(double x) { return x - std::floor(x); }

// Size of a surface in space and in the texture.
struct Extent {
  Vector3 center{};
  double radius = 0.0;
  double texel = 0.0;  // average side of a level 0 texel on the surface
  double area = 0.0;   // in texels of level 0
};

Extent extent_of(const Surface& surface, int width, int height) {
  Box box = kEmptyBox;
  double in_space = 0.0;
  Extent extent;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto& [a, b, c] = surface.triangles[t];
    const std::array<Vector3, 3> p = {surface.positions[static_cast<std::size_t>(a)],
                                      surface.positions[static_cast<std::size_t>(b)],
                                      surface.positions[static_cast<std::size_t>(c)]};
    const double area = 0.5 * length(cross(p[1] - p[0], p[2] - p[0]));
    const auto& uvs = surface.uvs[t];
    const double in_texture = 0.5 *
                              std::abs((uvs[1].u - uvs[0].u) * (uvs[2].v - uvs[0].v) -
                                       (uvs[2].u - uvs[0].u) * (uvs[1].v - uvs[0].v)) *
                              width * height;
    if (!(area > 0.0) || !(in_texture > 0.0)) continue;
    in_space += area;
    extent.area += in_texture;
    for (const Vector3& corner : p) box.include(corner);
  }
  if (!(extent.area > 0.0) || !std::isfinite(in_space)) return {};
  extent.center = 0.5 * (box.low + box.high);
  extent.radius = 0.5 * length(box.high - box.low);
  extent.texel = std::sqrt(in_space / extent.area);
  return extent;
}

// The k-th of `count` views of an octave.
View view_at(const Surface& surface, const Extent& extent, int octave, std::int64_t k,
             std::int64_t count) {
  View view;
  view.surface = &surface;
  view.center = extent.center;
  view.octave = octave;
  const auto number = static_cast<double>(k);
  const double height = 1.0 - 2.0 * (number + 0.5) / static_cast<double>(count);
  const double around = kTwoPi * fraction(number * kInverseGolden + 0.37 * octave);
  const double flat = std::sqrt(std::max(0.0, 1.0 - height * height));
  view.toward = {flat * elementary::cos(around), flat * elementary::sin(around), height};
  const Vector3 other = std::abs(height) < 0.9 ? Vector3{0.0, 0.0, 1.0} : Vector3{1.0, 0.0, 0.0};
  const Vector3 across = cross(other, view.toward);
  const Vector3 first = (1.0 / length(across)) * across;
  const Vector3 second = cross(view.toward, first);
  const double roll = kTwoPi * fraction(number * kInversePlastic + 0.5);
  const double c = elementary::cos(roll);
  const double s = elementary::sin(roll);
  view.right = c * first + s * second;
  view.up = c * second - s * first;
  const double mip = octave + fraction(number * kInversePlasticSquared + 0.5);
  view.pixel = extent.texel * elementary::exp2(mip);
  view.size = 2 * (static_cast<int>(std::ceil(extent.radius / view.pixel)) + kFrameMargin);
  view.samples = octave < 2 ? kFinePixelSamples : kCoarsePixelSamples;
  view.sampled_level = std::max(0, octave - 2);
  const double turn = kTwoPi * fraction(number * kInverseGolden * kInverseGolden + 0.25);
  view.step = {kFrameStep * elementary::cos(turn), kFrameStep * elementary::sin(turn)};
  return view;
}

}  // namespace

std::vector<View> plan_views(const std::vector<const Surface*>& surfaces, int width, int height,
                             int level_count, double effort) {
  std::vector<Extent> extents;
  double area = 0.0;
  for (const Surface* surface : surfaces) {
    extents.push_back(extent_of(*surface, width, height));
    area += extents.back().area;
  }
  std::vector<View> views;
  if (!(area > 0.0)) return views;
  for (int octave = 0; octave + 1 < level_count; ++octave) {
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
      const Extent& extent = extents[i];
      if (!(extent.area > 0.0)) continue;
      const double typical = extent.texel * elementary::exp2(octave + 0.5);
      const double side = 2.0 * extent.radius / typical;
      if (side < kMinFrameSize || side > kMaxFrameSize) continue;
      const double view_count =
          std::clamp(kPixelsPerOctave / (kCoveredShare * side * side), kMinViews, kMaxViews);
      const auto count =
          std::max<std::int64_t>(1, std::llround(effort * view_count * extent.area / area));
      for (std::int64_t k = 0; k < count; ++k) {
        View view = view_at(*surfaces[i], extent, octave, k, count);
        // Proportional to the area of the smallest pixels in the octave.
        view.weight = elementary::exp2(2.0 * octave) / static_cast<double>(count);
        views.push_back(view);
      }
    }
  }
  return views;
}

}  // namespace prefilter
