// SPDX-License-Identifier: GPL-3.0-or-later

// Whether a vertex of a patch may be collapsed onto a neighbor.
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

/// A vertex that would go to a neighbor: number `spoke` of its ring. The ring's triangles before
/// and behind that go as well.
struct Collapse {
  std::int32_t vertex;
  std::size_t spoke;
};

/// The ring's triangles after a collapse, where they are not gone.
using NewTriangles = std::array<MeasuredTriangle, kMostNeighbors>;

/// Whether what comes out is a two-manifold again, whatever other patches do to the vertices that
/// they share with this one. `slots` has a place for each vertex, and is left with anything in it.
bool is_sound(const Patch& patch, const PatchLinks& links, const Ring& ring,
              const Collapse& collapse, std::vector<std::int32_t>* slots);

/// What becomes of creases through the vertex.
struct CreaseOutcome {
  bool is_kept = true;  // they do not meet others, turn back, or move by more than the tolerance
  double error = 0.0;
  double moved = 0.0;
};
CreaseOutcome crease_outcome(const Patch& patch, const Ring& ring, const Collapse& collapse);

/// False where a triangle would turn by more than 30 degrees, or be too thin.
bool make_triangles(const Patch& patch, const Ring& ring, const RingShape& shape,
                    const Collapse& collapse, NewTriangles* made);

/// The ring's triangle whose new one is nearest to a point, where its squared distance, which
/// `farthest` is raised to, is at most `most`; -1 where none is. The one that it was near to,
/// `hint`, comes first, and will do where it is very near.
std::int32_t find_near(const NewTriangles& made, const Ring& ring, std::size_t spoke,
                       const Vector3& point, std::size_t hint, double most, double* farthest);

/// The largest distance between old and new edges where they cross; -1 where it is above `most`.
/// Adds the places on the old ones where it is more than a tenth of the tolerance.
double measure_crossings(const Patch& patch, const Ring& ring, const RingShape& shape,
                         const Collapse& collapse, double most, std::vector<Vector3>* crossings);

/// The largest distance of places on old triangles from new ones and of new ones from old ones; -1
/// where it is above `most`. Adds those on old ones as measure_crossings does.
double measure_places(const Patch& patch, const Ring& ring, const NewTriangles& made,
                      const Collapse& collapse, double most, std::vector<Vector3>* crossings);

/// What a collapse that may be made does to what is known of the surface given up.
struct Outcome {
  double error = 0.0;
  double deviation = 0.0;
  double crease_error = 0.0;
  /// Points of the surface given up, if they are kept: each goes to a triangle of the ring.
  struct Place {
    std::int32_t point;  // -1: one of `added`, in order
    std::int32_t triangle;
  };
  std::vector<Place> places;
  std::vector<Vector3> added;
  bool adds_points = false;
};

/// Whether the surface stays within the tolerance. `made` are as make_triangles leaves them.
bool stays_near(const Patch& patch, const Ring& ring, const RingShape& shape,
                const NewTriangles& made, const CreaseOutcome& creases, const Collapse& collapse,
                Outcome* outcome);

}  // namespace prefilter
