// SPDX-License-Identifier: GPL-3.0-or-later

// Computes the triangulation of smallest area by dynamic programming (G. Barequet, M. Sharir,
// Filling gaps in the boundary of a polyhedron, 1995), with a penalty for angles (P. Liepa, Filling
// holes in meshes, 2003). Long loops are simplified, and their points inserted again, by the
// distance from a chord (D. Douglas, T. Peucker, 1973).
#include "prefilter/voxels/solid/span_loop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>

namespace prefilter {
namespace {

constexpr std::size_t kMaxSpannedPoints = 400;  // longer loops are simplified: O(n^3)
// Maximum distance of the dividing point from the middle of a chain, as a share of the chain's
// length; bounds the depth of the division.
constexpr double kMaxOffCenter = 0.3;
// Weight of a chord's squared length against the squared distance from it.
constexpr double kLengthWeight = 0.003;
// Area assigned to the surface around the loop, larger than any triangle.
constexpr double kSurroundingArea = 1e6;

Vector3 direction_of(const Vector3& v) {
  const double size = plain_length(v);
  if (!(size > 0.0)) return {};
  return {v[0] / size, v[1] / size, v[2] / size};
}

// The points of a loop from one index to another.
struct Chain {
  std::size_t from;
  std::size_t to;  // greater than `from`; may exceed the loop's size
  std::size_t middle;
  double deviation;   // squared, of the middle; -1 where there are no points between
  double rank = 0.0;  // higher ranks are divided first

  bool operator<(const Chain& other) const {
    return rank != other.rank ? rank < other.rank : from > other.from;
  }
};

double squared_distance_to_segment(const Vector3& p, const Vector3& a, const Vector3& b) {
  const Vector3 ab = b - a;
  const Vector3 ap = p - a;
  const double squared = dot(ab, ab);
  const double t = squared > 0.0 ? std::clamp(dot(ap, ab) / squared, 0.0, 1.0) : 0.0;
  const Vector3 rest = {ap[0] - t * ab[0], ap[1] - t * ab[1], ap[2] - t * ab[2]};
  return dot(rest, rest);
}

// Divides a chain at the point farthest from the chord, among the points near the middle.
Chain chain_between(std::span<const Vector3> loop, std::size_t from, std::size_t to) {
  Chain chain{from, to, 0, -1.0};
  const auto length = static_cast<double>(to - from);
  const auto margin = static_cast<std::size_t>((0.5 - kMaxOffCenter) * length);
  const Vector3& a = loop[from % loop.size()];
  const Vector3& b = loop[to % loop.size()];
  for (std::size_t i = from + std::max<std::size_t>(margin, 1); i < to && i + margin <= to; ++i) {
    const double deviation = squared_distance_to_segment(loop[i % loop.size()], a, b);
    if (deviation > chain.deviation) {
      chain.deviation = deviation;
      chain.middle = i;
    }
  }
  // All points are on the chord: use the middle one.
  if (chain.deviation >= 0.0 && chain.deviation < 1e-24) chain.middle = from + (to - from) / 2;
  chain.rank = chain.deviation < 0.0 ? -1.0 : chain.deviation + kLengthWeight * dot(b - a, b - a);
  return chain;
}

std::vector<std::array<std::uint32_t, 3>> smallest_span(std::span<const Vector3> points,
                                                        std::span<const Vector3> normals,
                                                        const Run& run) {
  const std::size_t count = points.size();
  struct Best {
    double cost = 0.0;
    Vector3 doubled{};  // area vector, times 2, of the triangle at the chord
    std::uint32_t tip = 0;
  };
  // Best triangulation over the points from i to k and the chord between them.
  std::vector<Best> bests(count * count);
  const auto best = [&](std::size_t i, std::size_t k) -> Best& { return bests[i * count + k]; };
  for (std::size_t i = 0; i + 1 < count; ++i)
    best(i, i + 1).doubled = kSurroundingArea * normals[i];
  for (std::size_t length = 2; length < count; ++length) {
    run.report(static_cast<double>(length) / static_cast<double>(count));
    for (std::size_t i = 0; i + length < count; ++i) {
      const std::size_t k = i + length;
      Best cheapest;
      cheapest.cost = std::numeric_limits<double>::infinity();
      for (std::size_t j = i + 1; j < k; ++j) {
        const Best& low = best(i, j);
        const Best& high = best(j, k);
        if (low.cost + high.cost >= cheapest.cost) continue;
        const Vector3 doubled = cross(points[j] - points[i], points[k] - points[i]);
        double cost = low.cost + high.cost + plain_length(doubled) / 2.0;
        if (cost >= cheapest.cost) continue;
        cost += fold_cost(doubled, low.doubled) + fold_cost(doubled, high.doubled);
        if (length + 1 == count) cost += fold_cost(doubled, kSurroundingArea * normals[count - 1]);
        if (cost < cheapest.cost) cheapest = {cost, doubled, static_cast<std::uint32_t>(j)};
      }
      best(i, k) = cheapest;
    }
  }
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::pair<std::size_t, std::size_t>> chords = {{0, count - 1}};
  while (!chords.empty()) {
    const auto [i, k] = chords.back();
    chords.pop_back();
    if (k - i < 2) continue;
    const std::size_t j = best(i, k).tip;
    triangles.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                         static_cast<std::uint32_t>(k)});
    chords.emplace_back(i, j);
    chords.emplace_back(j, k);
  }
  return triangles;
}

}  // namespace

std::vector<std::uint32_t> simplify_loop(std::span<const Vector3> loop, std::size_t most) {
  std::vector<std::uint32_t> kept;
  if (loop.size() <= most) {
    for (std::uint32_t i = 0; i < loop.size(); ++i) kept.push_back(i);
    return kept;
  }
  std::priority_queue<Chain> chains;
  const std::size_t half = chain_between(loop, 0, loop.size()).middle;
  kept = {0, static_cast<std::uint32_t>(half)};
  chains.push(chain_between(loop, 0, half));
  chains.push(chain_between(loop, half, loop.size()));
  while (kept.size() < most && chains.top().rank >= 0.0) {
    const Chain chain = chains.top();
    chains.pop();
    kept.push_back(static_cast<std::uint32_t>(chain.middle));
    chains.push(chain_between(loop, chain.from, chain.middle));
    chains.push(chain_between(loop, chain.middle, chain.to));
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

void insert_points(std::span<const Vector3> loop, bool bends, HolePatch* patch, const Run& run) {
  const auto count = static_cast<std::uint32_t>(loop.size());
  std::vector<std::uint32_t> changed;
  do {
    run.report(0.0);
    changed.clear();
    const auto triangles = static_cast<std::uint32_t>(patch->triangles().size());
    for (std::uint32_t t = 0; t < triangles; ++t) {
      for (int edge = 0; edge < 3; ++edge) {
        const HolePatch::Triangle& triangle = patch->triangles()[t];
        if (triangle.beyond[static_cast<std::size_t>(edge)] != HolePatch::kBorder) continue;
        const std::uint32_t from = triangle.corners[static_cast<std::size_t>(edge)];
        std::uint32_t to = triangle.corners[static_cast<std::size_t>(next_corner(edge))];
        if (to <= from) to += count;
        if (to - from < 2) continue;
        const Chain chain = chain_between(loop, from, to);
        changed.push_back(t);
        changed.push_back(static_cast<std::uint32_t>(patch->triangles().size()));
        patch->divide_border(t, edge, static_cast<std::uint32_t>(chain.middle % count));
        break;
      }
    }
    patch->flip(changed, bends, run.part(0.0, 0.0));
  } while (!changed.empty());
}

std::vector<Vector3> mean_normals(std::span<const Vector3> normals,
                                  std::span<const std::uint32_t> kept) {
  std::vector<Vector3> means;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const std::size_t end = i + 1 < kept.size() ? kept[i + 1] : normals.size();
    Vector3 sum{};
    for (std::size_t edge = kept[i]; edge < end; ++edge) sum = sum + normals[edge];
    means.push_back(direction_of(sum));
  }
  return means;
}

HolePatch span_loop(std::span<const Vector3> loop, std::span<const Vector3> normals,
                    const Run& run) {
  const std::vector<std::uint32_t> kept = simplify_loop(loop, kMaxSpannedPoints);
  std::vector<Vector3> points;
  for (const std::uint32_t i : kept) points.push_back(loop[i]);
  const Stages stages(run, {5, 4, 1});
  std::vector<std::array<std::uint32_t, 3>> triangles =
      smallest_span(points, mean_normals(normals, kept), stages[0]);
  for (auto& triangle : triangles) {
    for (std::uint32_t& corner : triangle) corner = kept[corner];
  }
  HolePatch patch({loop.begin(), loop.end()}, triangles, {normals.begin(), normals.end()});
  insert_points(loop, false, &patch, stages[1]);
  patch.flip_all(false, stages[2]);
  return patch;
}

}  // namespace prefilter
