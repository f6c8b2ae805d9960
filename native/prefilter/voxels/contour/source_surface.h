// SPDX-License-Identifier: GPL-3.0-or-later

// The source meshes of a shape near their edges, prepared for searches.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/spatial/box_tree.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/source_regions.h"

namespace prefilter {

/// Intersection of a segment with a triangle, as a share of the segment.
struct SourceCrossing {
  double share;
  std::int32_t triangle;
};

/// Search results do not depend on the number of threads. Lengths are in the frame's unit.
class SourceSurface final : public FeatureSurface {
 public:
  /// `cell` is the side of the finest cells. Throws as find_regions does.
  SourceSurface(std::span<const SourceMesh> sources, const RootFrame& frame, double cell,
                const Run& run);

  const SourceRegions& regions() const { return regions_; }
  double cell() const override { return cell_; }

  /// Whether a border, or an intersection of parts, may be within about two cells.
  bool is_near(const Vector3& point) const;

  /// Intersection of the segment from `a` to `b` with the surface; if there are several, the one
  /// nearest to `expected`.
  std::optional<SourcePoint> crossing(const Vector3& a, const Vector3& b,
                                      const Vector3& expected) const;

  /// All intersections, in order; a single one at an edge between triangles of a part.
  std::vector<SourceCrossing> crossings(const Vector3& a, const Vector3& b) const;

  /// A point of a triangle.
  SourcePoint point_on(std::int32_t triangle, const Vector3& position) const;

  /// The parts that may meet within a cell or two of a point; none if there are fewer than two, or
  /// very many.
  std::span<const std::int32_t> meeting_parts(const Vector3& point) const;

  bool has_meetings() const { return !meetings_.empty(); }

  /// Calls visit(low corner, side) for the cubes where parts may meet.
  template <typename Visit>
  void for_meeting_bricks(const Visit& visit) const {
    for (const auto& [key, parts] : meetings_) {
      if (parts.count > 1) visit(low_of_brick(key), brick_);
    }
  }

  /// The plane of the triangle of a part that is nearest to a point, or faces it most if several
  /// are: the point is inside the part if it is behind the plane. None if it is farther than
  /// `reach`.
  std::optional<SourcePoint> nearest_plane(const Vector3& point, double reach,
                                           std::int32_t part) const;

  /// The first triangle of each label.
  std::vector<std::int64_t> first_triangles() const;

  /// The triangle nearest to a point, at any distance. Searches all triangles.
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
  void mark_borders(const Run& run);
  void mark_meetings(const Run& run);
  void mark_around(const Box& box);
  void find_rim_corners(const Run& run);
  void build_trees(const Run& run);
  // Calls visit(triangle) for the triangles of a node of the tree.
  template <typename Visit>
  void for_triangles(std::size_t node, const Visit& visit) const;
  // Calls visit(triangle, share) for the triangles that a segment intersects.
  template <typename Visit>
  void for_met(const Vector3& a, const Vector3& b, const Visit& visit) const;
  static constexpr std::size_t kMostMeeting = 6;
  struct Meeting {
    std::array<std::int32_t, kMostMeeting> parts;
    std::size_t count = 0;
    void add(std::int32_t part);
  };
  // Intersection of an edge of one part with the surface of another.
  struct RimCorner {
    Vector3 position;
    std::vector<std::int32_t> labels;  // sorted
  };
  Vector3 low_of_brick(std::uint64_t key) const;
  std::uint64_t brick_of(const Vector3& point) const;

  SourceRegions regions_;
  double cell_;
  double brick_;
  std::unordered_set<std::uint64_t> near_bricks_;
  std::unordered_map<std::uint64_t, Meeting> meetings_;
  std::vector<std::int32_t> triangles_;  // near borders, along the Morton curve
  BoxTree triangle_tree_;
  std::vector<std::int32_t> borders_;
  BoxTree border_tree_;
  std::vector<RimCorner> rim_corners_;
};

}  // namespace prefilter
