// SPDX-License-Identifier: GPL-3.0-or-later

// Prepares parts of a mesh for trimming: divides facets across holes and labels regions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "prefilter/points/reconstruct/cut_parts.h"
#include "prefilter/points/reconstruct/surface_regions.h"

namespace prefilter {

/// Attributes that follow the others of each vertex: the distance from the samples, in local
/// spacings, and the sample density.
inline constexpr std::size_t kSupportAttributes = 2;

/// Midpoint of edge (a, b), or center of triangle a of the part where b < 0, that is far from all
/// samples.
template <typename Number>
struct FarMidpoint {
  Number a;
  Number b;
  float distance;
  float density;
};

/// Parameters by which parts of a mesh are measured.
struct CutMeasure {
  double distance;    // vertices farther than this from all samples are far, in local spacings
  double cell;        // smallest spacing
  std::size_t width;  // number of attributes per vertex, including the support attributes
};

/// Position at which the cut crosses an edge, from its near end (0) to its far end (1). Clamped
/// away from both ends, so that no triangle degenerates.
inline double crossing(double distance, double near, double far) {
  constexpr double kMargin = 0.02;  // share of the edge
  const double at = (distance - near) / (far - near);
  return at < kMargin ? kMargin : at > 1.0 - kMargin ? 1.0 - kMargin : at;
}

/// Builds the parts of a mesh from vertices and triangles that arrive part by part. Triangles refer
/// to vertices by arrival index; the mesh also has vertices in the middle of divided facets.
class CutBuilder {
 public:
  CutBuilder(const CutMeasure& measure, SurfaceRegions* regions)
      : measure_(measure), regions_(*regions) {}

  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes);
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles);
  /// Sets the far midpoints of the current part; edges are given by the indices of their ends.
  void add_far_midpoints(const std::vector<FarMidpoint<std::int64_t>>& places);
  /// Requests that the regions around these vertices of the part be cut, provided that they are
  /// far.
  void request_cut(std::vector<std::int64_t> numbers) { cut_vertices_ = std::move(numbers); }
  /// Returns the current part. Later parts may refer to the vertices in `shared`, but to no other
  /// vertex of this part or an earlier one.
  CutPart take_part(std::span<const std::int64_t> shared);

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};
  using Edge = std::pair<std::int64_t, std::int64_t>;
  struct EdgeHash {
    std::size_t operator()(const Edge& edge) const {
      return static_cast<std::size_t>(edge.first) * 0x9E3779B97F4A7C15U ^
             static_cast<std::size_t>(edge.second);
    }
  };
  // A vertex to which later parts may refer.
  struct Known {
    std::int64_t id;
    std::int32_t component;
    Vector3 position;
    std::vector<float> attributes;
  };
  // An edge of which only one triangle has arrived, with its middle vertex if it has one.
  struct OpenEdge {
    std::optional<Known> known;
    std::uint32_t local = kNone;  // index in the part
  };

  bool is_near(std::uint32_t local) const { return distance(local) <= measure_.distance; }
  double distance(std::uint32_t local) const;
  bool is_lasting(std::int64_t number) const;
  std::uint32_t add_known(const Known& known);
  std::uint32_t add_middle(std::span<const std::uint32_t> corners,
                           const FarMidpoint<std::int64_t>& place);
  std::uint32_t local_of(std::int64_t number);
  std::uint32_t middle_of(std::int64_t a, std::int64_t b);
  std::uint32_t far_middle(const Edge& edge);
  void divide_triangles();
  void find_components();
  void measure_areas();
  Known known_of(std::uint32_t local) const;
  void retain_shared(std::span<const std::int64_t> shared);

  CutMeasure measure_;
  SurfaceRegions& regions_;
  std::int64_t next_id_ = 0;
  std::unordered_map<std::int64_t, Known> known_;
  std::unordered_map<Edge, OpenEdge, EdgeHash> open_edges_;

  // State of the current part.
  CutPart part_;
  std::int64_t first_number_ = 0;
  std::vector<std::array<std::int64_t, 3>> triangles_;
  std::unordered_map<Edge, FarMidpoint<std::int64_t>, EdgeHash> far_edges_;
  std::unordered_map<std::int64_t, FarMidpoint<std::int64_t>> far_triangles_;
  std::vector<std::int64_t> cut_vertices_;
  std::unordered_set<std::int64_t> shared_;
  std::unordered_map<std::int64_t, std::uint32_t> olds_;
  std::unordered_map<Edge, std::uint32_t, EdgeHash> middles_;
};

}  // namespace prefilter
