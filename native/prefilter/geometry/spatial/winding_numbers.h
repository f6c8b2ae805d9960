// SPDX-License-Identifier: GPL-3.0-or-later

// Winding numbers of closed and open meshes around points.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/run.h"
#include "prefilter/geometry/spatial/box_tree.h"

namespace prefilter {

/// Generalized winding numbers: the total solid angle of the triangles seen from a point, as a
/// fraction of the sphere; positive for back faces. A closed mesh has 1 inside and 0 outside, with
/// a jump at its surface; holes make the transition smooth. From a point in its own plane a
/// triangle has no solid angle, so on the surface the value is the mean of both sides.
class WindingNumbers {
 public:
  /// Throws Error like check_mesh, with a limit of 1e100 for positions; Error(kCancelled).
  WindingNumbers(const InputMesh& mesh, const Run& run);

  /// Winding numbers of points, accurate to about 0.01: distant triangles are approximated
  /// together. The result is the same for any number of threads. Throws Error for points that are
  /// not finite; Error(kCancelled).
  std::vector<double> find(std::span<const Vector3> points, const Run& run) const;

  /// Approximates nodes farther away than this many radii; 2 suffice to distinguish 0 from 1.
  double at(const Vector3& point, double far_radii = 4.0) const;

  /// The winding number at `from` minus that at `to`: the number of triangles through which the
  /// segment leaves minus those through which it enters. Nothing if it passes too close to the
  /// border of a triangle. The time depends only on the triangles near the segment.
  std::optional<double> excess(const Vector3& from, const Vector3& to) const;

 private:
  // The far-field approximation of a node's triangles.
  struct FarField {
    Vector3 middle;
    Vector3 normal;  // sum of the area vectors
    double squared_radius;
  };
  // Approximates a node whose children have been processed; sets its entry in `areas`.
  FarField far_field_of(std::size_t n, std::vector<double>* areas) const;

  std::vector<std::array<Vector3, 3>> triangles_;  // along the Morton curve
  BoxTree tree_;
  std::vector<FarField> far_fields_;
};

}  // namespace prefilter
