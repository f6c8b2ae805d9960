// SPDX-License-Identifier: GPL-3.0-or-later

// Edges of a part of a mesh collapsed and flipped, so that its triangles get wider angles.
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

/// A mesh while patches of it change, several at a time, each with the triangles and the vertices
/// that are its own.
struct EditedMesh {
  static constexpr std::uint32_t kNobody = 0xffffffff;
  static constexpr std::uint32_t kSeveral = 0xfffffffe;

  FacetedMesh mesh;  // a triangle that is gone has no vertices: kGone
  double crease_tolerance = 0.0;
  double most_height = std::numeric_limits<double>::infinity();  // of a change over what was there
  std::vector<std::uint32_t> owners;  // of each vertex: the patch with all of its triangles
  std::vector<std::uint32_t> firsts;  // of the owner's triangles around it
  std::vector<std::uint32_t> counts;
  std::vector<std::uint8_t> is_fixed;  // vertices whose triangles stay as they are; none: no one is
  std::vector<float> widths;           // of each triangle, as width_of has it

  bool is_gone(std::size_t triangle) const { return mesh.triangles[triangle][0] < 0; }
};

inline constexpr std::array<std::int32_t, 3> kGone = {-1, -1, -1};

/// The square of the sine of a triangle's smallest angle; 0 for one without area.
double width_of(const Vector3& a, const Vector3& b, const Vector3& c);

/// Widens the angles of a patch.
class PatchEditor {
 public:
  explicit PatchEditor(EditedMesh* edited) : edited_(*edited) {}

  /// Works on these triangles, in order; `patch` is who owns the vertices that may change.
  void edit(std::uint32_t patch, std::span<const std::uint32_t> triangles);

  /// The triangles that remained narrow.
  const std::vector<std::uint32_t>& narrow() const { return narrow_; }

 private:
  // The triangles around a vertex, which `ring` has the other corners of, counter-clockwise.
  struct Fan {
    std::size_t count = 0;
    std::array<std::int32_t, kMostAround> ring;
    std::array<std::uint32_t, kMostAround> triangles;  // with ring[i] and the one behind it
  };
  // What a vertex or an edge is to be replaced by: triangles with the same border.
  struct Change {
    std::int32_t vertex = -1;  // that is gone; -1: the edge between the first triangles is flipped
    std::size_t old_count = 0;
    std::size_t count = 0;  // 0: there is no change
    std::array<std::uint32_t, kMostAround>
        places;  // the triangles before, the first ones also after
    std::array<std::array<std::int32_t, 3>, kMostAround> triangles;
    std::array<std::int32_t, kMostAround> labels;
    double fault = 0.0;  // of the triangles that it leaves
    double gain = 0.0;   // the faults before less those after
    double area = 0.0;   // as seen from above
    double depth = 0.0;  // of what it cuts off or fills, as a share of the root of the area
  };

  // In the ring of a vertex, in order.
  struct CreasePlaces {
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
  void keep_better();
  std::optional<CreasePlaces> crease_places(std::int32_t vertex, const Fan& fan) const;
  bool goes_straight_on(std::int32_t vertex, const Fan& fan, const CreasePlaces& creases) const;
  bool leaves_manifold(const Fan& fan, const Change& change, std::size_t made) const;
  std::optional<std::int32_t> label_of_all(const Fan& fan, std::size_t begin,
                                           std::size_t count) const;
  double least_cosine(const Fan& fan, std::size_t begin, std::size_t count,
                      const Vector3& direction) const;
  bool fill(const Fan& fan, std::size_t begin, std::size_t end, std::size_t* made,
            Change* change) const;
  bool is_edge(std::int32_t a, std::int32_t b) const;
  bool is_crease(std::int32_t a, std::int32_t b, std::uint32_t left, std::uint32_t right) const;
  bool is_low(std::int32_t vertex, const Change& change, std::size_t made) const;
  void apply(const Change& change);
  void leave(std::int32_t vertex, std::uint32_t triangle);
  void join(std::int32_t vertex, std::uint32_t triangle);

  EditedMesh& edited_;
  std::uint32_t patch_ = 0;
  std::vector<std::uint32_t> around_;   // of the vertices, their triangles
  std::vector<std::uint32_t> waiting_;  // narrow triangles
  std::vector<std::uint32_t> narrow_;
  Change best_;
  Change found_;
};

}  // namespace prefilter
