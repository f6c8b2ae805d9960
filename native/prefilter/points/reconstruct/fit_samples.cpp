// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/fit_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "prefilter/points/normals/local_plane.h"

namespace prefilter {
namespace {

constexpr int kMoveRounds = 2;  // iterations of moving a vertex onto the surface around it
// Smallest cosine between the surface normal and the line along which a vertex moves; at grazing
// angles the intersection is ill-conditioned.
constexpr double kMinLineSlope = 0.05;
// Spread of the samples' planes, in cells, up to which samples are trusted over the function; at
// twice this spread they are ignored.
constexpr double kAgreementSpread = 0.06;
// Where the mean normal is shorter than this, normals cancel each other and define no side.
constexpr double kMinFitCoherence = 0.2;
// Mean cosine between two normals of one cell: at or below the first they are noisy, at or above
// the second only curvature makes them differ.
constexpr double kNoisyCosine = 0.86;
constexpr double kCleanCosine = 0.96;
// Weight of the samples' own planes against the plane through their mean: 1/2 is exact on smooth
// surfaces, while at creases the own planes are more accurate.
constexpr double kOwnPlaneWeight = 0.65;
// How many coarser depths are searched where no samples are near, so that spikes are pulled back.
constexpr int kMaxDepthsUp = 4;

// Calls visit(cells, index, corner, mean, weight) for the cells with samples around a point.
template <typename Visit>
void for_weighted(const SampleIndex& index, const Vector3& point, const Visit& visit) {
  index.for_near(point, 1, [&](const SampleCells& cells, std::size_t i, const Vector3& corner) {
    const SampleCell& cell = cells.cells[i];
    const auto weight = static_cast<double>(cell.weight);
    Vector3 mean;
    double squared = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      mean[a] = corner[a] + static_cast<double>(cell.position[a]) / weight;
      squared += (mean[a] - point[a]) * (mean[a] - point[a]);
    }
    if (squared >= 1.0) return;
    visit(cells, i, corner, mean, (1.0 - squared) * (1.0 - squared));
  });
}

// The samples of a cell near a point.
struct Near {
  double weight;   // total
  Vector3 offset;  // of their mean from the point
  double planes;   // mean signed distance of the samples' own planes from the point
};

// Normal of the plane that best fits the means, or zero where they are nearly on a line.
Vector3 normal_across_means(std::span<const Near> cells, double weight) {
  constexpr double kMinFlatness = 0.02;  // below it the means are nearly on a line
  Vector3 mean{};
  for (const Near& near : cells) {
    for (std::size_t a = 0; a < 3; ++a) mean[a] += near.weight / weight * near.offset[a];
  }
  SymmetricMatrix covariance;
  for (const Near& near : cells) covariance.add_square(near.weight / weight, near.offset - mean);
  const Vector3 normal = least_eigenvector(covariance);
  return flatness(covariance, normal) > kMinFlatness ? normal : Vector3{};
}

}  // namespace

std::optional<LocalSurface> local_surface(const SampleIndex& index, const Vector3& point,
                                          double normal_trust) {
  std::array<Near, 27> cells;
  std::size_t count = 0;
  double weight = 0.0;
  double squares = 0.0;
  Vector3 normal{};
  for_weighted(index, point,
               [&](const SampleCells& samples, std::size_t i, const Vector3& corner,
                   const Vector3& mean, double w) {
                 const SampleCell& cell = samples.cells[i];
                 Near& near = cells[count++];
                 near.weight = w * static_cast<double>(cell.weight);
                 near.offset = mean - point;
                 near.planes = 0.0;
                 for (std::size_t a = 0; a < 3; ++a) {
                   const auto n = static_cast<double>(cell.normal[a]);
                   normal[a] += w * n;
                   near.planes += static_cast<double>(cell.flux[a]) + (corner[a] - point[a]) * n;
                 }
                 near.planes /= static_cast<double>(cell.weight);
                 weight += near.weight;
                 squares += w * near.weight;
               });
  const double coherence = std::sqrt(dot(normal, normal)) / weight;
  if (!(coherence > kMinFitCoherence)) return std::nullopt;
  LocalSurface surface;
  for (std::size_t a = 0; a < 3; ++a) surface.normal[a] = normal[a] / (coherence * weight);
  if (normal_trust < 1.0) {
    const Vector3 across = normal_across_means(std::span(cells.data(), count), weight);
    const double side = dot(across, surface.normal) < 0.0 ? -1.0 : 1.0;
    for (std::size_t a = 0; a < 3; ++a) {
      surface.normal[a] =
          normal_trust * surface.normal[a] + (1.0 - normal_trust) * side * across[a];
    }
    const double size = std::sqrt(dot(surface.normal, surface.normal));
    if (!(size > 0.0)) return std::nullopt;
    for (double& x : surface.normal) x /= size;
  }
  const double own_planes = kOwnPlaneWeight * normal_trust;
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    Near& near = cells[i];
    near.planes = (1.0 - own_planes) * dot(near.offset, surface.normal) + own_planes * near.planes;
    sum += near.weight * near.planes;
  }
  const double mean = sum / weight;
  surface.distance = -mean;
  double variance = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    variance += cells[i].weight * (cells[i].planes - mean) * (cells[i].planes - mean);
  }
  surface.spread = std::sqrt(variance / weight);
  surface.weight = weight * weight / squares;
  double squares_of_cells = 0.0;
  for (std::size_t i = 0; i < count; ++i) squares_of_cells += cells[i].weight * cells[i].weight;
  surface.cells = weight * weight / squares_of_cells;
  return surface;
}

SampleNoise measure_noise(std::span<const SampleCell> cells, const SampleIndex& coarser,
                          double mean_weight) {
  constexpr double kMedianOfNormal = 0.6745;  // median of |x| for a standard normal x
  std::vector<double> distances;
  double cosines = 0.0;
  double pairs = 0.0;
  for (const SampleCell& cell : cells) {
    const CellPosition at = cell_position(cell.key);
    Vector3 point;
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = (at[a] + static_cast<double>(cell.position[a] / cell.weight)) / 2.0;
    }
    const double samples = static_cast<double>(cell.weight) / mean_weight;
    if (samples > 1.5) {
      // E|mean of n normals|^2 = 1/n + (1 - 1/n) * mean cosine of a pair.
      double squared = 0.0;
      for (const float n : cell.normal) squared += static_cast<double>(n) * static_cast<double>(n);
      squared /= static_cast<double>(cell.weight) * static_cast<double>(cell.weight);
      cosines += samples * (squared - 1.0 / samples) / (1.0 - 1.0 / samples);
      pairs += samples;
    }
    const std::optional<LocalSurface> surface = local_surface(coarser, point, 1.0);
    if (!surface) continue;
    // Averaging n samples divides the noise by sqrt(n).
    distances.push_back(2.0 * std::abs(surface->distance) * std::sqrt(samples));
  }
  if (distances.empty()) return {0.0, 1.0, mean_weight};
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double cosine = pairs > 0.0 ? cosines / pairs : 1.0;
  return {*middle / kMedianOfNormal,
          std::clamp((cosine - kNoisyCosine) / (kCleanCosine - kNoisyCosine), 0.0, 1.0),
          mean_weight};
}

double trust_in(const LocalSurface& surface, double noise, double mean_weight) {
  // Error of the function itself, in cells.
  constexpr double kFunctionError = 0.06;
  // Weight, in cells, of the cloud's overall noise: a few cells may agree by chance.
  constexpr double kPriorCells = 2.0;
  const double samples_of_cell = surface.weight / mean_weight / surface.cells;
  const double prior = noise * noise / std::max(1.0, samples_of_cell);
  const double variance = (surface.cells * surface.spread * surface.spread + kPriorCells * prior) /
                          (surface.cells - 1.0 + kPriorCells);
  return 1.0 / (1.0 + variance / surface.cells / (kFunctionError * kFunctionError));
}

void SampleFit::move(int depth, const FitLine* line, Vector3* point) const {
  int k = depth;
  for (int round = 0; round < kMoveRounds; ++round) {
    std::optional<LocalSurface> surface;
    double cell = 1.0;
    // Where no samples are near, search larger cells.
    for (const int last = std::max(1, k - kMaxDepthsUp);; --k) {
      cell = std::ldexp(1.0, finest_ - k);
      const Vector3 p = {(*point)[0] / cell, (*point)[1] / cell, (*point)[2] / cell};
      surface = local_surface(index_of_(k), p, noise_.normal_trust);
      if (surface || k == last) break;
    }
    if (!surface) return;
    if (line == nullptr) {
      const double step = cell * std::clamp(surface->distance, -1.0, 1.0);
      for (std::size_t a = 0; a < 3; ++a) (*point)[a] -= step * surface->normal[a];
      continue;
    }
    const double squared = dot(line->direction, line->direction);
    const double slope = dot(surface->normal, line->direction);
    if (slope * slope < kMinLineSlope * kMinLineSlope * squared) return;
    const double trust = std::clamp(2.0 - surface->spread / kAgreementSpread, 0.0, 1.0);
    const double now = dot(*point - line->start, line->direction) / squared;
    const double t =
        std::clamp(now - trust * cell * surface->distance / slope, line->low, line->high);
    *point = line->start + t * line->direction;
  }
}

std::optional<LocalSurface> SampleFit::surface_near(int depth, const Vector3& point) const {
  const double shrink = std::ldexp(1.0, depth - finest_);
  std::optional<LocalSurface> surface =
      local_surface(index_of_(depth), shrink * point, noise_.normal_trust);
  if (surface) surface->trust = trust_in(*surface, noise_.distance * shrink, noise_.mean_weight);
  return surface;
}

bool blend_attributes(const SampleIndex& index, const Vector3& point, std::span<float> attributes) {
  const std::size_t count = attributes.size();
  std::vector<double> sums(count);
  double weight = 0.0;
  for_weighted(
      index, point,
      [&](const SampleCells& cells, std::size_t i, const Vector3&, const Vector3&, double w) {
        weight += w * static_cast<double>(cells.cells[i].weight);
        for (std::size_t k = 0; k < count; ++k) {
          sums[k] += w * static_cast<double>(cells.attributes[i * count + k]);
        }
      });
  if (!(weight > 0.0)) return false;
  for (std::size_t k = 0; k < count; ++k) attributes[k] = static_cast<float>(sums[k] / weight);
  return true;
}

}  // namespace prefilter
