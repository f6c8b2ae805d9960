// SPDX-License-Identifier: GPL-3.0-or-later

// Checks edge collapses. The distance is bounded by keeping removed vertices as points of the
// triangle that they are near to, and measuring them again whenever that triangle changes. Where
// the surface is so flat that a removal hardly moves it, an accumulated error bound replaces the
// point.
#include "prefilter/voxels/remesh/collapse_check.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace prefilter {
namespace {

// Shares of the tolerance: the error that may accumulate without points, and the distance below
// which edge crossings do not become points.
constexpr double kMaxAccumulatedError = 0.15;
constexpr double kMinCrossingGap = 0.1;
constexpr double kMinTurnCosine = 0.8660254037844386;  // 30 degrees
constexpr double kMinSliverTurnCosine = 0.5;           // 60 degrees
// Height of an edge over the surface between sample points, per spacing of the points and angle
// between the edge's triangles.
constexpr double kRisePerAngle = 0.0625;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool side_is_crease(const Patch& patch, const Ring& ring, std::size_t i, int offset) {
  const PatchTriangle& t = patch.triangle(ring.triangles[i]);
  return ((t.creases >> ((ring.corners[i] + offset) % 3)) & 1U) != 0;
}

double crease_error(const Patch& patch, const Ring& ring, std::size_t spoke) {
  const PatchTriangle& t = patch.triangle(ring.triangles[spoke]);
  return static_cast<double>(t.crease_errors[ring.corners[spoke]]);
}

// Bound on how far edges of the new triangles rise over the surface between sample points.
double rise(const Ring& ring, const RingShape& shape, const NewTriangles& new_triangles,
            std::size_t spoke, double spacing) {
  const std::size_t before = ring.before(spoke);
  double least_cosine = 1.0;
  std::size_t last = spoke;
  for (std::size_t i = ring.next(spoke); i != before; i = ring.next(i)) {
    const double size = new_triangles[i].squared_normal;
    const double turned =
        dot(new_triangles[i].normal, shape.normals[i]) / std::sqrt(size * shape.squared_normals[i]);
    if (!shape.is_sliver[i]) least_cosine = std::min(least_cosine, turned);
    if (last != spoke && !ring.is_crease[i]) {
      least_cosine =
          std::min(least_cosine, dot(new_triangles[i].normal, new_triangles[last].normal) /
                                     std::sqrt(size * new_triangles[last].squared_normal));
    }
    last = i;
  }
  return kRisePerAngle * spacing * std::sqrt(std::max(0.0, 2.0 - 2.0 * least_cosine));
}

// Assigns crossings, existing points and the vertex itself to triangles; false if one is too far.
bool place_points(const Patch& patch, const Ring& ring, const RingShape& shape,
                  const NewTriangles& new_triangles, const Collapse& collapse, double most,
                  double* farthest, CollapseOutcome* outcome) {
  const std::size_t spoke = collapse.spoke;
  for (const Vector3& p : outcome->added) {
    const std::int32_t i = find_nearest(new_triangles, ring, spoke, p, spoke, most, farthest);
    if (i < 0) return false;
    outcome->placements.push_back({-1, i});
  }
  for (std::size_t i = 0; shape.has_points && i < ring.size; ++i) {
    for (std::int32_t p = patch.triangle(ring.triangles[i]).first_point; p >= 0;
         p = patch.points[as_index(p)].next) {
      const std::int32_t place = find_nearest(
          new_triangles, ring, spoke, patch.points[as_index(p)].position, i, most, farthest);
      if (place < 0) return false;
      outcome->placements.push_back({p, place});
    }
  }
  return true;
}
}  // namespace

bool keeps_manifold(const Patch& patch, const PatchLinks& links, const Ring& ring,
                    const Collapse& collapse, std::vector<std::int32_t>* slots) {
  const std::int32_t v = ring.vertices[collapse.spoke];
  const std::size_t after = ring.next(collapse.spoke);
  const std::size_t before = ring.before(collapse.spoke);
  if (!patch.is_shared(v) && ring.size + links.count(v) < 7) return false;
  for (const std::size_t i : {after, before}) {
    const std::int32_t w = ring.vertices[i];
    if (links.count(w) < (patch.is_shared(w) ? 3U : 4U)) return false;
    if (patch.is_shared(v) && patch.is_shared(w) && ring.is_crease[i]) return false;
  }
  const std::int32_t mark = -1 - collapse.vertex;
  for (std::size_t i = 0; i < ring.size; ++i) {
    if (i == collapse.spoke || i == after || i == before) continue;
    if (patch.is_shared(v) && patch.is_shared(ring.vertices[i])) return false;
    (*slots)[as_index(ring.vertices[i])] = mark;
  }
  bool is_linked = false;
  links.for_corners(v, [&](std::int32_t t, std::int32_t corner) {
    const auto& corners = patch.triangle(t).corners;
    for (const std::int32_t other :
         {corners[as_index((corner + 1) % 3)], corners[as_index((corner + 2) % 3)]}) {
      is_linked = is_linked || (*slots)[as_index(other)] == mark;
    }
  });
  for (std::size_t i = 0; i < ring.size; ++i) (*slots)[as_index(ring.vertices[i])] = 0;
  return !is_linked;
}

CreaseOutcome crease_outcome(const Patch& patch, const Ring& ring, const Collapse& collapse) {
  const std::size_t spoke = collapse.spoke;
  const std::size_t before = ring.before(spoke);
  CreaseOutcome outcome;
  // Triangle `spoke` is (u, v, after), triangle `before` is (u, before, v).
  if ((side_is_crease(patch, ring, spoke, 1) && ring.is_crease[ring.next(spoke)]) ||
      (side_is_crease(patch, ring, before, 1) && ring.is_crease[before])) {
    outcome.is_kept = false;
    return outcome;
  }
  if (ring.crease_count == 0) return outcome;
  const Vector3& at = patch.point(collapse.vertex);
  const Vector3& to = patch.point(ring.vertices[spoke]);
  double largest = crease_error(patch, ring, spoke);
  outcome.moved = length(to - at);
  for (std::size_t i = 0; i < ring.size; ++i) {
    if (i == spoke || !ring.is_crease[i]) continue;
    largest = std::max(largest, crease_error(patch, ring, i));
    const Vector3& from = patch.point(ring.vertices[i]);
    if (!(dot(to - at, at - from) > 0.0)) outcome.is_kept = false;
    outcome.moved = std::sqrt(squared_distance_to_segment(at, from, to));
  }
  outcome.error = largest + outcome.moved;
  outcome.is_kept = outcome.is_kept && outcome.error <= 1.0;
  return outcome;
}

bool make_triangles(const Patch& patch, const Ring& ring, const RingShape& shape,
                    const Collapse& collapse, NewTriangles* new_triangles) {
  const std::size_t before = ring.before(collapse.spoke);
  const Vector3& to = patch.point(ring.vertices[collapse.spoke]);
  for (std::size_t i = 0; i < ring.size; ++i) {
    if (i == collapse.spoke || i == before) continue;
    const Vector3& p = patch.point(ring.vertices[i]);
    const Vector3& q = patch.point(ring.vertices[ring.next(i)]);
    MeasuredTriangle& new_triangle = (*new_triangles)[i];
    new_triangle = MeasuredTriangle(to, p, q);
    const double longest =
        std::max({squared_length(p - to), squared_length(q - to), squared_length(q - p)});
    if (!(new_triangle.squared_normal >= shape.squared_height * longest &&
          new_triangle.squared_normal > 0.0)) {
      return false;
    }
    const bool is_free = shape.is_sliver[i];
    const double along = dot(new_triangle.normal,
                             is_free ? shape.sector_normals[shape.sectors[i]] : shape.normals[i]);
    const double least = is_free ? kMinSliverTurnCosine * kMinSliverTurnCosine
                                 : kMinTurnCosine * kMinTurnCosine * shape.squared_normals[i];
    if (!(along > 0.0 && along * along >= least * new_triangle.squared_normal)) return false;
  }
  return true;
}

std::int32_t find_nearest(const NewTriangles& new_triangles, const Ring& ring, std::size_t spoke,
                          const Vector3& point, std::size_t hint, double most, double* farthest) {
  const std::size_t before = ring.before(spoke);
  const double accepted = 0.25 * most;
  double least = kInfinity;
  std::size_t best = hint;
  if (hint != spoke && hint != before) least = new_triangles[hint].squared_distance(point);
  for (std::size_t i = 0; i < ring.size && least > accepted; ++i) {
    if (i == spoke || i == before || i == hint) continue;
    const double squared = new_triangles[i].squared_distance(point);
    if (squared < least) {
      least = squared;
      best = i;
    }
  }
  if (!(least <= most)) return -1;
  *farthest = std::max(*farthest, least);
  return static_cast<std::int32_t>(best);
}

double measure_crossings(const Patch& patch, const Ring& ring, const RingShape& shape,
                         const Collapse& collapse, double most, std::vector<Vector3>* crossings) {
  const std::size_t spoke = collapse.spoke;
  const Vector3& from = patch.point(collapse.vertex);
  const Vector3& to = patch.point(ring.vertices[spoke]);
  const std::size_t before = ring.before(spoke);
  const std::size_t after = ring.next(spoke);
  const Vector3 apart = to - from;
  double largest = 0.0;
  for (std::size_t i = 0; i < ring.size; ++i) {
    if (i == spoke) continue;
    const Vector3 old_side = patch.point(ring.vertices[i]) - from;
    for (std::size_t j = 0; j < ring.size; ++j) {
      if (j == spoke || j == before || j == after || j == i) continue;
      if (!share_sector(ring, shape, i, j)) continue;
      const Vector3 new_side = patch.point(ring.vertices[j]) - to;
      const Vector3 normal = cross(old_side, new_side);
      const double size = squared_length(normal);
      if (!(size > 0.0)) continue;
      const double along_old = dot(cross(apart, new_side), normal);
      const double along_new = dot(cross(apart, old_side), normal);
      if (!(along_old > 0.0 && along_old < size && along_new > 0.0 && along_new < size)) continue;
      const double gap = std::abs(dot(apart, normal)) / std::sqrt(size);
      if (!(gap <= most)) return -1.0;
      largest = std::max(largest, gap);
      if (gap > kMinCrossingGap) crossings->push_back(from + (along_old / size) * old_side);
    }
  }
  return largest;
}

double measure_samples(const Patch& patch, const Ring& ring, const NewTriangles& new_triangles,
                       const Collapse& collapse, double most, std::vector<Vector3>* crossings) {
  const std::size_t spoke = collapse.spoke;
  const std::size_t before = ring.before(spoke);
  const Vector3& from = patch.point(collapse.vertex);
  const Vector3& to = patch.point(ring.vertices[spoke]);
  std::array<MeasuredTriangle, kMaxNeighbors> old;
  for (std::size_t i = 0; i < ring.size; ++i) {
    old[i] = MeasuredTriangle(from, patch.point(ring.vertices[i]),
                              patch.point(ring.vertices[ring.next(i)]));
  }
  double largest = 0.0;
  const auto is_near = [&](const Vector3& p, bool is_old) {
    double least = kInfinity;
    for (std::size_t i = 0; i < ring.size; ++i) {
      if (is_old && (i == spoke || i == before)) continue;
      least = std::min(least, (is_old ? new_triangles : old)[i].squared_distance(p));
    }
    largest = std::max(largest, least);
    if (is_old && least > kMinCrossingGap * kMinCrossingGap) crossings->push_back(p);
    return least <= most * most;
  };
  for (std::size_t i = 0; i < ring.size; ++i) {
    const Vector3& p = patch.point(ring.vertices[i]);
    const Vector3& q = patch.point(ring.vertices[ring.next(i)]);
    const bool is_made = i != spoke && i != before;
    const Vector3 side = p - from;
    const Vector3 other = p - to;
    for (const double along : {0.25, 0.5, 0.75}) {
      if (!is_near(from + along * side, true)) return -1.0;
      if (is_made && !is_near(to + along * other, false)) return -1.0;
    }
    if (!is_near((1.0 / 3.0) * (from + p + q), true)) return -1.0;
    if (is_made && !is_near((1.0 / 3.0) * (to + p + q), false)) return -1.0;
  }
  return std::sqrt(largest);
}

bool is_within_tolerance(const Patch& patch, const Ring& ring, const RingShape& shape,
                         const NewTriangles& new_triangles, const CreaseOutcome& creases,
                         const Collapse& collapse, CollapseOutcome* outcome) {
  outcome->placements.clear();
  outcome->added.clear();
  outcome->error = shape.error;
  outcome->deviation = shape.deviation;
  outcome->crease_error = creases.error;
  outcome->adds_points = false;
  const double bound = shape.error + shape.range + creases.moved;
  if (!shape.has_points && !shape.is_bent && bound <= kMaxAccumulatedError) {
    outcome->error = bound;
    return true;
  }
  const double most = 1.0 - shape.error;
  const std::size_t spoke = collapse.spoke;
  const Vector3& at = patch.point(collapse.vertex);
  double farthest = 0.0;
  const std::int32_t near =
      find_nearest(new_triangles, ring, spoke, at, spoke, most * most, &farthest);
  if (near < 0) return false;
  double gap = measure_crossings(patch, ring, shape, collapse, most, &outcome->added);
  if (gap < 0.0) return false;
  // If the ring cannot be projected as a whole, crossings do not bound the distance; sample
  // instead.
  if (shape.is_bent) {
    const double other =
        measure_samples(patch, ring, new_triangles, collapse, most, &outcome->added);
    if (other < 0.0) return false;
    gap = std::max(gap, other);
  }
  if (!shape.has_points) {
    const double moved =
        std::max(gap, std::sqrt(new_triangles[as_index(near)].squared_distance(at)));
    if (shape.error + moved <= kMaxAccumulatedError) {
      outcome->error = shape.error + moved;
      return true;
    }
  }
  if (!place_points(patch, ring, shape, new_triangles, collapse, most * most, &farthest, outcome)) {
    return false;
  }
  outcome->deviation =
      std::min(shape.deviation + gap,
               std::sqrt(farthest) + rise(ring, shape, new_triangles, spoke, patch.spacing));
  if (!(outcome->deviation <= most)) return false;
  outcome->added.push_back(at);
  outcome->placements.push_back({-1, near});
  outcome->adds_points = true;
  return true;
}

}  // namespace prefilter
