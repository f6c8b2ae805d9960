// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/root_frame.h"

#include <cmath>
#include <limits>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {
constexpr double kSteps = 4.0;  // units in the last place
constexpr double kLeast = 1e-5;
constexpr double kRootFrameMost = 0.25;
constexpr std::int64_t kRowsPerTask = 1 << 16;
}  // namespace

RootFrame::RootFrame(const Box& root) : origin_(root.low) {
  unit_ = std::max({root.size(0), root.size(1), root.size(2)});
  for (int a = 0; a < 3; ++a) {
    const double farthest = std::max(std::abs(root.low[a]), std::abs(root.high[a]));
    const double float_steps = kSteps / 2.0 * std::numeric_limits<float>::epsilon();
    const double double_steps =
        kSteps / 2.0 * std::numeric_limits<double>::epsilon() * (farthest / root.size(a));
    for (int depth = 0; depth <= kMaxTreeDepth; ++depth) {
      cell_[a][depth] = std::ldexp(root.size(a) / unit_, -depth);
      least_[a][depth] = std::clamp(std::ldexp(std::max(float_steps, double_steps), depth), kLeast,
                                    kRootFrameMost);
    }
  }
}

void RootFrame::place(const Run& run, std::vector<Vector3>* positions) const {
  const auto place_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      Vector3& p = (*positions)[i];
      for (int a = 0; a < 3; ++a) p[a] = origin_[a] + unit_ * p[a];
    }
  };
  parallel_ranges(static_cast<std::int64_t>(positions->size()), kRowsPerTask, run, place_some);
}

}  // namespace prefilter
