// SPDX-License-Identifier: GPL-3.0-or-later

// Positions of vertices on a contour's edges and corners.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/sharp_vertices.h"

namespace prefilter {

/// The vertex of a loop, on an edge or a corner.
struct Feature {
  Vector3 position{};
  Vector3 start{};                   // the loop's center, at which the search started
  std::vector<std::int32_t> labels;  // of the regions around it, sorted
  bool is_corner = false;
};

/// Points in the cubes of a grid.
class PointGrid {
 public:
  /// `reach` is the radius of searches.
  explicit PointGrid(double reach) : side_(kWider * reach) {}

  void add(const Vector3& point, std::size_t index) { places_[place_of(point)].push_back(index); }

  /// Calls visit(index) for all points within reach of a point, and some others, in any order.
  template <typename Visit>
  void for_around(const Vector3& point, const Visit& visit) const {
    if (places_.empty()) return;
    const Place place = place_of(point);
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t z = -1; z <= 1; ++z) {
          const auto found = places_.find({place[0] + x, place[1] + y, place[2] + z});
          if (found == places_.end()) continue;
          for (const std::size_t index : found->second) visit(index);
        }
      }
    }
  }

 private:
  using Place = std::array<std::int64_t, 3>;
  struct PlaceHash {
    std::size_t operator()(const Place& place) const {
      std::uint64_t hash = 0;
      for (const std::int64_t p : place) {
        hash = (hash ^ static_cast<std::uint64_t>(p)) * 0x9E3779B97F4A7C15U;
        hash ^= hash >> 29U;
      }
      return hash;
    }
  };
  // Margin that keeps rounding from placing a point two cubes away.
  static constexpr double kWider = 1.0 + 1e-6;

  Place place_of(const Vector3& point) const {
    Place place;
    for (std::size_t a = 0; a < 3; ++a) {
      place[a] = static_cast<std::int64_t>(std::floor(point[a] / side_));
    }
    return place;
  }

  double side_;
  std::unordered_map<Place, std::vector<std::size_t>, PlaceHash> places_;
};

/// Finds the intersections of a surface's regions; the surface must outlive it.
class FeaturePlaces {
 public:
  explicit FeaturePlaces(const FeatureSurface& surface);

  /// The feature of a loop whose vertices belong to these regions, sorted; it is at `start` if none
  /// is found nearby.
  Feature feature(const Vector3& start, std::vector<std::int32_t> labels) const;

  /// The feature of a loop of vertices. The search starts at the center of the sides that an edge
  /// of the shape crosses, by `is_divided(side)`; none if there is no such side.
  template <typename IsDivided>
  std::optional<Feature> of_loop(std::span<const std::int32_t> loop,
                                 std::span<const Vector3> positions, const VertexSamples& samples,
                                 const IsDivided& is_divided) const {
    Vector3 start{};
    std::vector<std::int32_t> labels;
    int divided = 0;
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const std::int32_t from = loop[k];
      const std::int32_t to = loop[(k + 1) % loop.size()];
      if (const SourcePoint* sample = samples.of(from)) labels.push_back(sample->label);
      if (!is_divided(k)) continue;
      start = start + 0.5 * (positions[static_cast<std::size_t>(from)] +
                             positions[static_cast<std::size_t>(to)]);
      ++divided;
    }
    if (divided == 0) return std::nullopt;
    std::sort(labels.begin(), labels.end());
    labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
    return feature((1.0 / divided) * start, std::move(labels));
  }

  /// The nearest point to `start` where regions intersect; for a single region, on its sharp edges.
  std::optional<Vector3> place(const Vector3& start, const std::vector<std::int32_t>& labels) const;

  /// Moves the nearest feature within a cell of each corner of the shape to it, if the feature is
  /// on an edge or a corner of the corner's regions.
  void claim_corners(std::vector<Feature>* features) const;

 private:
  std::optional<Vector3> edge_near(const Vector3& start,
                                   const std::vector<std::int32_t>& labels) const;
  std::optional<Vector3> sharpest_edge_near(const Vector3& start,
                                            const std::vector<std::int32_t>& labels) const;
  std::optional<Vector3> corner_near(const Vector3& start,
                                     const std::vector<std::int32_t>& labels) const;
  std::optional<Vector3> meeting_of(const Vector3& start,
                                    const std::vector<std::int32_t>& labels) const;

  const FeatureSurface& surface_;
  double cell_;
  PointGrid corners_;
};

}  // namespace prefilter
