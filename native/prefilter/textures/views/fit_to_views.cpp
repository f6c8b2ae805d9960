// SPDX-License-Identifier: GPL-3.0-or-later

// Renders all views, then solves one least-squares system for all levels.
#include "prefilter/textures/fit_to_views.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/solve/nine_point_system.h"
#include "prefilter/base/text.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/textures/mipmap/argument_checks.h"
#include "prefilter/textures/texels/levels.h"
#include "prefilter/textures/views/view_plan.h"
#include "prefilter/textures/views/view_system.h"

namespace prefilter {
namespace {

constexpr double kMaxEffort = 100.0;
// Weight of a texel's starting value, in frames: a texel seen by as many frames depends equally on
// both.
constexpr double kStartWeightFrames = 20.0;

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
    if (!all_filterable(levels[k], options.run.part(0.0, 0.01))) {
      throw_invalid("levels: level " + std::to_string(k) +
                    " has a value that is not finite, or beyond 1e30");
    }
  }
  if (!(options.steadiness >= 0.0) || !std::isfinite(options.steadiness)) {
    throw_invalid("steadiness: " + to_text(options.steadiness) + "; 0 or more is needed");
  }
  if (!(options.effort > 0.0 && options.effort <= kMaxEffort)) {
    throw_invalid("effort: " + to_text(options.effort) +
                  "; a number above 0 and up to 100 is needed");
  }
  range_of(options.bounds);
}

// The level as it is filtered: multiplied by its alpha if there is any transparency, always if
// `is_multiplied`.
std::unique_ptr<FilteredImage> filtered(const TexelSource& level, bool is_multiplied,
                                        const ViewFitOptions& options) {
  const bool has_alpha = level.channels == kMaxChannels && !options.premultiplied;
  const auto all = [&] { return std::vector<unsigned char>(level.floats().texel_count(), 1); };
  return std::make_unique<FilteredImage>(
      level, all,
      FilteredImage::Options{.alpha = has_alpha ? std::optional(kMaxChannels - 1) : std::nullopt,
                             .stays_opaque = !is_multiplied,
                             .run = Run(options.run.threads())});
}

SolveOptions solve_options(const FilteredImage& image, const ViewFitOptions& options) {
  SolveOptions solve;
  for (int c = 0; c < image.texels().channels; ++c) {
    solve.ranges[static_cast<std::size_t>(c)] = image.solved_range(c, range_of(options.bounds));
  }
  solve.ranges_times_alpha = image.is_multiplied();
  return solve;
}

// Weights of the starting values of the levels, relative to the frames that filtered_levels them.
std::vector<double> start_weights(const std::vector<View>& views, std::size_t level_count) {
  std::vector<double> frames(level_count + 1);
  for (const View& view : views) {
    // The lookups of an octave mix the levels at its two ends.
    frames[static_cast<std::size_t>(view.octave)] += 1.0;
    frames[static_cast<std::size_t>(view.octave) + 1] += 1.0;
  }
  std::vector<double> weights(level_count);
  for (std::size_t level = 0; level < level_count; ++level) {
    weights[level] = kStartWeightFrames / std::max(1.0, frames[level]);
  }
  return weights;
}

// Renders all views in bands of rows, so that each task needs little memory.
std::vector<ViewPixels> render_views(const std::vector<View>& views,
                                     const std::vector<ImageView>& levels,
                                     const ViewFitOptions& options, const Run& run) {
  constexpr std::int64_t kMaxSamplesPerTask = 1 << 18;
  struct Band {
    const View* view;
    int begin;
    int end;
  };
  std::vector<Band> tasks;
  for (const View& view : views) {
    const std::int64_t samples_per_row =
        static_cast<std::int64_t>(view.size) * view.samples * view.samples;
    const int rows = static_cast<int>(
        std::clamp<std::int64_t>(kMaxSamplesPerTask / samples_per_row, 1, view.size));
    for (int begin = 0; begin < view.size; begin += rows) {
      tasks.push_back({&view, begin, std::min(begin + rows, view.size)});
    }
  }
  std::vector<ViewPixels> rendered(tasks.size());
  parallel_for(static_cast<std::int64_t>(tasks.size()), run, [&](std::int64_t k) {
    const auto& [view, begin, end] = tasks[static_cast<std::size_t>(k)];
    rendered[static_cast<std::size_t>(k)] = view_pixels(*view, begin, end, levels, options.wrap);
  });
  return rendered;
}

}  // namespace

std::vector<Image> fit_to_views(const std::vector<ImageView>& levels,
                                const std::vector<const Surface*>& surfaces,
                                const ViewFitOptions& options) {
  check(levels, surfaces, options);
  const ImageView& image = levels[0];
  const std::vector<TexelSource> sources(levels.begin(), levels.end());
  std::vector<std::unique_ptr<FilteredImage>> filtered_levels;
  std::vector<ImageView> start;
  for (const TexelSource& level : sources) {
    filtered_levels.push_back(
        filtered(level, !filtered_levels.empty() && filtered_levels[0]->is_multiplied(), options));
    start.push_back(filtered_levels.back()->floats());
  }
  const std::vector<View> views = plan_views(surfaces, image.width, image.height,
                                             static_cast<int>(levels.size()), options.effort);
  std::vector<ViewPixels> rendered =
      render_views(views, start, options, options.run.part(0.01, 0.3));
  ViewSystem system(start, start_weights(views, levels.size()), std::move(rendered), options,
                    options.run.part(0.3, 0.4));
  std::vector<Image> fitted =
      system.solve(solve_options(*filtered_levels[0], options), options.run.part(0.4, 0.98));
  const ValueRange range = range_of(options.bounds);
  for (Image& level : fitted) {
    filtered_levels[0]->divide_by_alpha(options.wrap, options.run.part(0.98, 0.99), &level);
    for (float& value : level.data) value = std::clamp(value, range.low, range.high);
  }
  options.run.report(1.0);
  return fitted;
}

}  // namespace prefilter
