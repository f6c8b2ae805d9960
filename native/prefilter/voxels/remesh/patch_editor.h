// SPDX-License-Identifier: GPL-3.0-or-later

// Collapses and flips edges of a part of a mesh to widen its triangles' angles.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/voxels/remesh/faceted_mesh.h"
#include "prefilter/voxels/remesh/ring_triangles.h"

namespace prefilter {

/// A mesh whose patches are edited, several at a time; each changes only its own triangles and
/// vertices.
struct EditedMesh {
  static constexpr std::uint32_t kUnowned = 0xffffffff;
  static constexpr std::uint32_t kShared = 0xfffffffe;

  FacetedMesh mesh;  // removed triangles are kRemoved
  double crease_tolerance = 0.0;
  // maximum height of a change over the previous surface
  double max_height = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> owners;  // per vertex: the patch with all of its triangles
  std::vector<std::uint32_t> firsts;  // index of the first triangle around it, in its owner
  std::vector<std::uint32_t> counts;
  std::vector<std::uint8_t> is_fixed;  // vertices whose triangles stay unchanged; empty: none
  std::vector<float> widths;           // per triangle: see width_of

  bool is_removed(std::size_t triangle) const { return mesh.triangles[triangle][0] < 0; }
};

inline constexpr std::array<std::int32_t, 3> kRemoved = {-1, -1, -1};

/// The squared sine of a triangle's smallest angle; 0 for triangles without area.
double width_of(const Vector3& a, const Vector3& b, const Vector3& c);

/// Edits one patch after the other.
class PatchEditor {
 public:
  explicit PatchEditor(EditedMesh* edited) : edited_(*edited) {}

  /// Edits these triangles, in order; `patch` is the owner of the vertices that may change.
  void edit(std::uint32_t patch, std::span<const std::uint32_t> triangles);

  /// The triangles that remained narrow.
  const std::vector<std::uint32_t>& narrow() const { return narrow_; }

 private:
  // The triangles around a vertex, with their other corners in counterclockwise order.
  struct Fan {
    std::size_t count = 0;
    std::array<std::int32_t, kMaxRingSize> ring;
    std::array<std::uint32_t, kMaxRingSize> triangles;  // triangle i has ring[i] and ring[i + 1]
  };
  // A removal or flip: triangles that replace those with the same border.
  struct Change {
    // removed vertex; -1: the edge between the first two triangles is flipped
    std::int32_t vertex = -1;
    std::size_t old_count = 0;
    std::size_t count = 0;  // 0: no change possible
    // Triangles before; the first `count` are replaced.
    std::array<std::uint32_t, kMaxRingSize> old_triangles;
    std::array<std::array<std::int32_t, 3>, kMaxRingSize> triangles;
    std::array<std::int32_t, kMaxRingSize> labels;
    double fault = 0.0;  // sum after the change
    double gain = 0.0;   // decrease of the sum
    double area = 0.0;   // projected
    double depth = 0.0;  // mean depth of the change, relative to the square root of the area
  };

  // Indices in a ring to which creases lead, in order.
  struct CreaseSpokes {
    std::array<std::size_t, 2> at = {0, 0};
    std::size_t count = 0;  // 0 or 2
  };

  const Vector3& point(std::int32_t vertex) const {
    return edited_.mesh.positions[static_cast<std::size_t>(vertex)];
  }
  bool is_own(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return edited_.owners[v] == patch_ && (edited_.is_fixed.empty() || edited_.is_fixed[v] == 0);
  }
  std::span<const std::uint32_t> triangles_of(std::int32_t vertex) const {
    const auto v = static_cast<std::size_t>(vertex);
    return std::span(around_).subspan(edited_.firsts[v], edited_.counts[v]);
  }
  VertexKind kind_of(std::int32_t vertex) const {
    const std::vector<VertexKind>& kinds = edited_.mesh.kinds;
    return kinds.empty() ? VertexKind::kSurface : kinds[static_cast<std::size_t>(vertex)];
  }
  std::int32_t label_of(std::uint32_t triangle) const {
    return edited_.mesh.labels.empty() ? kNoLabel : edited_.mesh.labels[triangle];
  }

  void link(std::span<const std::uint32_t> triangles);
  void widen(std::uint32_t triangle);
  bool find_fan(std::int32_t vertex, Fan* fan) const;
  double fault_around(std::int32_t vertex) const;
  void find_removal(std::int32_t vertex, Change* change) const;
  void find_flip(std::int32_t a, std::int32_t b, Change* change) const;
  void keep_better_change();
  std::optional<CreaseSpokes> crease_spokes(std::int32_t vertex, const Fan& fan) const;
  bool is_crease_straight(std::int32_t vertex, const Fan& fan, const CreaseSpokes& creases) const;
  bool keeps_manifold(const Fan& fan, const Change& change, std::size_t triangle_count) const;
  std::optional<std::int32_t> label_of_all(const Fan& fan, std::size_t begin,
                                           std::size_t count) const;
  double least_cosine(const Fan& fan, std::size_t begin, std::size_t count,
                      const Vector3& direction) const;
  bool fill(const Fan& fan, std::size_t begin, std::size_t end, std::size_t* triangle_count,
            Change* change) const;
  bool is_edge(std::int32_t a, std::int32_t b) const;
  bool is_crease(std::int32_t a, std::int32_t b, std::uint32_t left, std::uint32_t right) const;
  bool is_near_replacement(std::int32_t vertex, const Change& change,
                           std::size_t triangle_count) const;
  void apply(const Change& change);
  void remove_around(std::int32_t vertex, std::uint32_t triangle);
  void add_around(std::int32_t vertex, std::uint32_t triangle);

  EditedMesh& edited_;
  std::uint32_t patch_ = 0;
  std::vector<std::uint32_t> around_;   // triangles around the vertices
  std::vector<std::uint32_t> waiting_;  // narrow triangles to widen
  std::vector<std::uint32_t> narrow_;
  Change best_;
  Change candidate_;
};

}  // namespace prefilter
