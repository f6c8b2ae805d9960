// SPDX-License-Identifier: GPL-3.0-or-later

// Greene and Heckbert, "Creating Raster Omnimax Images from Multiple Perspective Views Using the
// Elliptical Weighted Average Filter", 1986, applied to level 0 only.
#include "prefilter/sampling/elliptical.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "prefilter/base/elementary.h"
#include "prefilter/base/geometry.h"
#include "prefilter/base/parallel.h"
#include "prefilter/sampling/footprint.h"

namespace prefilter {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kGaussianRadius = 2.0 * std::numbers::sqrt2;

// An equivalent position near the image, in texels: it has the same texels at the same distances.
double near_image(double place, double reach, int size, Wrap mode) {
  if (mode == Wrap::kRepeat) return (place - std::floor(place)) * size;
  const double x = std::clamp(place, -kLargestCoordinate, kLargestCoordinate) * size;
  const double texel = std::floor(x);
  const double outside = std::ceil(reach) + 2.0;
  return std::clamp(texel, -outside, size + outside) + (x - texel);
}

// exp(-pi (a x^2 + 2 b x y + c y^2)) around (x, y).
struct Gaussian {
  double x, y;
  double a, b, c;
  double height;  // half the height of the truncated ellipse

  Gaussian(const ImageView& image, const TexturePlace& place, const Footprint& shape,
           WrapModes wrap) {
    const double along = 1.0 / (shape.major * shape.major);
    const double across = 1.0 / (shape.minor * shape.minor);
    const double dx = shape.direction_x;
    const double dy = shape.direction_y;
    a = along * dx * dx + across * dy * dy;
    b = (along - across) * dx * dy;
    c = along * dy * dy + across * dx * dx;
    height = kGaussianRadius * elementary::hypot(shape.major * dy, shape.minor * dx);
    const double width = kGaussianRadius * elementary::hypot(shape.major * dx, shape.minor * dy);
    x = near_image(place[0], width, image.width, wrap.u);
    y = near_image(place[1], height, image.height, wrap.v);
  }

  int first_row() const { return static_cast<int>(std::ceil(y - height - 0.5)); }
  int end_row() const { return static_cast<int>(std::floor(y + height - 0.5)) + 1; }
};

// Adds the texels of a row: the weighted sums of channels, followed by the sum of weights.
void add_row(const ImageView& image, const Gaussian& gaussian, WrapModes wrap, int row,
             double* sums) {
  const double dy = row + 0.5 - gaussian.y;
  // a x^2 + 2 b x y + c y^2 = radius^2
  const double middle = -gaussian.b / gaussian.a * dy;
  const double rest = kGaussianRadius * kGaussianRadius -
                      (gaussian.c - gaussian.b * gaussian.b / gaussian.a) * dy * dy;
  if (rest < 0.0) return;
  const double half = std::sqrt(rest / gaussian.a);
  const int first = static_cast<int>(std::ceil(gaussian.x + middle - half - 0.5));
  const int last = static_cast<int>(std::floor(gaussian.x + middle + half - 0.5));
  const int read_row = wrap_index(row, image.height, wrap.v);
  const auto exponent = [&](double dx) {
    return -kPi * (gaussian.a * dx * dx + 2.0 * gaussian.b * dx * dy + gaussian.c * dy * dy);
  };
  // The ratio of neighboring weights changes by a constant factor from texel to texel. The
  // recurrence restarts after each run, as rounding errors accumulate.
  constexpr int kTexelsPerRun = 256;
  const double change = elementary::exp(-2.0 * kPi * gaussian.a);
  for (int begin = first; begin <= last; begin += kTexelsPerRun) {
    const double dx = begin + 0.5 - gaussian.x;
    double weight = elementary::exp(exponent(dx));
    double quotient = elementary::exp(exponent(dx + 1.0) - exponent(dx));
    for (int i = begin; i <= std::min(last, begin + kTexelsPerRun - 1); ++i) {
      sums[image.channels] += weight;
      const int column = wrap_index(i, image.width, wrap.u);
      if (column >= 0 && read_row >= 0) {
        const float* texel = image.texel(column, read_row);
        for (int c = 0; c < image.channels; ++c) sums[c] += weight * texel[c];
      }
      weight *= quotient;
      quotient *= change;
    }
  }
}

// Computes a few samples. In large images a single one may take long, so its rows are divided among
// tasks whose sums are added in order.
void add_samples(const ImageView& image, std::span<const TexturePlace> coordinates,
                 std::span<const TextureJacobian> jacobians, const EllipticalOptions& options,
                 const Run& run, float* values) {
  constexpr std::size_t kTexelsPerBand = 1 << 17;
  constexpr std::size_t kTexelsPerTask = 1 << 16;
  const auto longest = static_cast<unsigned>(std::max(image.width, image.height));
  const int last_level = static_cast<int>(std::bit_width(longest - 1));  // of sampling_levels
  const auto channels = static_cast<std::size_t>(image.channels);
  const auto bands = static_cast<std::int64_t>(1 + image.texel_count() / kTexelsPerBand);
  const auto items = static_cast<std::int64_t>(coordinates.size()) * bands;
  const auto at_once = static_cast<std::int64_t>(
      std::clamp<std::size_t>(kTexelsPerTask / image.texel_count(), 1, 64));
  std::vector<double> sums(static_cast<std::size_t>(items) * (channels + 1));
  parallel_ranges(items, at_once, run, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t item = begin; item < end; ++item) {
      const auto sample = static_cast<std::size_t>(item / bands);
      const Gaussian gaussian(image, coordinates[sample],
                              footprint_of(jacobians[sample], last_level), options.wrap);
      const std::int64_t rows = gaussian.end_row() - gaussian.first_row();
      const std::int64_t band = item % bands;
      for (std::int64_t row = rows * band / bands; row < rows * (band + 1) / bands; ++row) {
        add_row(image, gaussian, options.wrap, gaussian.first_row() + static_cast<int>(row),
                sums.data() + static_cast<std::size_t>(item) * (channels + 1));
      }
    }
  });
  std::vector<double> total(channels + 1);
  const double* sum = sums.data();
  for (std::size_t sample = 0; sample < coordinates.size(); ++sample) {
    std::fill(total.begin(), total.end(), 0.0);
    for (std::int64_t band = 0; band < bands; ++band) {
      for (double& value : total) value += *sum++;
    }
    for (std::size_t c = 0; c < channels; ++c) {
      *values++ = static_cast<float>(total[c] / total[channels]);
    }
  }
}

}  // namespace

std::vector<float> sample_elliptically(const ImageView& image,
                                       std::span<const TexturePlace> coordinates,
                                       std::span<const TextureJacobian> jacobians,
                                       const EllipticalOptions& options) {
  check_coordinates(coordinates);
  check_jacobians(jacobians, coordinates.size());
  const auto channels = static_cast<std::size_t>(image.channels);
  const std::size_t count = coordinates.size();
  std::vector<float> values(count * channels);
  constexpr std::size_t kSamplesAtOnce = 1 << 12;
  for (std::size_t begin = 0; begin < count; begin += kSamplesAtOnce) {
    const std::size_t size = std::min(kSamplesAtOnce, count - begin);
    const auto fraction_of = [&](std::size_t samples) {
      return static_cast<double>(samples) / static_cast<double>(count);
    };
    add_samples(image, coordinates.subspan(begin, size), jacobians.subspan(begin, size), options,
                options.run.part(fraction_of(begin), fraction_of(begin + size)),
                values.data() + begin * channels);
  }
  options.run.report(1.0);
  return values;
}

}  // namespace prefilter
