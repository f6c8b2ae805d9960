// SPDX-License-Identifier: GPL-3.0-or-later

// A part of a mesh made ready to be cut: facets across holes divided, regions told apart.
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

/// What follows the attributes of a vertex: the distance from the samples, in local spacings, and
/// the density of these.
inline constexpr std::size_t kSupportAttributes = 2;

/// The middle of an edge, or where b < 0 of triangle a of a part, that is far from all samples.
template <typename Number>
struct FarPlace {
  Number a;
  Number b;
  float distance;
  float density;
};

/// What parts of a mesh are measured by.
struct CutMeasure {
  double distance;    // what is farther is far, in local spacings
  double cell;        // the least spacing
  std::size_t width;  // of attributes, with those of support
};

/// Where a cut crosses an edge, from its near end to its far one. Never at an end: no triangle is
/// without area.
inline double crossing(double distance, double near, double far) {
  constexpr double kMargin = 0.02;
  const double at = (distance - near) / (far - near);
  return at < kMargin ? kMargin : at > 1.0 - kMargin ? 1.0 - kMargin : at;
}

/// Vertices and triangles that come part by part. Triangles name vertices by their numbers among
/// all that came; the mesh has others, too, in the middle of facets.
class CutBuilder {
 public:
  CutBuilder(const CutMeasure& measure, SurfaceRegions* regions)
      : measure_(measure), regions_(*regions) {}

  void add_vertices(std::vector<Vector3> positions, std::vector<float> attributes);
  void add_triangles(std::vector<std::array<std::int64_t, 3>> triangles);
  /// Of the part; edges by the numbers of their ends.
  void add_far_places(const std::vector<FarPlace<std::int64_t>>& places);
  /// Has the regions cut in which these vertices of the part are, if they are far.
  void cut_at(std::vector<std::int64_t> numbers) { cut_at_ = std::move(numbers); }
  /// The part that has come. Later ones may name those vertices of it and of those before that are
  /// `shared`, and no others.
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
  // A vertex that later parts may have.
  struct Known {
    std::int64_t id;
    std::int32_t component;
    Vector3 position;
    std::vector<float> attributes;
  };
  // An edge of which one triangle has come: its middle, if that is a vertex.
  struct OpenEdge {
    std::optional<Known> known;
    std::uint32_t local = kNone;  // in the part
  };

  bool is_near(std::uint32_t local) const { return distance(local) <= measure_.distance; }
  double distance(std::uint32_t local) const;
  bool is_lasting(std::int64_t number) const;
  std::uint32_t add_known(const Known& known);
  std::uint32_t add_middle(std::span<const std::uint32_t> corners,
                           const FarPlace<std::int64_t>& place);
  std::uint32_t local_of(std::int64_t number);
  std::uint32_t middle_of(std::int64_t a, std::int64_t b);
  std::uint32_t far_middle(const Edge& edge);
  void divide_triangles();
  void find_components();
  void measure_areas();
  Known known_of(std::uint32_t local) const;
  void keep(std::span<const std::int64_t> shared);

  CutMeasure measure_;
  SurfaceRegions& regions_;
  std::int64_t next_id_ = 0;
  std::unordered_map<std::int64_t, Known> known_;
  std::unordered_map<Edge, OpenEdge, EdgeHash> open_edges_;

  // Of the part.
  CutPart part_;
  std::int64_t first_number_ = 0;
  std::vector<std::array<std::int64_t, 3>> triangles_;
  std::unordered_map<Edge, FarPlace<std::int64_t>, EdgeHash> far_edges_;
  std::unordered_map<std::int64_t, FarPlace<std::int64_t>> far_triangles_;
  std::vector<std::int64_t> cut_at_;
  std::unordered_set<std::int64_t> shared_;
  std::unordered_map<std::int64_t, std::uint32_t> olds_;
  std::unordered_map<Edge, std::uint32_t, EdgeHash> middles_;
};

}  // namespace prefilter
