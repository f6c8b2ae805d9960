// SPDX-License-Identifier: GPL-3.0-or-later

// The meshes that a shape was made of, close to their edges, ready for searches.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/spatial/box_tree.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

/// Where a segment meets a triangle, as a share of it.
struct SourceCrossing {
  double share;
  std::int32_t triangle;
};

/// What searches find is the same for any number of threads. Lengths are the frame's.
class SourceSurface final : public FeatureSurface {
 public:
  /// `cell` is the side of the finest cells. Throws as find_regions does.
  SourceSurface(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                const Progress& progress, int threads);

  const SourceRegions& regions() const { return regions_; }
  double cell() const override { return cell_; }

  /// Whether there may be a border, or where two parts meet, within about two cells.
  bool is_near(const Vector3& point) const;

  /// Where the segment from `a` to `b` runs through the surface; of several places the one nearest
  /// to `expected`.
  std::optional<SourcePoint> crossing(const Vector3& a, const Vector3& b,
                                      const Vector3& expected) const;

  /// All places where it does, in order; one where that is an edge between triangles of a part.
  std::vector<SourceCrossing> crossings(const Vector3& a, const Vector3& b) const;

  /// A point of a triangle.
  SourcePoint point_on(std::int32_t triangle, const Vector3& position) const;

  /// The parts that may meet within a cell or two of a point; none where that are fewer than two,
  /// or very many.
  std::span<const std::int32_t> meeting_parts(const Vector3& point) const;

  bool has_meetings() const { return !meetings_.empty(); }

  /// Calls visit(low corner, side) for the cubes where parts may meet.
  template <typename Visit>
  void for_meeting_bricks(const Visit& visit) const {
    for (const auto& [key, parts] : meetings_) {
      if (parts.count > 1) visit(low_of_brick(key), brick_);
    }
  }

  /// The plane of the triangle of a part that is nearest to a point, and of several the one that
  /// faces it most: the point is inside of the part where it is behind that. None where it is
  /// farther than `reach`.
  std::optional<SourcePoint> nearest_plane(const Vector3& point, double reach,
                                           std::int32_t part) const;

  /// For each label, the first triangle that has it.
  std::vector<std::int64_t> first_triangles() const;

  /// The triangle nearest to a point, wherever that is. Looks at all of them.
  std::int64_t nearest_of_all(const Vector3& point) const;

  std::optional<SourcePoint> nearest(const Vector3& point, double reach,
                                     std::int32_t label) const override;

  std::optional<Vector3> nearest_border(const Vector3& point, double reach, std::int32_t label,
                                        std::int32_t other) const override;
  std::size_t corner_count() const override {
    return regions_.corners.size() + rim_corners_.size();
  }
  FeatureCorner corner(std::size_t index) const override;

 private:
  void mark_borders(const Progress& progress);
  void mark_meetings(const Progress& progress);
  void mark_around(const Box& box);
  void find_rim_corners(const Progress& progress);
  void build_trees(const Progress& progress, int threads);
  // Calls visit(triangle) for those of a node of the tree.
  template <typename Visit>
  void for_triangles(std::size_t node, const Visit& visit) const;
  // Calls visit(triangle, share) where a segment meets them.
  template <typename Visit>
  void for_met(const Vector3& a, const Vector3& b, const Visit& visit) const;
  static constexpr std::size_t kMostMeeting = 6;
  struct Meeting {
    std::array<std::int32_t, kMostMeeting> parts;
    std::size_t count = 0;
    void add(std::int32_t part);
  };
  // Where an edge of one part runs through the surface of another.
  struct RimCorner {
    Vector3 position;
    std::vector<std::int32_t> labels;  // in order
  };
  Vector3 low_of_brick(std::uint64_t key) const;
  std::uint64_t brick_of(const Vector3& point) const;

  SourceRegions regions_;
  double cell_;
  double brick_;
  std::unordered_set<std::uint64_t> near_bricks_;
  std::unordered_map<std::uint64_t, Meeting> meetings_;
  std::vector<std::int32_t> triangles_;  // near borders, along the curve
  BoxTree triangle_tree_;
  std::vector<std::int32_t> borders_;
  BoxTree border_tree_;
  std::vector<RimCorner> rim_corners_;
};

}  // namespace prefilter
