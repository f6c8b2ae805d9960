// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/feature_places.h"

#include <algorithm>
#include <utility>

namespace prefilter {
namespace {

// All lengths are in cells.
constexpr double kFeatureReach = 5.0;
constexpr double kRegionReach = 5.0;
constexpr double kOnSurface = 0.05;
constexpr double kCornerReach = 1.0;
constexpr double kEndReach = 1.5;
constexpr double kFarCorner = 3.0;
constexpr double kSettled = 1e-7;
constexpr int kFeaturePlacesMostSteps = 12;

using Labels = std::vector<std::int32_t>;

// Solves the ridge-regularized Gram system of `normals`.
std::vector<double> solve_products(const std::vector<Vector3>& normals, std::vector<double> right) {
  constexpr double kRidge = 1e-4;
  const std::size_t n = normals.size();
  std::vector<double> m(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) m[i * n + j] = dot(normals[i], normals[j]);
    m[i * n + i] += kRidge;
  }
  // Elimination without pivoting is as stable as Cholesky decomposition for such a matrix.
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = m[k * n + i] / m[i * n + i];
      for (std::size_t j = i; j < n; ++j) m[k * n + j] -= factor * m[i * n + j];
      right[k] -= factor * right[i];
    }
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) right[i] -= m[i * n + j] * right[j];
    right[i] /= m[i * n + i];
  }
  return right;
}

bool has_all(const FeatureCorner& corner, const Labels& labels) {
  return std::includes(corner.labels.begin(), corner.labels.end(), labels.begin(), labels.end());
}
}  // namespace

FeaturePlaces::FeaturePlaces(const FeatureSurface& surface)
    : surface_(surface), cell_(surface.cell()), corners_(kFeatureReach * cell_) {
  for (std::size_t c = 0; c < surface_.corner_count(); ++c) {
    corners_.add(surface_.corner(c).position, c);
  }
}

Feature FeaturePlaces::feature(const Vector3& start, Labels labels) const {
  Feature feature;
  feature.start = start;
  feature.is_corner = labels.size() > 2;
  feature.position = place(start, labels).value_or(start);
  feature.labels = std::move(labels);
  return feature;
}

std::optional<Vector3> FeaturePlaces::place(const Vector3& start, const Labels& labels) const {
  if (labels.size() < 3) return edge_near(start, labels);
  std::optional<Vector3> found = corner_near(start, labels);
  if (!found) found = meeting_of(start, labels);
  if (found && length(*found - start) < kFarCorner * cell_) return found;
  // Three regions lie side by side here.
  const std::optional<Vector3> edge = sharpest_edge_near(start, labels);
  return edge ? edge : found;
}

std::optional<Vector3> FeaturePlaces::edge_near(const Vector3& start, const Labels& labels) const {
  std::optional<Vector3> found =
      surface_.nearest_border(start, kFeatureReach * cell_, labels.front(), labels.back());
  if (!found && labels.size() > 1) found = meeting_of(start, labels);
  // The start is beyond the end of an edge that runs into another one.
  if (!found && labels.size() > 1) {
    found = corner_near(start, labels);
    if (found && length(*found - start) > kEndReach * cell_) found.reset();
  }
  return found;
}

// The sharpest edge between two of these regions that is closer than a corner may be.
std::optional<Vector3> FeaturePlaces::sharpest_edge_near(const Vector3& start,
                                                         const Labels& labels) const {
  std::vector<std::optional<SourcePoint>> nearest;
  for (const std::int32_t label : labels) {
    nearest.push_back(surface_.nearest(start, kRegionReach * cell_, label));
  }
  std::optional<Vector3> best;
  double least = 1.0;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    for (std::size_t j = i + 1; j < labels.size(); ++j) {
      if (!nearest[i] || !nearest[j]) continue;
      const double blunt = std::abs(dot(nearest[i]->normal, nearest[j]->normal));
      if (blunt >= least) continue;
      const std::optional<Vector3> found = edge_near(start, {labels[i], labels[j]});
      if (!found || length(*found - start) > kCornerReach * cell_) continue;
      best = found;
      least = blunt;
    }
  }
  return best;
}

// The nearest corner of these regions, or of more.
std::optional<Vector3> FeaturePlaces::corner_near(const Vector3& start,
                                                  const Labels& labels) const {
  std::size_t best = surface_.corner_count();
  double least = kFeatureReach * cell_;
  corners_.for_around(start, [&](std::size_t c) {
    const FeatureCorner corner = surface_.corner(c);
    const double distance = length(corner.position - start);
    if (!(distance < least || (distance == least && c < best && best < surface_.corner_count()))) {
      return;
    }
    if (!has_all(corner, labels)) return;
    least = distance;
    best = c;
  });
  if (best == surface_.corner_count()) return std::nullopt;
  return surface_.corner(best).position;
}

// The intersection of regions nearest to a start point, by least-norm steps onto their planes.
std::optional<Vector3> FeaturePlaces::meeting_of(const Vector3& start, const Labels& labels) const {
  Vector3 at = start;
  for (int step = 0; step < kFeaturePlacesMostSteps; ++step) {
    std::vector<Vector3> normals;
    std::vector<double> heights;
    for (const std::int32_t label : labels) {
      const std::optional<SourcePoint> near = surface_.nearest(at, kRegionReach * cell_, label);
      if (!near) continue;
      normals.push_back(near->normal);
      heights.push_back(dot(near->normal, near->position - at));
    }
    if (normals.empty()) return std::nullopt;
    const std::vector<double> factors = solve_products(normals, heights);
    Vector3 move{};
    for (std::size_t i = 0; i < normals.size(); ++i) move = move + factors[i] * normals[i];
    at = at + move;
    if (length(at - start) > kFeatureReach * cell_) return std::nullopt;
    if (length(move) < kSettled * cell_) break;
  }
  for (const std::int32_t label : labels) {
    if (!surface_.nearest(at, kOnSurface * cell_, label)) return std::nullopt;
  }
  return at;
}

void FeaturePlaces::claim_corners(std::vector<Feature>* features) const {
  if (surface_.corner_count() == 0) return;
  PointGrid grid(kCornerReach * cell_);
  for (std::size_t i = 0; i < features->size(); ++i) grid.add((*features)[i].position, i);
  std::vector<std::uint8_t> is_taken(features->size(), 0);
  for (std::size_t c = 0; c < surface_.corner_count(); ++c) {
    const FeatureCorner corner = surface_.corner(c);
    std::size_t best = features->size();
    double least = kCornerReach * cell_;
    grid.for_around(corner.position, [&](std::size_t i) {
      const double distance = length((*features)[i].position - corner.position);
      if (is_taken[i] != 0 || distance > least || (distance == least && i > best)) return;
      if (!has_all(corner, (*features)[i].labels)) return;
      best = i;
      least = distance;
    });
    if (best == features->size()) continue;
    is_taken[best] = 1;
    (*features)[best].position = corner.position;
    (*features)[best].is_corner = true;
  }
}

}  // namespace prefilter
