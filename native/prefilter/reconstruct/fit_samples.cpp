#include "prefilter/reconstruct/fit_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace prefilter {
namespace {

constexpr int kRounds = 2;
// Normals that cancel each other to less than this share do not tell a side.
constexpr double kLeastCoherence = 0.2;
// Curved surfaces keep more than the second within a cell's side; noise of normals leaves less than
// the first.
constexpr double kNoisyCoherence = 0.93;
constexpr double kCleanCoherence = 0.98;
// Of a leaf's side: what noise may leave open.
constexpr double kOpen = 0.08;
constexpr int kMostCoarser = 3;

// Calls visit(cell, index, corner, mean, weight) for the cells of samples around a point.
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

}  // namespace

std::optional<LocalSurface> local_surface(const SampleIndex& index, const Vector3& point) {
  struct Near {
    double weight;   // of the cell's samples, together
    Vector3 offset;  // of their mean from the point
    double planes;   // of their own planes from the point, mean
  };
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
  if (!(coherence > kLeastCoherence)) return std::nullopt;
  LocalSurface surface;
  for (std::size_t a = 0; a < 3; ++a) surface.normal[a] = normal[a] / (coherence * weight);
  const double own_planes =
      0.5 *
      std::clamp((coherence - kNoisyCoherence) / (kCleanCoherence - kNoisyCoherence), 0.0, 1.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    Near& near = cells[i];
    near.planes = (1.0 - own_planes) * dot(near.offset, surface.normal) + own_planes * near.planes;
    sum += near.weight * near.planes;
  }
  const double mean = sum / weight;
  surface.distance = -mean;
  surface.weight = weight * weight / squares;
  return surface;
}

SampleNoise measure_noise(std::span<const SampleCell> cells, const SampleIndex& coarser,
                          double mean_weight) {
  constexpr double kMedianOfNormal = 0.6745;
  std::vector<double> distances;
  std::vector<double> weights;
  for (const SampleCell& cell : cells) {
    const CellPosition at = cell_position(cell.key);
    Vector3 point;
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = (at[a] + static_cast<double>(cell.position[a] / cell.weight)) / 2.0;
    }
    const std::optional<LocalSurface> surface = local_surface(coarser, point);
    if (!surface) continue;
    // The mean of a cell's samples has less noise than each.
    distances.push_back(2.0 * std::abs(surface->distance) *
                        std::sqrt(static_cast<double>(cell.weight) / mean_weight));
    weights.push_back(surface->weight / 4.0);
  }
  if (distances.empty()) return {};
  const auto median = [](std::vector<double>* values) {
    const auto middle = values->begin() + static_cast<std::ptrdiff_t>(values->size() / 2);
    std::nth_element(values->begin(), middle, values->end());
    return *middle;
  };
  return {median(&distances) / kMedianOfNormal, median(&weights) / mean_weight};
}

int SampleFit::depth_of_samples(int depth) const {
  const double enough = kOpen * std::ldexp(1.0, finest_ - depth);
  double open = noise_.distance / std::sqrt(noise_.samples);
  int found = depth;
  for (; open > enough && found > std::max(1, depth - kMostCoarser); --found) open /= 2.0;
  return found;
}

void SampleFit::move(int depth, Vector3* point) const {
  int k = depth_of_samples(depth);
  for (int round = 0; round < kRounds; ++round) {
    std::optional<LocalSurface> surface;
    double cell = 1.0;
    // Where there are no samples as near, larger cells may have some.
    for (const int last = std::max(1, k - kMostCoarser);; --k) {
      cell = std::ldexp(1.0, finest_ - k);
      const Vector3 p = {(*point)[0] / cell, (*point)[1] / cell, (*point)[2] / cell};
      surface = local_surface(index_of_(k), p);
      if (surface || k == last) break;
    }
    if (!surface) return;
    const double step = cell * std::clamp(surface->distance, -1.0, 1.0);
    for (std::size_t a = 0; a < 3; ++a) (*point)[a] -= step * surface->normal[a];
  }
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
