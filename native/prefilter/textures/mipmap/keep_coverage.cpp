// SPDX-License-Identifier: GPL-3.0-or-later

// Bisection for the bend of the alpha curve, level by level.
#include "prefilter/textures/keep_coverage.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/textures/mipmap/covered_share.h"
#include "prefilter/textures/texture_use.h"

namespace prefilter {
namespace {

constexpr double kCoverageTolerance = 1e-3;
constexpr int kMinLookupsPerTexel = 8;  // along each axis
constexpr int kFinestGrid = 4096;
constexpr int kCoarsestGrid = 512;
constexpr int kBendHalvings = 14;
constexpr double kSmallestBend = 1.0 / (1 << kBendHalvings);
constexpr double kJumpMargins[] = {1.0 / 16, 1.0 / 64, 1.0 / 256};  // from a jump of the coverage

int grid_side(int texels) {
  constexpr auto kFinest = static_cast<unsigned>(kFinestGrid);
  return std::max(
      kCoarsestGrid,
      static_cast<int>(std::bit_ceil(std::min(static_cast<unsigned>(texels), kFinest))));
}

// Maps alpha by a piecewise linear curve through (0, 0), (bend, threshold) and (1, 1). A bend below
// 0 makes every alpha above 0 pass the test and lifts the value at 0, up to the threshold for a
// bend of -1.
class AlphaCurve {
 public:
  AlphaCurve(double bend, double threshold) {
    const double inside = std::clamp(bend, kSmallestBend, 1.0 - kSmallestBend);
    bend_ = static_cast<float>(inside);
    below_ = static_cast<float>(threshold / inside);
    above_ = static_cast<float>((1.0 - threshold) / (1.0 - inside));
    least_ = static_cast<float>(-bend * threshold);
  }
  float operator()(float alpha) const {
    const float apply_curve = alpha <= bend_ ? alpha * below_ : 1.0F - (1.0F - alpha) * above_;
    return std::max(apply_curve, least_);
  }

 private:
  float bend_, below_, above_, least_;
};

class CoverageKeeper {
 public:
  CoverageKeeper(const std::vector<ImageView>& levels, const std::vector<const Surface*>& surfaces,
                 const CoverageOptions& options)
      : levels_(levels), options_(options) {
    const int width = grid_side(levels[0].width);
    const int height = grid_side(levels[0].height);
    areas_ = surfaces.empty()
                 ? Image(width, height, 1, 1.0F)
                 : texel_weights(surfaces, width, height, options.wrap, options.run.part(0.0, 0.3));
  }

  std::vector<Image> run() {
    target_share_ = share(alpha_of(levels_[0]), 0.3);
    std::vector<Image> adjusted;
    double done = 0.4;
    for (std::size_t k = 1; k < levels_.size(); ++k) {
      make_areas_coarser(levels_[k]);
      adjusted.push_back(keep(levels_[k], done));
      // Each level has a quarter of the texels of the one before.
      done += 0.75 * (1.0 - done);
    }
    options_.run.report(1.0);
    return adjusted;
  }

 private:
  // The number of calls per level is unknown in advance, so progress rises only between levels.
  double share(const Image& alpha, double done) const {
    const auto samples = [](int texels, int cells) {
      return static_cast<int>(
          range_count(static_cast<std::int64_t>(kMinLookupsPerTexel) * texels, cells));
    };
    return covered_share(
        alpha.view(), areas_.view(),
        std::max(samples(alpha.width, areas_.width), samples(alpha.height, areas_.height)),
        static_cast<float>(options_.threshold), options_.wrap, options_.run.part(done, done));
  }

  // Calls use(texel of the image, alpha) for each texel.
  template <typename Texels, typename Use>
  void for_each(Texels* image, Image* alpha, const Use& use) const {
    parallel_for(image->height, Run(options_.run.threads()), [&](std::int64_t row) {
      auto* texel = image->texel(0, static_cast<int>(row));
      float* value = alpha->texel(0, static_cast<int>(row));
      for (int x = 0; x < image->width; ++x, texel += image->channels) use(texel, value + x);
    });
  }

  Image alpha_of(const ImageView& level) const {
    Image alpha(level.width, level.height, 1);
    const int last = level.channels - 1;
    for_each(&level, &alpha, [last](const float* texel, float* value) { *value = texel[last]; });
    return alpha;
  }

  Image apply_curve(const Image& alpha, double bend) const {
    Image result(alpha.width, alpha.height, 1);
    const AlphaCurve curve(bend, options_.threshold);
    for_each(&alpha, &result, [&](const float* from, float* to) { *to = curve(*from); });
    return result;
  }

  Image keep(const ImageView& level, double done) const {
    Image alpha = alpha_of(level);
    for (float& value : alpha.data) value = std::clamp(value, 0.0F, 1.0F);
    Image adjusted(level);
    const double unchanged = share(alpha, done);
    if (std::abs(unchanged - target_share_) <= kCoverageTolerance) return adjusted;
    const double bend = find_bend(alpha, unchanged, done);
    const AlphaCurve curve(bend, options_.threshold);
    const int last = level.channels - 1;
    const int colors = options_.premultiplied ? last : 0;
    for_each(&adjusted, &alpha, [&](float* texel, const float* value) {
      texel[last] = curve(*value);
      const float scale = texel[last] / (*value > 0.0F ? *value : 1.0F);
      for (int c = 0; c < colors; ++c) texel[c] *= scale;
    });
    return adjusted;
  }

  // The bend with the target share. The threshold itself is the identity, whose share is
  // `unchanged`. The share falls as the bend rises, possibly in jumps. If the target lies in a
  // jump, picks the closer side, and keeps a margin to the jump so that rounding to bytes does not
  // cross it.
  double find_bend(const Image& alpha, double unchanged, double done) const {
    const auto share_of = [&](double bend) { return share(apply_curve(alpha, bend), done); };
    const bool shows_too_little = unchanged < target_share_;
    double ends[] = {shows_too_little ? -1.0 : options_.threshold,
                     shows_too_little ? options_.threshold : 1.0};
    double shares[] = {shows_too_little ? 1.0 : unchanged,
                       shows_too_little ? unchanged : share_of(1.0)};
    for (int k = 0; k < kBendHalvings; ++k) {
      const double middle = (ends[0] + ends[1]) / 2.0;
      const double coverage = share_of(middle);
      if (std::abs(coverage - target_share_) <= kCoverageTolerance) return middle;
      const int side = coverage > target_share_ ? 0 : 1;
      ends[side] = middle;
      shares[side] = coverage;
    }
    const int side =
        std::abs(shares[1] - target_share_) < std::abs(shares[0] - target_share_) ? 1 : 0;
    for (const double margin : kJumpMargins) {
      const double bend = std::clamp(ends[side] + (side == 0 ? -margin : margin), -1.0, 1.0);
      if (std::abs(share_of(bend) - shares[side]) <= kCoverageTolerance) return bend;
    }
    return ends[side];
  }

  // Uses the coarsest grid that still has enough lookups for the level.
  void make_areas_coarser(const ImageView& level) {
    const auto can_halve = [](int cells, int texels) {
      return cells / 2 >= std::max(kMinLookupsPerTexel * texels, kCoarsestGrid);
    };
    while (can_halve(areas_.width, level.width)) halve_areas(2, 1);
    while (can_halve(areas_.height, level.height)) halve_areas(1, 2);
  }

  void halve_areas(int columns, int rows) {
    Image halves(areas_.width / columns, areas_.height / rows, 1);
    for (int y = 0; y < halves.height; ++y) {
      for (int x = 0; x < halves.width; ++x) {
        *halves.texel(x, y) = *areas_.texel(x * columns, y * rows) +
                              *areas_.texel((x + 1) * columns - 1, (y + 1) * rows - 1);
      }
    }
    areas_ = std::move(halves);
  }

  const std::vector<ImageView>& levels_;
  const CoverageOptions& options_;
  Image areas_;  // of the surface, in each cell of a grid over the texture
  double target_share_ = 0.0;
};

bool has_finite_alpha(const ImageView& level, int threads) {
  std::atomic<bool> result{true};
  parallel_for(level.height, Run(threads), [&](std::int64_t y) {
    const float* alpha = level.texel(0, static_cast<int>(y)) + level.channels - 1;
    for (int x = 0; x < level.width; ++x, alpha += level.channels) {
      if (!std::isfinite(*alpha)) result.store(false);
    }
  });
  return result.load();
}

void check(const std::vector<ImageView>& levels, const CoverageOptions& options) {
  if (levels.empty()) throw_invalid("levels: none were given; at least level 0 is needed");
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const int channels = levels[k].channels;
    if ((channels != 1 && channels != 4) || channels != levels[0].channels) {
      throw_invalid("levels: level " + std::to_string(k) + " has " + std::to_string(channels) +
                    " channels; all need 4, the last of them alpha, or all 1");
    }
    if (k > 0 && !has_finite_alpha(levels[k], options.run.threads())) {
      throw_invalid("levels: level " + std::to_string(k) + " holds alpha that is not finite");
    }
  }
  if (!(options.threshold > 0.0 && options.threshold <= 1.0)) {
    throw_invalid("threshold: " + to_text(options.threshold) +
                  "; a number above 0 and at most 1 is needed");
  }
}

}  // namespace

std::vector<Image> keep_coverage(const std::vector<ImageView>& levels,
                                 const std::vector<const Surface*>& surfaces,
                                 const CoverageOptions& options) {
  check(levels, options);
  return CoverageKeeper(levels, surfaces, options).run();
}

}  // namespace prefilter
