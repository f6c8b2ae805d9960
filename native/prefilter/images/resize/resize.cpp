// SPDX-License-Identifier: GPL-3.0-or-later

// Sections 1.1 and 1.1.2: filters images in linear light before sampling.
#include "prefilter/images/resize.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/value_range.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/images/filters/separable.h"
#include "prefilter/images/filters/separable_bytes.h"
#include "prefilter/images/resize/bilinear_fit.h"
#include "prefilter/images/resize/radial.h"
#include "prefilter/images/resize/ranges_around.h"

namespace prefilter {
namespace {

constexpr int kMaxResizedSide = 1 << 20;  // along a side

void check_size(const char* name, int size) {
  if (size < 1 || size > kMaxResizedSide) {
    throw_invalid(std::string(name) + ": " + std::to_string(size) + "; a whole number from 1 to " +
                  std::to_string(kMaxResizedSide) + " is needed");
  }
}

bool limits_ringing(const ResizeOptions& options) {
  const bool is_fit = std::holds_alternative<BilinearFit>(options.filter);
  return options.ringing == Ringing::kLimit || (options.ringing == Ringing::kAuto && is_fit);
}

void check_arguments(const TexelSource& image, int width, int height,
                     const ResizeOptions& options) {
  check_channels({nullptr, image.width, image.height, image.channels});
  check_size("width", width);
  check_size("height", height);
  if (options.run.threads() < 0) {
    throw_invalid("threads: " + std::to_string(options.run.threads()) +
                  "; a positive number is needed, or 0 for all processors");
  }
  // The intermediate image after filtering one axis is no larger than the larger of both images.
  const double texels = static_cast<double>(width) * height;
  const double most = std::max(texels, static_cast<double>(image.width) * image.height);
  constexpr double kBytesPerSolvedTexel = 56.0;
  constexpr double kBytesPerLimitedTexel = 32.0;
  const bool is_fit = std::holds_alternative<BilinearFit>(options.filter);
  const bool is_limited = limits_ringing(options);
  check_memory("width, height: an image of " + std::to_string(width) + " x " +
                   std::to_string(height) + " texels",
               4.0 * image.channels * (texels + most) +
                   (is_fit ? kBytesPerSolvedTexel * texels : 0.0) +
                   (is_limited ? (kBytesPerLimitedTexel + 8.0 * image.channels) * texels : 0.0));
}

// The index of the coverage channel, if any.
std::optional<int> alpha_channel(int channels, bool premultiplied) {
  if (premultiplied || (channels != 2 && channels != 4)) return std::nullopt;
  return channels - 1;
}

class Resizer {
 public:
  /// `around` is null unless ringing is limited.
  Resizer(const FilteredImage& image, const RangesAround* around, int width, int height,
          const ResizeOptions& options)
      : image_(image), around_(around), width_(width), height_(height), options_(options) {}

  Image operator()(const Kernel* kernel) const {
    if (image_.floats().data == nullptr) {
      return filter_bytes_separably(image_, width_, height_, *kernel, options_.wrap, run());
    }
    return filter_separably(image_.floats(), width_, height_, *kernel, options_.wrap, run());
  }
  Image operator()(const RadialFilter& filter) const {
    return filter_radially(image_.floats(), width_, height_, filter.radius, options_.wrap, run());
  }
  Image operator()(const BilinearFit& /*filter*/) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const ValueRange bounds =
        options_.constrained ? ValueRange{0.0F, 1.0F} : ValueRange{-kInfinity, kInfinity};
    SolveOptions solve;
    for (int c = 0; c < image_.floats().channels; ++c) {
      solve.ranges[c] = image_.solved_range(c, bounds);
    }
    solve.ranges_times_alpha = image_.is_multiplied();
    solve.tolerance = 1e-6;
    return fit_bilinearly(image_.floats(), width_, height_, options_.wrap, solve, around_, run());
  }

 private:
  Run run() const { return options_.run.part(0.1, 0.9); }

  const FilteredImage& image_;
  const RangesAround* around_;
  int width_;
  int height_;
  const ResizeOptions& options_;
};

}  // namespace

Image resize(const TexelSource& image, int width, int height, const ResizeOptions& options) {
  check_arguments(image, width, height, options);
  const bool is_same_size = width == image.width && height == image.height;
  const bool is_limited = !is_same_size && limits_ringing(options);
  const auto* const kernel = std::get_if<const Kernel*>(&options.filter);
  const bool is_read_by_rows = image.has_bytes() && kernel != nullptr && !is_same_size &&
                               reads_few_rows(image, width, height, **kernel);
  const std::optional<int> alpha =
      is_same_size ? std::nullopt : alpha_channel(image.channels, options.premultiplied);
  const std::size_t count = static_cast<std::size_t>(image.width) * image.height;
  const FilteredImage filtered(image, [&] { return std::vector<unsigned char>(count, 1); },
                               {.alpha = alpha,
                                .is_read_by_rows = is_read_by_rows,
                                .run = options.run.part(0.0, is_limited ? 0.05 : 0.1)});
  std::optional<RangesAround> around;
  if (is_limited) {
    around = ranges_around(image, filtered.is_multiplied() ? alpha : std::nullopt, width, height,
                           options.wrap, options.run.part(0.05, 0.1));
  }
  const Resizer resizer(filtered, around ? &*around : nullptr, width, height, options);
  Image result = is_same_size ? Image(filtered.floats()) : std::visit(resizer, options.filter);
  filtered.divide_by_alpha(options.wrap, options.run.part(0.9, 1.0), &result);
  if (around) limit_to(*around, options.run.threads(), &result);
  if (options.constrained) {
    parallel_for(height, Run(options.run.threads()), [&](std::int64_t y) {
      float* const row = result.texel(0, static_cast<int>(y));
      std::transform(row, row + static_cast<std::ptrdiff_t>(width) * result.channels, row,
                     [](float value) { return std::clamp(value, 0.0F, 1.0F); });
    });
  }
  options.run.report(1.0);
  return result;
}

}  // namespace prefilter
