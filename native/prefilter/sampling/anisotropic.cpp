// SPDX-License-Identifier: GPL-3.0-or-later

// McCormack, Perry, Farkas and Jouppi, "Feline: Fast Elliptical Lines for Anisotropic Texture
// Mapping", 1999, with a different spacing of the probes.
//
// An elliptical Gaussian is a circular one, the probe, convolved with a Gaussian along the major
// axis of width sqrt(major^2 - probe^2). Probes sample the latter; their weights are its values.
// Their spacing minimizes the squared error of the sum: closer ones do not reach far enough, and
// wider ones become visible individually. The error relative to the elliptical Gaussian's norm is
// at most 0.086, on average 0.055, for ratios up to 32. In the paper the outermost probes end with
// the ellipse, and there are round(2 ratio) - 1 of them: errors of 0.56 and 0.17.
#include "prefilter/sampling/anisotropic.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/sampling/probes.h"

namespace prefilter {
namespace {

// Ratio of the axes up to which a single probe of the mean width is used. Its error there is 0.046;
// beyond it two probes have less.
constexpr double kMaxSingleProbeRatio = 1.1;

// Fitted to the optimal spacings for 2 to 63 probes; the error exceeds theirs by at most 5 %.
double optimal_spacing(double ratio, int count) {
  return std::sqrt(2.0 * (ratio * ratio - 1.0) / (ratio * count)) * (0.92 - 0.22 / count);
}

// The probes of several samples.
struct Probes {
  std::vector<TexturePlace> coordinates;
  std::vector<double> scales;
  std::vector<double> weights;
  std::vector<std::size_t> ends;  // of each sample's probes

  void clear() {
    coordinates.clear();
    scales.clear();
    weights.clear();
    ends.clear();
  }
};

void add_probes(const TexturePlace& place, const Footprint& footprint, const ProbedPyramid& pyramid,
                Probes* probes) {
  const ProbeRow row = probe_row(footprint, pyramid.max_probes);
  const std::size_t begin = probes->weights.size();
  double sum = 0.0;
  for (int k = 0; k < row.count; ++k) {
    const double distance = (k - 0.5 * (row.count - 1)) * row.spacing;
    probes->coordinates.push_back({place[0] + distance * footprint.direction_x / pyramid.width,
                                   place[1] + distance * footprint.direction_y / pyramid.height});
    probes->scales.push_back(row.width);
    probes->weights.push_back(elementary::exp(-row.falloff * distance * distance));
    sum += probes->weights.back();
  }
  for (std::size_t i = begin; i < probes->weights.size(); ++i) probes->weights[i] /= sum;
  probes->ends.push_back(probes->weights.size());
}

}  // namespace

ProbeRow probe_row(const Footprint& footprint, int max_probes) {
  const double widest_ratio = 0.5 * (max_probes + 1);
  const double width = std::max(footprint.minor, footprint.major / widest_ratio);
  const double ratio = std::max(1.0, footprint.major / width);
  if (max_probes == 1 || ratio <= kMaxSingleProbeRatio)
    return {1, width * std::sqrt(ratio), 0.0, 0.0};
  constexpr double kRounding = 1e-9;
  ProbeRow row;
  row.count = std::clamp(static_cast<int>(std::ceil(2.0 * ratio - kRounding)) - 1, 2, max_probes);
  row.width = width;
  row.spacing = width * optimal_spacing(ratio, row.count);
  row.falloff = std::numbers::pi / (width * width * (ratio * ratio - 1.0));
  return row;
}

void check_probe_count(int max_probes) {
  if (max_probes >= 1 && max_probes <= kMaxProbes) return;
  throw_invalid("max_probes: " + std::to_string(max_probes) + "; a whole number from 1 to " +
                std::to_string(kMaxProbes) + " is needed");
}

void ProbedPyramid::sample(std::span<const TexturePlace> coordinates,
                           std::span<const TextureJacobian> jacobians, float* result) const {
  constexpr std::size_t kSamplesAtOnce = 256;
  Probes probes;
  std::vector<float> values;
  std::vector<double> sums(static_cast<std::size_t>(channels));
  for (std::size_t begin = 0; begin < coordinates.size(); begin += kSamplesAtOnce) {
    const std::size_t end = std::min(begin + kSamplesAtOnce, coordinates.size());
    probes.clear();
    for (std::size_t i = begin; i < end; ++i) {
      add_probes(coordinates[i], footprint_of(jacobians[i], levels - 1), *this, &probes);
    }
    values.resize(probes.weights.size() * sums.size());
    sampler.sample(probes.coordinates, probes.scales, values.data());
    const float* value = values.data();
    std::size_t probe = 0;
    for (const std::size_t last : probes.ends) {
      std::fill(sums.begin(), sums.end(), 0.0);
      for (; probe < last; ++probe) {
        for (double& sum : sums) sum += probes.weights[probe] * *value++;
      }
      for (const double sum : sums) *result++ = static_cast<float>(sum);
    }
  }
}

void sample_anisotropically(const Pyramid& pyramid, const SamplingTable* table,
                            std::span<const TexturePlace> coordinates,
                            std::span<const TextureJacobian> jacobians,
                            const AnisotropicOptions& options, std::span<float> result) {
  const PyramidSampler sampler(pyramid, table, options.wrap);
  check_coordinates(coordinates);
  check_jacobians(jacobians, coordinates.size());
  check_probe_count(options.max_probes);
  const ProbedPyramid probed{sampler,
                             pyramid.levels[0].width,
                             pyramid.levels[0].height,
                             static_cast<int>(pyramid.levels.size()),
                             pyramid.channels,
                             options.max_probes};
  constexpr std::int64_t kSamplesAtOnce = 1 << 10;
  parallel_ranges(static_cast<std::int64_t>(coordinates.size()), kSamplesAtOnce, options.run,
                  [&](std::int64_t begin, std::int64_t end) {
                    const auto count = static_cast<std::size_t>(end - begin);
                    probed.sample(coordinates.subspan(begin, count),
                                  jacobians.subspan(begin, count),
                                  result.data() + begin * pyramid.channels);
                  });
  options.run.report(1.0);
}

}  // namespace prefilter
