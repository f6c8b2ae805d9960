// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/views/view_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace prefilter {
namespace {

constexpr double kTurn = 6.283185307179586;
// Fractions of multiples of these are spread evenly, by themselves and together.
constexpr double kGolden = 0.6180339887498949;
constexpr double kPlasticFirst = 0.7548776662466927;
constexpr double kPlasticSecond = 0.5698402909980532;
constexpr double kStep = 0.3;      // between the frames of a view, in pixels
constexpr double kPixels = 1.0e6;  // of all views of an octave, about
constexpr double kSeen = 0.5;      // of a frame's pixels, about
constexpr double kFewestViews = 4.0;
constexpr double kMostViews = 320.0;
constexpr int kLeastSize = 6;    // pixels
constexpr int kMostSize = 6000;  // likewise: larger ones, of many tiles, take too long
constexpr int kMargin = 2;       // likewise
constexpr int kFewSamples = 4;   // along a side of pixels of two to four texels
constexpr int kMostSamples = 8;

double fraction(double x) { return x - std::floor(x); }

// A surface as a whole.
struct Extent {
  Vector3 center{};
  double radius = 0.0;
  double texel = 0.0;  // the side of one of level 0 on the surface, on average
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
  const double around = kTurn * fraction(number * kGolden + 0.37 * octave);
  const double flat = std::sqrt(std::max(0.0, 1.0 - height * height));
  view.toward = {flat * elementary::cos(around), flat * elementary::sin(around), height};
  const Vector3 other = std::abs(height) < 0.9 ? Vector3{0.0, 0.0, 1.0} : Vector3{1.0, 0.0, 0.0};
  const Vector3 across = cross(other, view.toward);
  const Vector3 first = (1.0 / length(across)) * across;
  const Vector3 second = cross(view.toward, first);
  const double roll = kTurn * fraction(number * kPlasticFirst + 0.5);
  const double c = elementary::cos(roll);
  const double s = elementary::sin(roll);
  view.right = c * first + s * second;
  view.up = c * second - s * first;
  const double mip = octave + fraction(number * kPlasticSecond + 0.5);
  view.pixel = extent.texel * elementary::exp2(mip);
  view.size = 2 * (static_cast<int>(std::ceil(extent.radius / view.pixel)) + kMargin);
  view.samples = octave < 2 ? kFewSamples : kMostSamples;
  view.sampled_level = std::max(0, octave - 2);
  const double turn = kTurn * fraction(number * kGolden * kGolden + 0.25);
  view.step = {kStep * elementary::cos(turn), kStep * elementary::sin(turn)};
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
      if (side < kLeastSize || side > kMostSize) continue;
      const double wanted = std::clamp(kPixels / (kSeen * side * side), kFewestViews, kMostViews);
      const auto count =
          std::max<std::int64_t>(1, std::llround(effort * wanted * extent.area / area));
      for (std::int64_t k = 0; k < count; ++k) {
        View view = view_at(*surfaces[i], extent, octave, k, count);
        // By the area of the octave's smallest pixels.
        view.weight = elementary::exp2(2.0 * octave) / static_cast<double>(count);
        views.push_back(view);
      }
    }
  }
  return views;
}

}  // namespace prefilter
