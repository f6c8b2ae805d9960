// SPDX-License-Identifier: GPL-3.0-or-later

// Balls inside a solid that touch its surface on two sides.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/spatial/box_tree.h"

namespace prefilter {

/// Distance from a surface, in cells, at which a point counts as outside.
inline constexpr double kJustOutside = 0.01;

/// A ball inside the solid that touches a point from within, and another point opposite to it.
struct InnerBall {
  double radius;
  double facing;  // least cosine between the normals of the point and of opposite triangles met
  double across;  // cosine for the triangle that the ball touches
};

/// Searches the given triangles of a mesh; lengths are in cells.
class InnerBalls {
 public:
  /// Keeps a reference to the mesh. Throws Error(kCancelled).
  InnerBalls(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
             const std::vector<std::uint32_t>& triangles, const Run& run);

  /// The triangles opposite to a piece of a triangle, within reach of a ball at the piece.
  struct Across {
    struct One {
      std::array<Vector3, 3> corners;
      Box box;
      Vector3 normal;
      double facing;
    };
    std::vector<One> triangles;
    bool has_more = false;  // then the tree is searched instead
    bool is_empty() const { return triangles.empty(); }
  };
  void find_across(const std::array<Vector3, 3>& piece, const Vector3& normal, double largest,
                   Across* across) const;

  /// Whether a surface point with the given normal bounds the solid on either side; on sheets both
  /// sides may.
  using IsOuter = std::function<bool(const Vector3& point, const Vector3& normal)>;

  /// The largest ball at a point of a piece that contains no opposite surface: starting at radius
  /// `largest`, it shrinks until it touches one. None if a ball of the largest radius fits.
  /// Surfaces inside other parts only count straight below the point: a plate is as thin above a
  /// leg as beside it, but not beside a part that is sunk into it.
  std::optional<InnerBall> at(const Vector3& point, const Vector3& normal, double largest,
                              const Across& across, const IsOuter& is_outer) const;

  /// Whether samples show a piece to be equally thin everywhere, including parts inside other
  /// parts.
  bool are_alike(const std::array<Vector3, 3>& piece, const Vector3& normal, double largest,
                 const Across& across) const;

 private:
  struct Touched {
    Vector3 point;
    Vector3 normal;
    double facing;
  };
  using Counts = IsOuter;
  struct Shrunk {
    InnerBall ball;   // unset if the ball has the largest radius
    Touched touched;  // nothing where the ball is the largest
  };
  // The ball that contains no opposite surface, or none that `counts`.
  Shrunk shrunk(const Vector3& start, const Vector3& normal, double largest, const Across& across,
                const Counts* counts) const;
  // The nearest point of the opposite surface within `reach` of a point.
  std::optional<Touched> nearest_across(const Vector3& point, double reach, const Vector3& normal,
                                        const Across& across, const Counts* counts) const;

  MeshView<std::int32_t> mesh_;
  std::span<const Vector3> normals_;
  std::vector<std::uint32_t> triangles_;  // along the Morton curve
  BoxTree tree_;
  std::vector<std::uint64_t> directions_;  // bit mask of the directions below each node
};

}  // namespace prefilter
