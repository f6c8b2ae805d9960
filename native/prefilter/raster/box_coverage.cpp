#include "prefilter/raster/box_coverage.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/outline/resolve.h"

namespace prefilter {
namespace {

constexpr double kFarthestPoint = 1e9;

bool is_near(const Point2& point, double farthest) {
  return std::abs(point.x) <= farthest && std::abs(point.y) <= farthest;
}

float byte_value(std::uint32_t coverage) {
  constexpr auto kScale = static_cast<float>(255.0 * kBoxUnit);
  const float value = static_cast<float>(static_cast<std::int32_t>(coverage)) * kScale;
  return std::min(std::max(value, 0.0F), 255.0F) + 0.5F;
}

void write_bytes(BoxCoverage* coverage, const ByteRows& target) {
  const auto row_of = [&](int row) { return target.data + row * target.stride; };
  coverage->take(
      [&](int row, int x, int count, const std::uint32_t* values) {
        std::uint8_t bytes[16];
        for (int i = 0; i < 16; ++i) {
          bytes[i] = static_cast<std::uint8_t>(static_cast<int>(byte_value(values[i])));
        }
        std::uint8_t* to = row_of(row) + x;
        if (count == 16) {
          std::memcpy(to, bytes, 16);
        } else {
          std::copy_n(bytes, count, to);
        }
      },
      [&](int row, int begin, int end, std::uint32_t value) {
        const int byte = static_cast<int>(byte_value(value));
        if (byte != 0) std::memset(row_of(row) + begin, byte, end - begin);
      });
}

void check_points(bool are_all_near) {
  if (!are_all_near) {
    throw_invalid("outline: has a point that is not finite, or farther than 1e9 pixels away");
  }
}

}  // namespace

bool BoxCoverage::add_segment(std::span<const Point2> controls, double weight) {
  if (controls.size() == 2 && is_near(controls[0], kFarthestBoxPixel) &&
      is_near(controls[1], kFarthestBoxPixel)) {
    lines_.line_to(controls[1]);
    return true;
  }
  for (const Point2& point : controls) {
    if (!is_near(point, kFarthestPoint)) return false;
  }
  for_monotone_pieces(controls, weight, [&](const MonotoneCurve& piece, bool backwards) {
    curves_.add(piece, backwards ? 1 : -1);
  });
  lines_.move_to(controls.back());
  return true;
}

bool BoxCoverage::add(const Outline& outline) {
  for (std::size_t contour = 0; contour < outline.contour_count(); ++contour) {
    const auto segments = outline.contour(contour);
    if (segments.empty()) continue;
    const Point2& begin = outline.begin_of(contour);
    Point2 at = begin;
    lines_.move_to(begin);
    for (const Outline::Segment& segment : segments) {
      const auto controls = outline.controls(segment);
      if (!add_segment(controls, segment.weight)) {
        lines_.flush();
        return false;
      }
      at = controls.back();
    }
    if (!(at == begin)) add_segment(std::array<Point2, 2>{at, begin}, 0.0);
  }
  lines_.flush();
  return true;
}

void BoxCoverage::add(const EdgeList& edges) {
  Point2 at{NAN, NAN};  // No point is there, so that the first segment begins with a move.
  edges.for_segments_between(rows_.first_row(), rows_.end_row(),
                             [&](std::span<const Point2> controls, double weight) {
                               if (!(at == controls.front())) lines_.move_to(controls.front());
                               add_segment(controls, weight);
                               at = controls.back();
                             });
  lines_.flush();
}

void BoxRasterizer::draw(const Outline& outline, const ByteRows& target) {
  // Rows whose differences stay in a processor's cache.
  constexpr int kBandValues = 1 << 22;
  const int rows = std::max(16, kBandValues / target.width);
  bool are_all_near = true;
  for (int first = 0; first < target.height; first += rows) {
    coverage_.begin(target.width, first, std::min(first + rows, target.height));
    are_all_near = coverage_.add(outline) && are_all_near;
    write_bytes(&coverage_, target);
  }
  check_points(are_all_near);
}

void rasterize_coverage(const Outline& outline, FillRule rule, const ByteRows& target, int threads,
                        const Progress& progress) {
  for (const Point2& point : outline.points()) check_points(is_near(point, kFarthestPoint));
  const Outline simple = resolve(outline, rule);
  EdgeList edges;
  edges.add(simple);
  constexpr int kBandValues = 1 << 18;
  const int rows = std::max(16, kBandValues / target.width);
  parallel_ranges(target.height, rows, threads, progress,
                  [&](std::int64_t begin, std::int64_t end) {
                    BoxCoverage coverage;
                    coverage.begin(target.width, static_cast<int>(begin), static_cast<int>(end));
                    coverage.add(edges);
                    write_bytes(&coverage, target);
                  });
}

}  // namespace prefilter
