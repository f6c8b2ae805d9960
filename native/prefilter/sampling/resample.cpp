// SPDX-License-Identifier: GPL-3.0-or-later

// Section 6.3: evaluates the filter at the position and scale of each pixel in the image.
#include "prefilter/sampling/resample.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/filterable.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/memory.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"
#include "prefilter/images/filters/filtered_image.h"
#include "prefilter/sampling/elliptical.h"
#include "prefilter/sampling/exact.h"
#include "prefilter/sampling/footprint.h"
#include "prefilter/sampling/probes.h"
#include "prefilter/sampling/pyramid_sampler.h"
#include "prefilter/sampling/sampling_levels.h"

namespace prefilter {
namespace {

using Method = ResampleOptions::Method;

constexpr int kMaxResultSide = 1 << 20;  // along a side

void check_size(const char* name, int size) {
  if (size >= 1 && size <= kMaxResultSide) return;
  throw_invalid(std::string(name) + ": " + std::to_string(size) + "; a whole number from 1 to " +
                std::to_string(kMaxResultSide) + " is needed");
}

void check_arguments(const ImageView& image, const Homography& transform, int width, int height,
                     const ResampleOptions& options) {
  check_channels(image);
  for (const double value : transform) {
    if (std::isfinite(value)) continue;
    throw_invalid("transform: found " + to_text(value) + "; finite numbers are needed");
  }
  check_size("width", width);
  check_size("height", height);
  check_probe_count(options.max_probes);
  if (options.method == Method::kExact && options.max_probes > 1 &&
      options.kernel->name() != "gaussian") {
    throw_invalid("max_probes: " + std::to_string(options.max_probes) + " with exact and filter '" +
                  std::string(options.kernel->name()) +
                  "'; 1 is needed, because only 'gaussian' has exact filters that are not square");
  }
  const double pixels = static_cast<double>(width) * height;
  constexpr double kImageCopies = 3.0;  // of the image, including its levels
  check_memory(
      "width, height: an image of " + std::to_string(width) + " x " + std::to_string(height) +
          " pixels",
      4.0 * image.channels * (pixels + kImageCopies * static_cast<double>(image.texel_count())));
}

// Samples an image at arbitrary positions and shapes, in batches.
class ImageSampler {
 public:
  ImageSampler(const ImageView& image, const ResampleOptions& options, const Run& run)
      : image_(image), options_(options) {
    if (options.method == Method::kExact) return;
    SamplingLevelsOptions level_options;
    level_options.kernel = options.kernel;
    level_options.wrap = options.wrap;
    level_options.premultiplied = true;
    level_options.run = run;
    levels_ = sampling_levels(image, level_options);
    std::vector<PyramidLevel> views;
    for (const Image& level : levels_) {
      views.push_back({level.data.data(), level.width, level.height});
    }
    const Pyramid pyramid(std::move(views), image.channels, false);
    sampler_.emplace(pyramid, options.method == Method::kTable ? options.table : nullptr,
                     options.wrap);
  }

  // Whether a single pixel may take so long that its own work is divided among threads.
  bool is_elliptical() const {
    return options_.method == Method::kExact && options_.max_probes > 1;
  }

  // Number of pixels to sample per batch.
  std::int64_t batch() const {
    constexpr std::int64_t kPixelsPerBatch = 1 << 12;
    constexpr std::int64_t kTexelsPerBatch = 1 << 22;
    if (options_.method != Method::kExact || is_elliptical()) return kPixelsPerBatch;
    return std::clamp<std::int64_t>(
        kTexelsPerBatch / static_cast<std::int64_t>(image_.texel_count()), 1, 64);
  }

  // Reports progress only if is_elliptical().
  void operator()(std::span<const TexturePlace> coordinates,
                  std::span<const TextureJacobian> jacobians, const Run& run, float* values) const {
    if (is_elliptical()) {
      const std::vector<float> found =
          sample_elliptically(image_, coordinates, jacobians, {.wrap = options_.wrap, .run = run});
      std::copy(found.begin(), found.end(), values);
    } else if (options_.method == Method::kExact) {
      for (std::size_t i = 0; i < coordinates.size(); ++i) {
        sample_exactly(image_, *options_.kernel, options_.wrap, coordinates[i],
                       larger_singular_value(jacobians[i]), values + i * image_.channels);
      }
    } else if (options_.max_probes > 1) {
      const ProbedPyramid probed{*sampler_,       image_.width,
                                 image_.height,   static_cast<int>(levels_.size()),
                                 image_.channels, options_.max_probes};
      probed.sample(coordinates, jacobians, values);
    } else {
      sampler_->sample(coordinates, scales_of(jacobians), values);
    }
  }

 private:
  // Affine maps have the same scale everywhere.
  static std::vector<double> scales_of(std::span<const TextureJacobian> jacobians) {
    std::vector<double> scales;
    scales.reserve(jacobians.size());
    for (std::size_t i = 0; i < jacobians.size(); ++i) {
      scales.push_back(i > 0 && jacobians[i] == jacobians[i - 1]
                           ? scales.back()
                           : larger_singular_value(jacobians[i]));
    }
    return scales;
  }

  const ImageView image_;
  const ResampleOptions& options_;
  std::vector<Image> levels_;
  std::optional<PyramidSampler> sampler_;  // not for exact samples
};

// Resamples pixels [begin, end), in row-major order. Pixels beyond the horizon are left unchanged.
void resample_pixels(const ImageSampler& sampler, const ImageView& image,
                     const Homography& transform, std::int64_t begin, std::int64_t end,
                     const Run& run, Image* result) {
  std::vector<TexturePlace> coordinates;
  std::vector<TextureJacobian> jacobians;
  std::vector<std::int64_t> pixels;
  for (std::int64_t pixel = begin; pixel < end; ++pixel) {
    const PixelPlace place =
        pixel_place(transform, static_cast<int>(pixel % result->width),
                    static_cast<int>(pixel / result->width), image.width, image.height);
    if (!place.is_visible) continue;
    coordinates.push_back(place.coordinates);
    jacobians.push_back(place.jacobian);
    pixels.push_back(pixel);
  }
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<float> values(pixels.size() * channels);
  sampler(coordinates, jacobians, run, values.data());
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    std::copy_n(values.data() + i * channels, channels,
                result->data.data() + static_cast<std::size_t>(pixels[i]) * channels);
  }
}

void clear_beyond_horizon(const ImageView& image, const Homography& transform, int threads,
                          Image* result) {
  parallel_for(result->height, Run(threads), [&](std::int64_t row) {
    for (int column = 0; column < result->width; ++column) {
      const int y = static_cast<int>(row);
      if (pixel_place(transform, column, y, image.width, image.height).is_visible) continue;
      std::fill_n(result->texel(column, y), result->channels, 0.0F);
    }
  });
}

bool has_border(WrapModes wrap) { return wrap.u == Wrap::kBorder || wrap.v == Wrap::kBorder; }

}  // namespace

PixelPlace pixel_place(const Homography& transform, int column, int row, int image_width,
                       int image_height) {
  const double i = column + 0.5;
  const double j = row + 0.5;
  const auto& t = transform;
  const double w = t[6] * i + t[7] * j + t[8];
  if (!(w > 0.0)) return {};
  const double x = (t[0] * i + t[1] * j + t[2]) / w;
  const double y = (t[3] * i + t[4] * j + t[5]) / w;
  PixelPlace place;
  place.coordinates = {x / image_width, y / image_height};
  place.jacobian = {(t[0] - x * t[6]) / w, (t[1] - x * t[7]) / w, (t[3] - y * t[6]) / w,
                    (t[4] - y * t[7]) / w};
  const auto is_usable = [](double value) { return std::abs(value) <= kLargestCoordinate; };
  place.is_visible = std::all_of(place.coordinates.begin(), place.coordinates.end(), is_usable) &&
                     std::all_of(place.jacobian.begin(), place.jacobian.end(), is_usable);
  return place;
}

Image resample(const ImageView& image, const Homography& transform, int width, int height,
               const ResampleOptions& options) {
  check_arguments(image, transform, width, height, options);
  const bool has_alpha = !options.premultiplied && (image.channels == 2 || image.channels == 4);
  const TexelSource source(image);
  const Stages stages(options.run, {1, 4, 13, 2});
  const FilteredImage filtered(
      source, [&] { return std::vector<unsigned char>(image.texel_count(), 1); },
      {.alpha = has_alpha ? std::optional<int>(image.channels - 1) : std::nullopt,
       .stays_opaque = !has_border(options.wrap),
       .run = stages[0]});
  const ImageSampler sampler(filtered.floats(), options, stages[1]);
  Image result(width, height, image.channels);
  const std::int64_t pixels = static_cast<std::int64_t>(width) * height;
  const Run sampling = stages[2];
  const auto resample_range = [&](std::int64_t begin, std::int64_t end, const Run& run) {
    resample_pixels(sampler, filtered.floats(), transform, begin, end, run, &result);
  };
  if (sampler.is_elliptical()) {
    const auto fraction_of = [&](std::int64_t pixel) {
      return static_cast<double>(pixel) / static_cast<double>(pixels);
    };
    for (std::int64_t begin = 0; begin < pixels; begin += sampler.batch()) {
      const std::int64_t end = std::min(begin + sampler.batch(), pixels);
      resample_range(begin, end, sampling.part(fraction_of(begin), fraction_of(end)));
    }
  } else {
    parallel_ranges(pixels, sampler.batch(), sampling, [&](std::int64_t begin, std::int64_t end) {
      resample_range(begin, end, Run());
    });
  }
  if (filtered.is_multiplied()) {
    filtered.divide_by_alpha(WrapModes(), stages[3], &result);
    clear_beyond_horizon(image, transform, options.run.threads(), &result);
  }
  options.run.report(1.0);
  return result;
}

}  // namespace prefilter
