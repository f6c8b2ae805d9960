// SPDX-License-Identifier: GPL-3.0-or-later

// Checks whether a vertex of a patch may be collapsed onto a neighbor.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/voxels/remesh/measured_triangle.h"
#include "prefilter/voxels/remesh/patch.h"
#include "prefilter/voxels/remesh/patch_links.h"
#include "prefilter/voxels/remesh/ring_shape.h"

namespace prefilter {

/// Collapse of a vertex onto neighbor number `spoke` of its ring. The ring's triangles before and
/// after the neighbor disappear.
struct Collapse {
  std::int32_t vertex;
  std::size_t spoke;
};

/// The ring's triangles after a collapse; the two that disappear are unset.
using NewTriangles = std::array<MeasuredTriangle, kMaxNeighbors>;

/// Whether the result is a two-manifold, whatever other patches do to shared vertices. `slots` is
/// scratch space with one entry per vertex.
bool keeps_manifold(const Patch& patch, const PatchLinks& links, const Ring& ring,
                    const Collapse& collapse, std::vector<std::int32_t>* slots);

/// Effect on creases through the vertex.
struct CreaseOutcome {
  // they neither meet others, nor turn back, nor move by more than the tolerance
  bool is_kept = true;
  double error = 0.0;
  double moved = 0.0;
};
CreaseOutcome crease_outcome(const Patch& patch, const Ring& ring, const Collapse& collapse);

/// Computes the new triangles; false if one would turn by more than 30 degrees or become too thin.
bool make_triangles(const Patch& patch, const Ring& ring, const RingShape& shape,
                    const Collapse& collapse, NewTriangles* new_triangles);

/// Index of the new triangle nearest to a point if its squared distance is at most `most`; -1
/// otherwise. Raises `farthest` to that distance. `hint`, the triangle that the point was near to,
/// is tested first, and accepted if it is very near.
std::int32_t find_nearest(const NewTriangles& new_triangles, const Ring& ring, std::size_t spoke,
                          const Vector3& point, std::size_t hint, double most, double* farthest);

/// The largest distance between old and new edges where they cross in projection; -1 if it exceeds
/// `most`. Adds the points of old edges where it exceeds a tenth of the tolerance.
double measure_crossings(const Patch& patch, const Ring& ring, const RingShape& shape,
                         const Collapse& collapse, double most, std::vector<Vector3>* crossings);

/// The largest distance of sample points on old triangles from new ones, and vice versa; -1 if it
/// exceeds `most`. Adds points of old triangles as measure_crossings does.
double measure_samples(const Patch& patch, const Ring& ring, const NewTriangles& new_triangles,
                       const Collapse& collapse, double most, std::vector<Vector3>* crossings);

/// Effect of an allowed collapse on the record of the original surface.
struct CollapseOutcome {
  double error = 0.0;
  double deviation = 0.0;
  double crease_error = 0.0;
  /// Points of the original surface that are kept, with the triangle of the ring for each.
  struct Placement {
    std::int32_t point;  // -1: one of `added`, in order
    std::int32_t triangle;
  };
  std::vector<Placement> placements;
  std::vector<Vector3> added;
  bool adds_points = false;
};

/// Whether the surface stays within the tolerance. `new_triangles` is the result of make_triangles.
bool is_within_tolerance(const Patch& patch, const Ring& ring, const RingShape& shape,
                         const NewTriangles& new_triangles, const CreaseOutcome& creases,
                         const Collapse& collapse, CollapseOutcome* outcome);

}  // namespace prefilter
