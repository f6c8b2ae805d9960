// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/remesh/collapse.h"

namespace prefilter {
namespace {

void attach_points(const Ring& ring, const CollapseOutcome& outcome, Patch* patch) {
  for (std::size_t i = 0; i < ring.size; ++i) {
    patch->triangle(ring.triangles[i]).first_point = -1;
  }
  auto added = outcome.added.begin();
  for (const CollapseOutcome::Placement& placement : outcome.placements) {
    std::int32_t p = placement.point;
    if (p < 0) {
      p = static_cast<std::int32_t>(patch->points.size());
      patch->points.push_back({*added++, -1});
    }
    std::int32_t& first = patch->triangle(ring.triangles[as_index(placement.triangle)]).first_point;
    patch->points[as_index(p)].next = first;
    first = p;
  }
}

// A triangle that disappears, merging its sides from the vertex and from the neighbor.
struct Closing {
  std::size_t dead;
  std::size_t side;        // its side from the vertex
  std::size_t other_side;  // its side from the neighbor
  std::size_t beside;      // index of the adjacent triangle in the ring
  std::size_t beside_side;
  std::int32_t end;  // common end of both sides
};

// Transfers the creases of both sides to the triangles on either side.
void join_sides(const Ring& ring, const Closing& closing, std::int32_t neighbor, float error,
                const PatchLinks& links, Patch* patch) {
  const PatchTriangle gone = patch->triangle(ring.triangles[closing.dead]);
  PatchTriangle& kept = patch->triangle(ring.triangles[closing.beside]);
  if (((gone.creases >> closing.other_side) & 1U) != 0) {
    kept.creases = static_cast<std::uint8_t>(kept.creases | (1U << closing.beside_side));
    kept.crease_errors[closing.beside_side] = gone.crease_errors[closing.other_side];
  }
  if (((gone.creases >> closing.side) & 1U) == 0) return;
  links.for_corners(neighbor, [&](std::int32_t t, std::int32_t corner) {
    PatchTriangle& other = patch->triangle(t);
    if (t == ring.triangles[closing.dead]) return;
    for (const std::int32_t side : {corner, (corner + 2) % 3}) {
      const std::int32_t from = other.corners[as_index(side)];
      const std::int32_t to = other.corners[as_index((side + 1) % 3)];
      if ((from == neighbor && to == closing.end) || (from == closing.end && to == neighbor)) {
        other.creases = static_cast<std::uint8_t>(other.creases | (1U << side));
        other.crease_errors[as_index(side)] = error;
      }
    }
  });
}

void relink(const Ring& ring, const Collapse& which, Patch* patch, PatchLinks* links) {
  const std::int32_t to = ring.vertices[which.spoke];
  const std::size_t before = ring.before(which.spoke);
  for (const std::size_t dead : {which.spoke, before}) {
    const std::int32_t t = ring.triangles[dead];
    drop_corner(which.vertex, t, links);
    drop_corner(to, t, links);
    drop_corner(ring.vertices[dead == which.spoke ? ring.next(dead) : before], t, links);
    patch->triangle(t).corners.fill(to);
    patch->triangle(t).first_point = -1;
  }
  move_corners(which.vertex, to, links);
}
}  // namespace

void collapse(const Ring& ring, const Collapse& which, const CollapseOutcome& outcome, Patch* patch,
              PatchLinks* links) {
  const std::size_t spoke = which.spoke;
  const std::int32_t to = ring.vertices[spoke];
  const std::size_t before = ring.before(spoke);
  const std::size_t after = ring.next(spoke);
  const auto crease_error = static_cast<float>(outcome.crease_error);
  if (outcome.adds_points) attach_points(ring, outcome, patch);
  {
    // triangle (u, v, after) is adjacent to triangle `after`
    const std::size_t c = ring.corners[spoke];
    const Closing closing = {spoke, (c + 2) % 3,         (c + 1) % 3,
                             after, ring.corners[after], ring.vertices[after]};
    join_sides(ring, closing, to, crease_error, *links, patch);
  }
  {
    // triangle (u, before, v) is adjacent to the previous one
    const std::size_t c = ring.corners[before];
    const std::size_t beside = ring.before(before);
    const std::size_t beside_side = (ring.corners[beside] + 2U) % 3;
    const Closing closing = {before, c, (c + 1) % 3, beside, beside_side, ring.vertices[before]};
    join_sides(ring, closing, to, crease_error, *links, patch);
  }
  for (std::size_t i = 0; i < ring.size; ++i) {
    PatchTriangle& t = patch->triangle(ring.triangles[i]);
    t.error = static_cast<float>(outcome.error);
    t.deviation = static_cast<float>(outcome.deviation);
    t.is_new = true;
    if (ring.crease_count > 0 && i != spoke && ring.is_crease[i]) {
      t.crease_errors[ring.corners[i]] = crease_error;
      const std::size_t other = ring.before(i);
      patch->triangle(ring.triangles[other]).crease_errors[(ring.corners[other] + 2U) % 3] =
          crease_error;
    }
    t.corners[ring.corners[i]] = to;
  }
  patch->targets[as_index(which.vertex)] = to;
  relink(ring, which, patch, links);
}

}  // namespace prefilter
