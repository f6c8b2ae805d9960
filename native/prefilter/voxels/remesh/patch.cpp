// SPDX-License-Identifier: GPL-3.0-or-later

// Half-edge collapses in order of the quadric error (M. Garland, P. Heckbert, Surface
// simplification using quadric error metrics, 1997). The quadrics determine the order, and which
// collapses are not worth checking.
#include "prefilter/voxels/remesh/patch.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <span>

#include "prefilter/voxels/remesh/collapse.h"
#include "prefilter/voxels/remesh/collapse_check.h"
#include "prefilter/voxels/remesh/measured_triangle.h"
#include "prefilter/voxels/remesh/patch_links.h"
#include "prefilter/voxels/remesh/quadric.h"
#include "prefilter/voxels/remesh/ring_shape.h"

namespace prefilter {
namespace {

constexpr int kMaxCollapseTries = 4;  // neighbors tried, cheapest first
// Maximum mean squared distance from planes, in squared tolerances; of a thousand collapses above
// it, about two would be allowed.
constexpr double kMaxCollapseCost = 2.0;
constexpr double kLengthWeight = 1e-6;
// A vertex is queued again only if its cost has grown by more than this factor and term.
constexpr double kMaxCostGrowth = 1.5;
constexpr double kMinCostGrowth = 0.01;
constexpr double kNoCost = std::numeric_limits<double>::infinity();

std::vector<Quadric> sum_quadrics(const Patch& patch) {
  std::vector<Quadric> quadrics(patch.positions.size());
  for (const PatchTriangle& t : patch.triangles) {
    const Vector3& a = patch.point(t.corners[0]);
    const Vector3 normal = cross(patch.point(t.corners[1]) - a, patch.point(t.corners[2]) - a);
    const double area = length(normal);
    if (!(area > 0.0)) continue;
    const Vector3 unit = (1.0 / area) * normal;
    const double offset = -dot(unit, a);
    for (const std::int32_t v : t.corners) quadrics[as_index(v)].add_plane(unit, offset, area);
  }
  return quadrics;
}

// Cost of collapsing u onto v; infinite if it is not worth checking.
double cost_of(const Patch& patch, const std::vector<Quadric>& quadrics, std::int32_t u,
               std::int32_t v) {
  const double cost = quadrics[as_index(u)].mean_at(patch.point(v));
  if (!(cost < kMaxCollapseCost)) return kNoCost;
  return cost + kLengthWeight * squared_length(patch.point(v) - patch.point(u));
}

// Vertices that may be removable, the cheapest first.
class RemovalQueue {
 public:
  struct Entry {
    float cost;
    std::int32_t vertex;
    bool operator<(const Entry& other) const {
      if (cost != other.cost) return cost > other.cost;
      return vertex > other.vertex;
    }
  };

  explicit RemovalQueue(std::size_t vertices) : is_queued_(vertices, 0) {}

  bool empty() const { return queue_.empty(); }
  float least_cost() const { return queue_.top().cost; }
  bool has(std::int32_t vertex) const { return is_queued_[as_index(vertex)] != 0; }
  void push(double cost, std::int32_t vertex) {
    queue_.push({static_cast<float>(cost), vertex});
    is_queued_[as_index(vertex)] = 1;
  }
  Entry pop() {
    const Entry top = queue_.top();
    queue_.pop();
    is_queued_[as_index(top.vertex)] = 0;
    return top;
  }

 private:
  std::priority_queue<Entry> queue_;
  std::vector<std::uint8_t> is_queued_;
};

// Queues a vertex if it may be removable; it must not be queued already.
void enqueue(const Patch& patch, const PatchLinks& links, const std::vector<Quadric>& quadrics,
             std::int32_t u, RemovalQueue* queue) {
  if ((patch.flags[as_index(u)] & (Patch::kShared | Patch::kFixed)) != 0) return;
  double least = kNoCost;
  links.for_corners(u, [&](std::int32_t t, std::int32_t corner) {
    const std::int32_t v = patch.triangle(t).corners[as_index((corner + 1) % 3)];
    least = std::min(least, cost_of(patch, quadrics, u, v));
  });
  if (least < kNoCost) queue->push(least, u);
}

struct Candidate {
  double cost;
  std::size_t spoke;

  bool operator<(const Candidate& other) const {
    return cost != other.cost ? cost < other.cost : spoke < other.spoke;
  }
};

// Neighbors onto which a vertex may be collapsed; the ones to try are sorted by cost. A vertex on a
// crease is only collapsed along it.
std::span<const Candidate> candidates_of(const Patch& patch, const std::vector<Quadric>& quadrics,
                                         std::int32_t u, const Ring& ring,
                                         std::array<Candidate, kMaxNeighbors>* all) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < ring.size; ++i) {
    if (ring.crease_count > 0 && (ring.crease_count > 2 || !ring.is_crease[i])) continue;
    const double cost = cost_of(patch, quadrics, u, ring.vertices[i]);
    if (cost < kNoCost) (*all)[count++] = {cost, i};
  }
  const std::size_t tries = std::min<std::size_t>(count, kMaxCollapseTries);
  const auto begin = all->begin();
  std::partial_sort(begin, begin + static_cast<std::ptrdiff_t>(tries),
                    begin + static_cast<std::ptrdiff_t>(count));
  return std::span(*all).first(tries);
}

// Scratch space for one vertex at a time.
struct Workspace {
  Ring ring;
  RingShape shape;
  NewTriangles new_triangles;
  CollapseOutcome outcome;
  std::vector<std::int32_t> slots;
  std::array<Candidate, kMaxNeighbors> candidates;
};

bool check_collapse(const Patch& patch, const PatchLinks& links, const Collapse& which,
                    Workspace* work) {
  const CreaseOutcome creases = crease_outcome(patch, work->ring, which);
  return creases.is_kept &&
         make_triangles(patch, work->ring, work->shape, which, &work->new_triangles) &&
         keeps_manifold(patch, links, work->ring, which, &work->slots) &&
         is_within_tolerance(patch, work->ring, work->shape, work->new_triangles, creases, which,
                             &work->outcome);
}

void try_to_remove(const RemovalQueue::Entry& entry, Patch* patch, PatchLinks* links,
                   std::vector<Quadric>* quadrics, RemovalQueue* queue, Workspace* work) {
  const std::int32_t u = entry.vertex;
  const Ring& ring = work->ring;
  if (links->count(u) == 0) return;
  if (!find_ring(u, patch->triangles, *links, &work->slots, &work->ring)) return;
  const std::span<const Candidate> candidates =
      candidates_of(*patch, *quadrics, u, ring, &work->candidates);
  if (candidates.empty()) return;
  // The surroundings have changed, so other vertices may be cheaper now.
  const double cost = candidates.front().cost;
  if (!queue->empty() && cost > kMaxCostGrowth * static_cast<double>(entry.cost) + kMinCostGrowth &&
      cost > static_cast<double>(queue->least_cost())) {
    queue->push(cost, u);
    return;
  }
  measure_ring(*patch, u, ring, &work->shape);
  for (const Candidate& candidate : candidates) {
    const Collapse which = {u, candidate.spoke};
    if (!check_collapse(*patch, *links, which, work)) continue;
    collapse(ring, which, work->outcome, patch, links);
    (*quadrics)[as_index(ring.vertices[which.spoke])].add((*quadrics)[as_index(u)]);
    for (std::size_t i = 0; i < ring.size; ++i) {
      const std::int32_t w = ring.vertices[i];
      if (!queue->has(w)) enqueue(*patch, *links, *quadrics, w, queue);
    }
    return;
  }
}
}  // namespace

void simplify_patch(Patch* patch) {
  PatchLinks links = link_corners(patch->positions.size(), patch->triangles);
  std::vector<Quadric> quadrics = sum_quadrics(*patch);
  RemovalQueue queue(patch->positions.size());
  Workspace work;
  work.slots.assign(patch->positions.size(), 0);
  patch->targets.assign(patch->positions.size(), -1);
  for (std::size_t v = 0; v < patch->positions.size(); ++v) {
    if ((patch->flags[v] & Patch::kPending) == 0) continue;
    enqueue(*patch, links, quadrics, static_cast<std::int32_t>(v), &queue);
  }
  while (!queue.empty()) try_to_remove(queue.pop(), patch, &links, &quadrics, &queue, &work);
}

}  // namespace prefilter
