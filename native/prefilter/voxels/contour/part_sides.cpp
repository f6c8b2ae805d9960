// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/contour/part_sides.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr double kPartReach = 2.5;  // cells; distance at which parts count
constexpr double kCertain = 1e-4;   // maximum distance of a certain occupancy from 0 or 1
constexpr int kLeastVotes = 3;
constexpr int kMajority = 10;  // required ratio to the opposing votes
// Samples per axis of a brick; not a divisor of its cells, so that samples avoid grid planes.
constexpr int kCellSamples = 3;
constexpr int kShares = 4;  // samples per axis of a leaf
constexpr int kClose = 5;   // samples; if the count differs less from half, the center decides
constexpr std::int64_t kLeavesPerTask = 64;
// Parameters of wedges between two parts. They end where they are thinner than a share of a cell's
// extent across them, if their tip is within reach of features.
constexpr double kAcute = -0.6;  // 53 degrees
constexpr double kThinnest = 0.5;
constexpr double kPartSidesTipCells = 4.0;
constexpr double kThickestCells = 2.0;
constexpr double kBodyCells = 1.0;  // minimum length of the wedge behind its end

float value_at(const ContourTree& tree, const RootFrame& frame, const Vector3& point) {
  CellNode cell = tree.root();
  Vector3 low{};
  for (int a = 0; a < 3; ++a) {
    if (point[a] < 0.0 || point[a] >= frame.cell(a, 0)) return 0.0F;
  }
  while (cell.is_split) {
    int octant = 0;
    for (int a = 0; a < 3; ++a) {
      const double middle = low[a] + frame.cell(a, cell.depth + 1);
      if (point[a] < middle) continue;
      octant |= 1 << a;
      low[a] = middle;
    }
    cell = tree.octant(cell, octant);
  }
  return tree.value(cell);
}
}  // namespace

PartSides::PartSides(const ContourTree& tree, const RootFrame& frame, const SourceSurface& surface,
                     const Run& run)
    : surface_(surface), frame_(frame) {
  CancelCheck cancel_check(run);
  surface.for_meeting_bricks([&](const Vector3& low, double side) {
    for (int i = 0; i < kCellSamples * kCellSamples * kCellSamples; ++i) {
      cancel_check.step();
      const Vector3 point = {
          low[0] + (i % kCellSamples + 0.4) / kCellSamples * side,
          low[1] + (i / kCellSamples % kCellSamples + 0.4) / kCellSamples * side,
          low[2] + (i / (kCellSamples * kCellSamples) + 0.4) / kCellSamples * side};
      const float value = value_at(tree, frame, point);
      const bool is_full = value >= 1.0F - static_cast<float>(kCertain);
      if (!is_full && value > static_cast<float>(kCertain)) continue;
      const std::optional<Parts> parts = parts_near(point);
      if (!parts) continue;
      Votes& votes = votes_[parts->numbers];
      ++(is_full ? votes.inside : votes.outside)[parts->inside_at(point)];
    }
  });
}

std::optional<PartSides::Parts> PartSides::parts_near(const Vector3& point) const {
  Parts parts;
  const std::span<const std::int32_t> meeting = surface_.meeting_parts(point);
  for (std::size_t i = 0; i < meeting.size(); ++i) {
    const std::int32_t part = meeting[i];
    if (parts.count == kMostParts || parts.count + (meeting.size() - i) < 2) return std::nullopt;
    const std::optional<SourcePoint> plane =
        surface_.nearest_plane(point, kPartReach * surface_.cell(), part);
    if (!plane) continue;
    parts.planes[parts.count] = *plane;
    parts.numbers[parts.count++] = part;
  }
  if (parts.count < 2) return std::nullopt;
  return parts;
}

unsigned PartSides::Parts::inside_at(const Vector3& point) const {
  unsigned inside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (dot(planes[i].normal, point - planes[i].position) < 0.0) inside |= 1U << i;
  }
  return inside;
}

std::optional<bool> PartSides::is_inside(const Parts& parts, unsigned inside) const {
  const auto found = votes_.find(parts.numbers);
  if (found == votes_.end()) return std::nullopt;
  const int votes_inside = found->second.inside[inside];
  const int votes_outside = found->second.outside[inside];
  if (votes_inside >= kLeastVotes && votes_inside >= kMajority * votes_outside) return true;
  if (votes_outside >= kLeastVotes && votes_outside >= kMajority * votes_inside) return false;
  return std::nullopt;
}

std::optional<std::array<Vector3, 2>> PartSides::wedge_normals(const Parts& parts) const {
  if (parts.count != 2) return std::nullopt;
  std::optional<unsigned> within;
  for (unsigned inside = 0; inside < 4; ++inside) {
    const std::optional<bool> side = is_inside(parts, inside);
    if (!side || (*side && within)) return std::nullopt;
    if (*side) within = inside;
  }
  if (!within) return std::nullopt;
  std::array<Vector3, 2> outward;
  for (std::size_t i = 0; i < 2; ++i) {
    const Vector3& normal = parts.planes[i].normal;
    outward[i] = ((*within >> i) & 1U) != 0U ? normal : -1.0 * normal;
  }
  return outward;
}

bool PartSides::is_between(const Parts& parts, const Vector3& point) const {
  const std::optional<Parts> there = parts_near(point);
  return there && there->numbers == parts.numbers &&
         is_inside(*there, there->inside_at(point)).value_or(false);
}

std::optional<bool> PartSides::side_in_wedge(const Parts& parts, const Vector3& center,
                                             const Vector3& size) const {
  const std::optional<std::array<Vector3, 2>> outward = wedge_normals(parts);
  if (!outward) return std::nullopt;
  const auto& [first, second] = *outward;
  const double cosine = dot(first, second);
  if (cosine >= kAcute) return std::nullopt;
  const double below_first = dot(first, parts.planes[0].position - center);
  const double below_second = dot(second, parts.planes[1].position - center);
  const double thickness = below_first + below_second;
  if (thickness > kThickestCells * surface_.cell()) return std::nullopt;
  const Vector3 across = first - second;
  double reach = 0.0;
  for (int a = 0; a < 3; ++a) reach += std::abs(across[a]) * size[a];
  reach /= length(across);
  if (thickness >= kThinnest * reach) {
    const double from_middle = std::abs(below_first - below_second) / length(across);
    return from_middle <= 0.5 * reach ? std::optional<bool>(true) : std::nullopt;
  }
  // Half-angle formula: tan(a / 2)^2 = (1 - cos(a)) / (1 + cos(a)).
  const double cosine_of_tip = std::min(1.0, -cosine);
  const double slope = 2.0 * std::sqrt((1.0 - cosine_of_tip) / (1.0 + cosine_of_tip));
  if (thickness > slope * kPartSidesTipCells * surface_.cell()) return std::nullopt;
  // The wedge must continue behind that point, or nothing of it would remain.
  const Vector3 middle = center + ((below_first - below_second) / dot(across, across)) * across;
  const Vector3 outer = first + second;
  const double width = length(outer);
  if (!(width > 0.0)) return std::nullopt;
  const double way = (kThinnest * reach - thickness) / width + kBodyCells * surface_.cell();
  if (!is_between(parts, middle - (way / width) * outer)) return std::nullopt;
  return false;
}

std::optional<bool> PartSides::is_mostly_inside(const Vector3& center, const Vector3& size) const {
  const std::optional<Parts> parts = parts_near(center);
  if (!parts) return std::nullopt;
  const std::optional<bool> in_wedge = side_in_wedge(*parts, center, size);
  if (in_wedge) return in_wedge;
  // If only one part passes through, the occupancy decides.
  int passing = 0;
  for (std::size_t i = 0; i < parts->count; ++i) {
    const SourcePoint& plane = parts->planes[i];
    double reach = 0.0;
    for (int a = 0; a < 3; ++a) reach += std::abs(plane.normal[a]) * size[a] / 2.0;
    if (std::abs(dot(plane.normal, center - plane.position)) < reach) ++passing;
  }
  if (passing < 2) return std::nullopt;
  int inside = 0;
  int outside = 0;
  for (int i = 0; i < kShares * kShares * kShares; ++i) {
    const Vector3 point = {center[0] + ((i % kShares + 0.5) / kShares - 0.5) * size[0],
                           center[1] + ((i / kShares % kShares + 0.5) / kShares - 0.5) * size[1],
                           center[2] + ((i / (kShares * kShares) + 0.5) / kShares - 0.5) * size[2]};
    const std::optional<bool> side = is_inside(*parts, parts->inside_at(point));
    if (side) ++(*side ? inside : outside);
  }
  const int half = kShares * kShares * kShares / 2;
  if (inside >= half + kClose) return true;
  if (outside >= half + kClose) return false;
  return inside + outside < 2 * half ? std::nullopt : is_inside(*parts, parts->inside_at(center));
}

std::optional<SourcePoint> PartSides::exit(const Vector3& in, const Vector3& out,
                                           const Vector3& expected, bool* is_known) const {
  *is_known = false;
  const std::optional<Parts> parts = parts_near(in);
  if (!parts) return std::nullopt;
  unsigned inside = parts->inside_at(in);
  std::optional<bool> side = is_inside(*parts, inside);
  if (!side) return std::nullopt;
  std::optional<SourcePoint> best;
  double least = 0.0;
  for (const SourceCrossing& hit : surface_.crossings(in, out)) {
    const auto at = std::find(parts->numbers.begin(), parts->numbers.begin() + parts->count,
                              surface_.regions().parts[static_cast<std::size_t>(hit.triangle)]);
    if (at == parts->numbers.begin() + parts->count) return std::nullopt;
    inside ^= 1U << (at - parts->numbers.begin());
    const std::optional<bool> next = is_inside(*parts, inside);
    if (!next) return std::nullopt;
    if (*side && !*next) {
      const SourcePoint point = surface_.point_on(hit.triangle, in + hit.share * (out - in));
      const double distance = length(point.position - expected);
      if (!best || distance < least) {
        best = point;
        least = distance;
      }
    }
    side = next;
  }
  *is_known = true;
  return best;
}

void PartSides::settle(const ThickenedCells& thickened, const Run& run, ContourTree* tree) const {
  struct Leaf {
    std::size_t level;
    std::size_t block;
    int octant;
    Vector3 center;
    Vector3 size;
  };
  std::vector<Leaf> leaves;
  CancelCheck cancel_check(run);
  const auto find = [&](const auto& self, const CellNode& cell, const CellCoordinates& at) -> void {
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree->octant(cell, o);
      const CellCoordinates octant_cell = octant_at(at, o);
      if (octant.is_split) {
        self(self, octant, octant_cell);
        continue;
      }
      cancel_check.step();
      const float value = tree->value(octant);
      if (!(value > 0.0F && value < 1.0F)) continue;
      Vector3 center;
      Vector3 size;
      for (int a = 0; a < 3; ++a) {
        size[a] = frame_.cell(a, octant.depth);
        center[a] = frame_.position(a, octant_cell[a] + 0.5, octant.depth);
      }
      if (surface_.meeting_parts(center).empty() || thickened.holds(center)) continue;
      leaves.push_back({static_cast<std::size_t>(octant.depth - 1), octant.block, o, center, size});
    }
  };
  find(find, tree->root(), {0, 0, 0});
  std::vector<std::uint8_t> sides(leaves.size(), 0);
  const auto settle_some = [&](std::int64_t begin, std::int64_t end) {
    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
      const std::optional<bool> inside = is_mostly_inside(leaves[i].center, leaves[i].size);
      if (inside) sides[i] = *inside ? kInside : kOutside;
    }
  };
  parallel_ranges(static_cast<std::int64_t>(leaves.size()), kLeavesPerTask, run.part(0.2, 0.9),
                  settle_some);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (sides[i] == 0) continue;
    tree->set_side(leaves[i].level, leaves[i].block, leaves[i].octant, sides[i]);
  }
  tree->update_sides(run.part(0.9, 1.0));
}

}  // namespace prefilter
