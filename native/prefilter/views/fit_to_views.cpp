// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/views/fit_to_views.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/texels/levels.h"
#include "prefilter/views/view_plan.h"
#include "prefilter/views/view_system.h"

namespace prefilter {
namespace {

constexpr int kAlpha = 3;
constexpr double kMostEffort = 100.0;
// What a texel that few views read is worth: as much as so many frames that say what it was before.
constexpr double kFramesOfPull = 20.0;

void check(const std::vector<ImageView>& levels, const std::vector<const Surface*>& surfaces,
           const ViewFitOptions& options) {
  if (levels.empty()) throw_invalid("levels: none; at least one is needed");
  if (surfaces.empty()) throw_invalid("surface: none; at least one is needed");
  check_channels(levels[0], "levels: level 0");
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const int level = static_cast<int>(k);
    const int width = level_size(levels[0].width, level);
    const int height = level_size(levels[0].height, level);
    if (levels[k].width != width || levels[k].height != height ||
        levels[k].channels != levels[0].channels) {
      throw_invalid("levels: level " + std::to_string(k) + " has " +
                    std::to_string(levels[k].width) + " x " + std::to_string(levels[k].height) +
                    " texels of " + std::to_string(levels[k].channels) + " channels; " +
                    std::to_string(width) + " x " + std::to_string(height) + " of " +
                    std::to_string(levels[0].channels) + " are needed");
    }
    if (!all_filterable(levels[k], options.progress.part(0.0, 0.01), options.threads)) {
      throw_invalid("levels: level " + std::to_string(k) +
                    " has a value that is not finite, or beyond 1e30");
    }
  }
  if (!(options.steadiness >= 0.0) || !std::isfinite(options.steadiness)) {
    throw_invalid("steadiness: " + to_text(options.steadiness) + "; 0 or more is needed");
  }
  if (!(options.effort > 0.0 && options.effort <= kMostEffort)) {
    throw_invalid("effort: " + to_text(options.effort) +
                  "; a number above 0 and up to 100 is needed");
  }
  if (options.bounds.low && options.bounds.high && !(*options.bounds.low <= *options.bounds.high)) {
    throw_invalid("bounds: the low one is above the high one");
  }
}

bool is_straight(const ImageView& image, const ViewFitOptions& options) {
  return image.channels == kMaxChannels && !options.premultiplied;
}

Image multiplied(const ImageView& image) {
  Image result(image);
  for (std::size_t i = 0; i < image.texel_count(); ++i) {
    float* const texel = result.data.data() + i * kMaxChannels;
    for (int c = 0; c < kAlpha; ++c) texel[c] *= texel[kAlpha];
  }
  return result;
}

// Colors of texels that are not covered stay as they were.
void divide(const ImageView& before, const Bounds& bounds, Image* level) {
  constexpr float kLeast = 1e-4F;
  for (std::size_t i = 0; i < before.texel_count(); ++i) {
    float* const texel = level->data.data() + i * kMaxChannels;
    for (int c = 0; c < kAlpha; ++c) {
      texel[c] = texel[kAlpha] > kLeast
                     ? texel[c] / texel[kAlpha]
                     : before.data[i * kMaxChannels + static_cast<std::size_t>(c)];
      if (bounds.low) texel[c] = std::max(texel[c], *bounds.low);
      if (bounds.high) texel[c] = std::min(texel[c], *bounds.high);
    }
  }
}

LaneRange range_of(const Bounds& bounds, bool has_alpha) {
  LaneRange range;
  for (int c = 0; c < kMaxChannels; ++c) {
    range.low[c] = bounds.low.value_or(-kLargestValue);
    range.high[c] = bounds.high.value_or(kLargestValue);
  }
  if (has_alpha) {
    range.low[kAlpha] = 0.0F;
    range.high[kAlpha] = 1.0F;
  }
  return range;
}

// The more frames look at a level, the less what it was before counts.
std::vector<double> pulls_of(const std::vector<View>& views, std::size_t level_count) {
  std::vector<double> frames(level_count + 1);
  for (const View& view : views) {
    // An octave looks up the levels at its two ends.
    frames[static_cast<std::size_t>(view.octave)] += 1.0;
    frames[static_cast<std::size_t>(view.octave) + 1] += 1.0;
  }
  std::vector<double> pulls(level_count);
  for (std::size_t level = 0; level < level_count; ++level) {
    pulls[level] = kFramesOfPull / std::max(1.0, frames[level]);
  }
  return pulls;
}

// What views see, by rows of their frames: what is to be done at a time is little then.
std::vector<SeenPixels> all_seen(const std::vector<View>& views,
                                 const std::vector<ImageView>& levels,
                                 const ViewFitOptions& options, const Progress& progress) {
  constexpr std::int64_t kMostSamples = 1 << 20;
  struct Rows {
    const View* view;
    int begin;
    int end;
  };
  std::vector<Rows> tasks;
  for (const View& view : views) {
    const std::int64_t of_row = static_cast<std::int64_t>(view.size) * view.samples * view.samples;
    const int rows =
        static_cast<int>(std::clamp<std::int64_t>(kMostSamples / of_row, 1, view.size));
    for (int begin = 0; begin < view.size; begin += rows) {
      tasks.push_back({&view, begin, std::min(begin + rows, view.size)});
    }
  }
  std::vector<SeenPixels> seen(tasks.size());
  parallel_for(
      static_cast<std::int64_t>(tasks.size()), options.threads, progress, [&](std::int64_t k) {
        const auto& [view, begin, end] = tasks[static_cast<std::size_t>(k)];
        seen[static_cast<std::size_t>(k)] = seen_pixels(*view, begin, end, levels, options.wrap);
      });
  return seen;
}

}  // namespace

std::vector<Image> fit_to_views(const std::vector<ImageView>& levels,
                                const std::vector<const Surface*>& surfaces,
                                const ViewFitOptions& options) {
  check(levels, surfaces, options);
  const ImageView& image = levels[0];
  const bool has_alpha = is_straight(image, options);
  std::vector<Image> owned;
  std::vector<ImageView> start = levels;
  if (has_alpha) {
    for (ImageView& level : start) {
      owned.push_back(multiplied(level));
      level = owned.back().view();
    }
  }
  const std::vector<View> views = plan_views(surfaces, image.width, image.height,
                                             static_cast<int>(levels.size()), options.effort);
  std::vector<SeenPixels> seen = all_seen(views, start, options, options.progress.part(0.01, 0.3));
  ViewSystem system(start, pulls_of(views, levels.size()), std::move(seen), options,
                    options.progress.part(0.3, 0.4));
  std::vector<Image> fitted =
      system.solve(range_of(options.bounds, has_alpha), options.progress.part(0.4, 1.0));
  if (has_alpha) {
    for (std::size_t k = 0; k < fitted.size(); ++k) {
      divide(levels[k + 1], options.bounds, &fitted[k]);
    }
  }
  options.progress.report(1.0);
  return fitted;
}

}  // namespace prefilter
