#include "prefilter/reconstruct/fit_samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace prefilter {
namespace {

constexpr int kRounds = 2;
// Normals that cancel each other to less than this share do not tell a side.
constexpr double kLeastCoherence = 0.2;

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
  double weight = 0.0;
  Vector3 offset{};  // of the samples from the point
  Vector3 normal{};
  double planes = 0.0;  // of the samples' own planes from the point
  for_weighted(index, point,
               [&](const SampleCells& cells, std::size_t i, const Vector3& corner,
                   const Vector3& mean, double w) {
                 const SampleCell& cell = cells.cells[i];
                 const double of_cell = w * static_cast<double>(cell.weight);
                 weight += of_cell;
                 for (std::size_t a = 0; a < 3; ++a) {
                   const auto n = static_cast<double>(cell.normal[a]);
                   offset[a] += of_cell * (mean[a] - point[a]);
                   normal[a] += w * n;
                   planes += w * (static_cast<double>(cell.flux[a]) + (corner[a] - point[a]) * n);
                 }
               });
  const double length = std::sqrt(dot(normal, normal));
  if (!(length > kLeastCoherence * weight)) return std::nullopt;
  LocalSurface surface;
  for (std::size_t a = 0; a < 3; ++a) surface.normal[a] = normal[a] / length;
  surface.distance = -0.5 * (dot(offset, surface.normal) / weight + planes / weight);
  return surface;
}

void fit_to_samples(const SampleIndex& index, Vector3* point) {
  for (int round = 0; round < kRounds; ++round) {
    const std::optional<LocalSurface> surface = local_surface(index, *point);
    if (!surface) return;
    const double step = std::clamp(surface->distance, -1.0, 1.0);
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
