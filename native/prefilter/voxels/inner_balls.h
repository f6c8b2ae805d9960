// SPDX-License-Identifier: GPL-3.0-or-later

// Balls inside of a solid that touch its surface on two sides.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/spatial/box_tree.h"

namespace prefilter {

/// A distance from a surface at which a point is outside of it, in cells.
inline constexpr double kJustOutside = 0.01;

/// A ball inside of the solid that touches a point from within, and what is across.
struct InnerBall {
  double radius;
  double facing;  // the least cosine between the normals of the point and of what is across
  double across;  // that with what it touches
};

/// Searches among the triangles of a mesh that are given; lengths are cells.
class InnerBalls {
 public:
  /// Holds no copy of the mesh. Throws Error(kCancelled).
  InnerBalls(const MeshView<std::int32_t>& mesh, std::span<const Vector3> normals,
             const std::vector<std::uint32_t>& triangles, const Progress& progress, int threads);

  /// The triangles that are across from a piece of one, as near as a ball at it may reach.
  struct Across {
    struct One {
      std::array<Vector3, 3> corners;
      Box box;
      Vector3 normal;
      double facing;
    };
    std::vector<One> triangles;
    bool has_more = false;  // then all are searched
    bool is_empty() const { return triangles.empty(); }
  };
  void find_across(const std::array<Vector3, 3>& piece, const Vector3& normal, double largest,
                   Across* across) const;

  /// Whether a point of the surface with this normal bounds the solid, on either side: of sheets
  /// both may.
  using IsOuter = std::function<bool(const Vector3& point, const Vector3& normal)>;

  /// The largest ball at a point of a piece that holds nothing of what is across from it: it
  /// shrinks until it touches that. None where a ball of the largest radius fits. What is within
  /// another part counts below the point alone: a plate is as thin above a leg as beside it, but
  /// not beside what is sunk into it.
  std::optional<InnerBall> at(const Vector3& point, const Vector3& normal, double largest,
                              const Across& across, const IsOuter& is_outer) const;

  /// Whether a piece of a triangle is as thin everywhere, by samples, within other parts or not.
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
    InnerBall ball;
    Touched touched;  // nothing where the ball is the largest
  };
  // The ball that holds nothing of what is across, or of what of it counts.
  Shrunk shrunk(const Vector3& start, const Vector3& normal, double largest, const Across& across,
                const Counts* counts) const;
  // What is nearest to a point, and nearer than this, of all that is across from a normal.
  std::optional<Touched> nearest_across(const Vector3& point, double reach, const Vector3& normal,
                                        const Across& across, const Counts* counts) const;

  MeshView<std::int32_t> mesh_;
  std::span<const Vector3> normals_;
  std::vector<std::uint32_t> triangles_;  // along the curve
  BoxTree tree_;
  std::vector<std::uint64_t> directions_;  // of what is below each node, as bits
};

}  // namespace prefilter
