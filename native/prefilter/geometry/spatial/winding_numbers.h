// SPDX-License-Identifier: GPL-3.0-or-later

// How often a mesh winds around points, open or not.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/progress.h"
#include "prefilter/geometry/spatial/box_tree.h"

namespace prefilter {

/// Generalized winding numbers: the solid angle that the triangles take up, seen from a point, as a
/// share of all directions; positive where they are seen from their back. A closed mesh has 1
/// inside and 0 outside, in steps at its surface; holes make it smooth. Seen from a point in its
/// own plane a triangle takes up nothing, so on the surface it is the mean of both sides.
class WindingNumbers {
 public:
  /// Throws Error as check_mesh does, for positions above 1e100; Error(kCancelled).
  WindingNumbers(const InputMesh& mesh, const Progress& progress, int threads);

  /// To about 0.01: what is far away is taken as one plane piece. The same for any number of
  /// threads. Throws Error for points that are not finite; Error(kCancelled).
  std::vector<double> find(std::span<const Vector3> points, const Progress& progress,
                           int threads) const;

  /// What is this many radii away is taken as one piece: 2 are enough to tell 0 from 1.
  double at(const Vector3& point, double far_radii = 4.0) const;

  /// What the winding number at `from` is more than at `to`: one for each triangle that the segment
  /// leaves through, less those that it enters through. Nothing where it all but meets the border
  /// of one. Takes what the triangles near the segment take.
  std::optional<double> excess(const Vector3& from, const Vector3& to) const;

 private:
  // What a node's triangles are from afar.
  struct Far {
    Vector3 middle;
    Vector3 normal;  // the sum of their areas along their normals
    double squared_radius;
  };
  // That of a node whose children have theirs; `areas` are the nodes', this one's is set.
  Far far_of(std::size_t n, std::vector<double>* areas) const;

  std::vector<std::array<Vector3, 3>> triangles_;  // along the Morton curve
  BoxTree tree_;
  std::vector<Far> fars_;
};

}  // namespace prefilter
