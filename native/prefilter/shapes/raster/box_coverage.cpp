// SPDX-License-Identifier: GPL-3.0-or-later

// The box filter of section 2.2 by differences along rows, in bands that fit into the cache.
#include "prefilter/shapes/raster/box_coverage.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/shapes/resolve.h"

namespace prefilter {
namespace {

bool is_near(const Point2& point, double farthest) {
  return std::abs(point.x) <= farthest && std::abs(point.y) <= farthest;
}

void write_bytes(BoxCoverage* coverage, const ByteRows& target) {
  constexpr auto kByteUnit = static_cast<float>(255.0 * kBoxUnit);
  const auto row_of = [&](int row) { return target.data + row * target.stride; };
  coverage->take(
      [&](int row, int x, int count, const std::uint32_t* values) {
        std::uint8_t* to = row_of(row) + x;
        if (count == 16) {
          store_bytes(to, values, kByteUnit);
        } else {
          std::uint8_t bytes[16];
          store_bytes(bytes, values, kByteUnit);
          std::copy_n(bytes, count, to);
        }
      },
      [&](int row, int begin, int end, std::uint32_t value) {
        const float byte = kByteUnit * static_cast<float>(static_cast<std::int32_t>(value));
        const auto rounded = static_cast<int>(std::lrint(std::clamp(byte, 0.0F, 255.0F)));
        if (rounded != 0) std::memset(row_of(row) + begin, rounded, end - begin);
      });
}

void check_size(const ByteRows& target) {
  if (target.width < 1 || target.height < 1 || target.width > kMaxBoxImageSide ||
      target.height > kMaxBoxImageSide) {
    throw_invalid("target: found " + std::to_string(target.width) + " x " +
                  std::to_string(target.height) + " pixels; 1 to " +
                  std::to_string(kMaxBoxImageSide) + " are possible along a side");
  }
}

void check_points(bool are_all_near) {
  if (!are_all_near) {
    throw_invalid("outline: has a point that is not finite, or farther than 1e9 pixels away");
  }
}

}  // namespace

bool BoxCoverage::add_segment(std::span<const Point2> controls, double weight) {
  if (controls.size() == 2 && is_near(controls[0], kMaxBoxCoordinate) &&
      is_near(controls[1], kMaxBoxCoordinate)) {
    lines_.line_to(controls[1]);
    return true;
  }
  for (const Point2& point : controls) {
    if (!is_near(point, kMaxPixelCoordinate)) return false;
  }
  curves_.add(controls, weight);
  lines_.move_to(controls.back());
  return true;
}

bool BoxCoverage::add_polygon(std::span<const Point2> points) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (is_near(points[i - 1], kMaxBoxCoordinate)) {
      i += lines_.lines_to(points.data() + i, points.size() - i);
      if (i == points.size()) break;
    }
    if (!add_segment(points.subspan(i - 1, 2), 0.0)) return false;
  }
  return true;
}

bool BoxCoverage::add(const Outline& outline) {
  bool are_all_near = true;
  for (std::size_t contour = 0; contour < outline.contour_count() && are_all_near; ++contour) {
    const auto segments = outline.contour(contour);
    const auto points = outline.contour_points(contour);
    if (segments.empty()) continue;
    lines_.move_to(points.front());
    if (points.size() == segments.size() + 1) {
      are_all_near = add_polygon(points);
    } else {
      for (std::size_t i = 0; i < segments.size() && are_all_near; ++i) {
        are_all_near = add_segment(outline.controls(segments[i]), segments[i].weight);
      }
    }
    if (are_all_near && !(points.back() == points.front())) {
      are_all_near = add_segment(std::array<Point2, 2>{points.back(), points.front()}, 0.0);
    }
  }
  lines_.flush();
  return are_all_near;
}

void BoxCoverage::add(const EdgeList& edges) {
  Point2 at{NAN, NAN};  // matches no point, so that the first segment starts with a move
  edges.for_segments_between(rows_.first_row(), rows_.end_row(),
                             [&](std::span<const Point2> controls, double weight) {
                               if (!(at == controls.front())) lines_.move_to(controls.front());
                               add_segment(controls, weight);
                               at = controls.back();
                             });
  lines_.flush();
}

void BoxRasterizer::draw(const Outline& outline, const ByteRows& target) {
  check_size(target);
  // The differences of a few rows stay in the cache; outlines with many segments are better
  // traversed fewer times.
  const bool is_simple = outline.points().size() < 4096;
  const int band_values = is_simple ? 1 << 18 : 1 << 22;
  const int rows = std::max(16, band_values / target.width);
  bool are_all_near = true;
  for (int first = 0; first < target.height; first += rows) {
    coverage_.begin(target.width, first, std::min(first + rows, target.height));
    are_all_near = coverage_.add(outline) && are_all_near;
    write_bytes(&coverage_, target);
  }
  check_points(are_all_near);
}

void rasterize_coverage(const Outline& outline, FillRule rule, const ByteRows& target,
                        const Run& run) {
  check_size(target);
  for (const Point2& point : outline.points()) check_points(is_near(point, kMaxPixelCoordinate));
  const std::optional<Outline> simple = resolved(outline, rule);
  EdgeList edges;
  edges.add(simple ? *simple : outline);
  constexpr int kBandValues = 1 << 18;
  const int rows = std::max(16, kBandValues / target.width);
  parallel_ranges(target.height, rows, run, [&](std::int64_t begin, std::int64_t end) {
    BoxCoverage coverage;
    coverage.begin(target.width, static_cast<int>(begin), static_cast<int>(end));
    coverage.add(edges);
    write_bytes(&coverage, target);
  });
}

}  // namespace prefilter
