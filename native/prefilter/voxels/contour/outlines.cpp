// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/outlines.h"

#include <cstdint>
#include <utility>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/edge_crossing.h"
#include "prefilter/voxels/contour/samples.h"

namespace prefilter {
namespace {

// Traces outlines through the squares between four samples. A point lies between two samples, along
// x (0) or y (1) from the lower one.
class Outliner {
 public:
  Outliner(const PlaneView& samples, const PlaneFrame& frame, const ContourOptions& options)
      : samples_(samples), frame_(frame), options_(options) {
    nexts_.assign(static_cast<std::size_t>(2) * static_cast<std::size_t>(samples.size[0] + 1) *
                      static_cast<std::size_t>(samples.size[1] + 1),
                  -1);
  }

  void cut_rows(const Run& run) {
    for (int x = -1; x < samples_.size[0]; ++x) {
      for (int y = -1; y < samples_.size[1]; ++y) cut_square(x, y);
      run.report((x + 1.0) / samples_.size[0]);
    }
  }

  std::vector<OutlinePoints> take() {
    std::vector<OutlinePoints> lines;
    for (std::size_t start = 0; start < nexts_.size(); ++start) {
      OutlinePoints line;
      for (std::int64_t at = static_cast<std::int64_t>(start); nexts_[at] >= 0;) {
        line.push_back(point(at));
        at = std::exchange(nexts_[static_cast<std::size_t>(at)], -1);
      }
      if (!line.empty()) lines.push_back(std::move(line));
    }
    return lines;
  }

 private:
  float value(int x, int y) const {
    const bool is_within = x >= 0 && y >= 0 && x < samples_.size[0] && y < samples_.size[1];
    return is_within ? samples_.at(x, y) : empty_sample(options_.isovalue);
  }
  bool is_inside(int x, int y) const {
    const bool is_within = x >= 0 && y >= 0 && x < samples_.size[0] && y < samples_.size[1];
    return is_within && samples_.at(x, y) >= options_.isovalue;
  }
  std::int64_t point_between(int x, int y, int axis) const {
    return 2 * (static_cast<std::int64_t>(x + 1) * (samples_.size[1] + 1) + (y + 1)) + axis;
  }

  // Cuts off the runs of inside corners around a square one by one, counterclockwise, with the
  // inside on the left.
  void cut_square(int x, int y) {
    const std::array<std::array<int, 2>, 4> corners = {
        {{x, y}, {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}};
    const std::array<std::int64_t, 4> sides = {point_between(x, y, 0), point_between(x + 1, y, 1),
                                               point_between(x, y + 1, 0), point_between(x, y, 1)};
    std::array<bool, 4> inside;
    for (std::size_t i = 0; i < 4; ++i) inside[i] = is_inside(corners[i][0], corners[i][1]);
    for (std::size_t i = 0; i < 4; ++i) {
      if (!inside[i] || inside[(i + 3) % 4]) continue;
      std::size_t last = i;
      while (inside[(last + 1) % 4]) last = (last + 1) % 4;
      nexts_[static_cast<std::size_t>(sides[last])] = sides[(i + 3) % 4];
    }
  }

  std::array<double, 2> point(std::int64_t index) const {
    const int axis = static_cast<int>(index % 2);
    const int y = static_cast<int>(index / 2 % (samples_.size[1] + 1)) - 1;
    const int x = static_cast<int>(index / 2 / (samples_.size[1] + 1)) - 1;
    const float a = value(x, y);
    const float b = axis == 0 ? value(x + 1, y) : value(x, y + 1);
    const bool are_occupancies = a >= 0.0F && a <= 1.0F && b >= 0.0F && b <= 1.0F &&
                                 options_.isovalue == 0.5F &&
                                 options_.interpolant != Interpolant::kLinear;
    const float t =
        are_occupancies ? occupancy_crossing(a, b) : linear_crossing(a, b, options_.isovalue);
    const double px = x + 0.5 + (axis == 0 ? static_cast<double>(t) : 0.0);
    const double py = y + 0.5 + (axis == 1 ? static_cast<double>(t) : 0.0);
    return {frame_.origin[0] + px * frame_.spacing[0], frame_.origin[1] + py * frame_.spacing[1]};
  }

  const PlaneView& samples_;
  const PlaneFrame& frame_;
  const ContourOptions& options_;
  // The next point of the same outline; -1: none.
  std::vector<std::int64_t> nexts_;
};
}  // namespace

std::vector<OutlinePoints> contour_outlines(const PlaneView& samples, const PlaneFrame& frame,
                                            const ContourOptions& options) {
  check_sides(samples.size);
  Box whole{{}, {1.0, 1.0, 1.0}};
  for (int a = 0; a < 2; ++a) {
    whole.low[a] = frame.origin[a];
    whole.high[a] = frame.origin[a] + samples.size[a] * frame.spacing[a];
  }
  check_box(whole, "spacing: the grid");
  check_samples({samples.values, static_cast<std::size_t>(samples.size[0]) *
                                     static_cast<std::size_t>(samples.size[1])});
  Outliner outliner(samples, frame, options);
  outliner.cut_rows(options.run);
  return outliner.take();
}

}  // namespace prefilter
