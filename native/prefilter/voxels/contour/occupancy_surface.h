// SPDX-License-Identifier: GPL-3.0-or-later

// Smooth surfaces determined by occupancies alone, for finding edges and corners at their
// intersections.
//
// Not in the dissertation. Where 3 x 3 columns of cells run from full to empty, and their sums fit
// a gently curved quadratic, the surface is smooth and known; adjacent cells whose surfaces
// continue each other form a region. Columns around an edge provide no information. There the
// quadratics of the regions on both sides are extrapolated as far as they explain the occupancies.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/voxels/contour/contour_tree.h"
#include "prefilter/voxels/contour/feature_surface.h"
#include "prefilter/voxels/contour/height_patch.h"
#include "prefilter/voxels/contour/root_frame.h"
#include "prefilter/voxels/contour/sharp_vertices.h"
#include "prefilter/voxels/contour/surface_vertices.h"

namespace prefilter {

/// The surface of a tree of occupancies with all surface in its finest cells.
class OccupancySurface final : public FeatureSurface {
 public:
  /// Throws Error(kCancelled).
  OccupancySurface(const ContourTree& tree, const RootFrame& frame, const SurfaceVertices& vertices,
                   const Run& run);

  /// Moves the vertices beside edges onto the regions to which they belong. Throws
  /// Error(kCancelled).
  VertexSamples sample_vertices(const Run& run, SurfaceVertices* vertices) const;

  double cell() const override { return frame_.cell(0, depth_); }
  std::optional<SourcePoint> nearest(const Vector3& point, double reach,
                                     std::int32_t label) const override;
  std::optional<Vector3> nearest_border(const Vector3&, double, std::int32_t,
                                        std::int32_t) const override {
    return std::nullopt;
  }
  std::size_t corner_count() const override { return 0; }
  FeatureCorner corner(std::size_t) const override { return {}; }

 private:
  struct SurfaceCell {
    CellCoordinates at;
    std::size_t first_vertex;
    std::uint8_t faces;  // faces with vertices
    bool is_smooth = false;
    bool is_deep = false;  // this and all adjacent cells are smooth
    bool is_beside_edge = false;
    std::int32_t region = -1;
    HeightPatch patch;
  };
  // A region near a cell, represented by its most relevant patch.
  struct Candidate {
    std::int32_t region;
    std::size_t cell;
    double score;
  };

  // A point of a region's surface, in cells.
  struct Hit {
    std::int32_t region;
    Vector3 point;
    Vector3 gradient;
  };
  // A vertex with its sample, as in VertexSamples.
  struct Found {
    std::size_t vertex;
    SourcePoint sample;
    Vector3 on_line;
    float facing;
  };

  void gather(const CellNode& node, const CellCoordinates& at, const SurfaceVertices& vertices);
  bool fit(SurfaceCell* cell) const;
  void join_regions();
  void merge_across_gaps();
  void mark_edges();
  const SurfaceCell* find(const CellCoordinates& at) const;
  std::vector<Candidate> candidates(const CellCoordinates& at) const;
  bool explains(const std::vector<Candidate>& all, const CellCoordinates& at) const;
  std::optional<Hit> hit_on_line(const std::vector<Candidate>& near, const CellCoordinates& at,
                                 int face, double rises, const Vector3& start) const;
  std::optional<Hit> hit_beside(const std::vector<Candidate>& near, const Vector3& start) const;
  std::optional<Found> sample_face(const SurfaceCell& cell, const std::vector<Candidate>& near,
                                   int face, std::size_t vertex, const Vector3& position) const;
  void sample_cell(const SurfaceCell& cell, const std::vector<Vector3>& positions,
                   std::vector<Found>* found) const;
  Vector3 to_cells(const Vector3& point) const;
  Vector3 to_frame(const Vector3& point) const;
  Vector3 normal_in_frame(const Vector3& normal) const;

  const ContourTree& tree_;
  const RootFrame& frame_;
  int depth_;
  std::vector<SurfaceCell> cells_;
  std::unordered_map<std::uint64_t, std::uint32_t> places_;
  DisjointSets<std::int32_t> regions_;
  std::vector<std::vector<Candidate>> near_;  // per cell that is not smooth, nearest first
};

}  // namespace prefilter
