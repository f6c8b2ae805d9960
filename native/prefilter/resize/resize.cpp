// SPDX-License-Identifier: GPL-3.0-or-later

// Sections 1.1 and 1.1.2: images are filtered in linear light, before they are sampled.
#include "prefilter/resize/resize.h"

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
#include "prefilter/filters/filtered_image.h"
#include "prefilter/filters/separable.h"
#include "prefilter/resize/bilinear_fit.h"
#include "prefilter/resize/radial.h"

namespace prefilter {
namespace {

constexpr int kMostTexels = 1 << 20;  // along a side

void check_size(const char* name, int size) {
  if (size < 1 || size > kMostTexels) {
    throw_invalid(std::string(name) + ": " + std::to_string(size) + "; a whole number from 1 to " +
                  std::to_string(kMostTexels) + " is needed");
  }
}

void check_arguments(const ImageView& image, int width, int height, const ResizeOptions& options) {
  check_channels(image);
  check_size("width", width);
  check_size("height", height);
  if (options.threads < 0) {
    throw_invalid("threads: " + std::to_string(options.threads) +
                  "; a positive number is needed, or 0 for all processors");
  }
  // Filtering along one axis first leaves no more in between than the larger of the two images.
  const double texels = static_cast<double>(width) * height;
  const double most = std::max(texels, static_cast<double>(image.texel_count()));
  constexpr double kBytesPerSolvedTexel = 56.0;
  const bool is_fit = std::holds_alternative<BilinearFit>(options.filter);
  check_memory(
      "width, height: an image of " + std::to_string(width) + " x " + std::to_string(height) +
          " texels",
      4.0 * image.channels * (texels + most) + (is_fit ? kBytesPerSolvedTexel * texels : 0.0));
}

// The channel of coverage.
std::optional<int> alpha_channel(int channels, bool premultiplied) {
  if (premultiplied || (channels != 2 && channels != 4)) return std::nullopt;
  return channels - 1;
}

class Resizer {
 public:
  Resizer(const FilteredImage& image, int width, int height, const ResizeOptions& options)
      : image_(image), width_(width), height_(height), options_(options) {}

  Image operator()(const Kernel* kernel) const {
    return filter_separably(image_.floats(), width_, height_, *kernel, options_.wrap, progress(),
                            options_.threads);
  }
  Image operator()(const RadialFilter& filter) const {
    return filter_radially(image_.floats(), width_, height_, filter.radius, options_.wrap,
                           progress(), options_.threads);
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
    solve.threads = options_.threads;
    return fit_bilinearly(image_.floats(), width_, height_, options_.wrap, solve, progress());
  }

 private:
  Progress progress() const { return options_.progress.part(0.1, 0.9); }

  const FilteredImage& image_;
  int width_;
  int height_;
  const ResizeOptions& options_;
};

}  // namespace

Image resize(const ImageView& image, int width, int height, const ResizeOptions& options) {
  check_arguments(image, width, height, options);
  const bool is_same_size = width == image.width && height == image.height;
  const TexelSource source(image);
  const FilteredImage filtered(
      source, [&] { return std::vector<unsigned char>(image.texel_count(), 1); },
      {.alpha = is_same_size ? std::nullopt : alpha_channel(image.channels, options.premultiplied),
       .threads = options.threads,
       .progress = options.progress.part(0.0, 0.1)});
  Image result = is_same_size
                     ? Image(image)
                     : std::visit(Resizer(filtered, width, height, options), options.filter);
  filtered.divide_by_alpha(options.wrap, options.progress.part(0.9, 1.0), options.threads, &result);
  if (options.constrained) {
    parallel_for(height, options.threads, Progress(), [&](std::int64_t y) {
      float* const row = result.texel(0, static_cast<int>(y));
      std::transform(row, row + static_cast<std::ptrdiff_t>(width) * result.channels, row,
                     [](float value) { return std::clamp(value, 0.0F, 1.0F); });
    });
  }
  options.progress.report(1.0);
  return result;
}

}  // namespace prefilter
