// SPDX-License-Identifier: GPL-3.0-or-later

// Builds the arrangement: intersects pieces, merges nearby intersections into vertices, and counts
// winding numbers along a ray from each chain.
#include "prefilter/shapes/outline/arrangement.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "prefilter/base/disjoint_sets.h"
#include "prefilter/base/elementary.h"

namespace prefilter {
namespace {

double extent(const Box2& box) {
  if (box.empty()) return 0.0;
  return std::max(box.high.x - box.low.x, box.high.y - box.low.y);
}

// Spacing of floating-point numbers of the size of a box's coordinates.
double rounding(const Box2& box) {
  if (box.empty()) return 0.0;
  const double largest = std::max(
      {std::fabs(box.low.x), std::fabs(box.low.y), std::fabs(box.high.x), std::fabs(box.high.y)});
  return std::ldexp(largest, -52);
}

}  // namespace

// A point of a contour where it meets another, or itself.
struct Arrangement::Site {
  PieceId id;
  double parameter = 0.0;
  Point2 point;
  bool is_joint = false;
};

// Collects sites, each joint of pieces once, and records which sites coincide.
class Arrangement::SiteList {
 public:
  explicit SiteList(const MonotoneContours& contours) {
    std::uint32_t pieces = 0;
    for (const auto& contour : contours.contours()) {
      first_joint_.push_back(pieces);
      pieces += contour.pieces;
    }
    joint_sites_.assign(pieces, OutlineChain::kNone);
  }

  void add_intersection(const Site& a, const Site& b) {
    const std::uint32_t first = index_of(a);
    const std::uint32_t second = index_of(b);
    same.join(first, second);
  }

  std::vector<Site> sites;
  DisjointSets<std::uint32_t> same;

 private:
  std::uint32_t index_of(const Site& site) {
    const auto next = static_cast<std::uint32_t>(sites.size());
    if (site.is_joint) {
      std::uint32_t& known = joint_sites_[first_joint_[site.id.contour] + site.id.piece];
      if (known != OutlineChain::kNone) return known;
      known = next;
    }
    sites.push_back(site);
    return same.add();
  }

  std::vector<std::uint32_t> first_joint_;  // a contour's
  std::vector<std::uint32_t> joint_sites_;
};

Arrangement::Arrangement(std::span<const Outline* const> outlines, double precision)
    : contours_(outlines),
      precision_(std::max(precision * extent(contours_.box()), 8.0 * rounding(contours_.box()))),
      tree_(contours_, precision_),
      layers_(outlines.size()) {}

CurvePiece Arrangement::curve_piece(const MonotonePiece& piece, std::uint32_t contour) const {
  return {contours_.curve(contours_.contours()[contour], piece), piece.from, piece.to,
          piece.controls};
}

Arrangement::Site Arrangement::site_at(const PieceId& id, const MonotonePiece& piece,
                                       double parameter, const Point2& point) const {
  const auto& contour = contours_.contours()[id.contour];
  if (parameter == piece.from) return {id, parameter, piece.controls.front(), true};
  if (parameter == piece.to) {
    const PieceId next = {id.contour, id.piece + 1 == contour.pieces ? 0 : id.piece + 1};
    return {next, contours_.piece(contour, next.piece).from, piece.controls.back(), true};
  }
  return {id, parameter, point, false};
}

// Whether `b` begins where `a` ends, in the same contour.
bool Arrangement::follows(const PieceId& a, const PieceId& b) const {
  return a.contour == b.contour &&
         (a.piece + 1 == b.piece ||
          (b.piece == 0 && a.piece + 1 == contours_.contours()[a.contour].pieces));
}

std::size_t Arrangement::max_steps(ArrangementEffort effort) const {
  if (effort == ArrangementEffort::kUnbounded) return SIZE_MAX;
  constexpr std::size_t kMinSteps = 1 << 16;
  constexpr std::size_t kStepsPerPiece = 16;
  std::size_t pieces = 0;
  for (const auto& contour : contours_.contours()) pieces += contour.pieces;
  return kMinSteps + kStepsPerPiece * pieces;
}

CutOutcome Arrangement::collect_sites(std::size_t max_steps, const Run& run, SiteList* list) const {
  std::vector<std::pair<PieceId, PieceId>> pairs;
  if (!tree_.append_pairs(max_steps, &pairs)) return CutOutcome::kTooMany;
  std::vector<CurveIntersection> intersections;
  std::size_t steps = 0;
  constexpr std::size_t kPairsPerReport = 1 << 12;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i % kPairsPerReport == 0) {
      run.report(static_cast<double>(i) / static_cast<double>(pairs.size()));
    }
    auto [a, b] = pairs[i];
    if (!follows(a, b) && follows(b, a)) std::swap(a, b);
    const MonotonePiece first_piece = contours_.piece(contours_.contours()[a.contour], a.piece);
    const MonotonePiece second_piece = contours_.piece(contours_.contours()[b.contour], b.piece);
    const CurvePiece first = curve_piece(first_piece, a.contour);
    const CurvePiece second = curve_piece(second_piece, b.contour);
    if (follows(a, b) ? meet_only_at_joint(first, second) : are_apart(first, second, precision_))
      continue;
    // Intersecting curves costs about this many times as much as intersecting lines.
    constexpr std::size_t kStepsOfCurves = 8;
    steps += first.curve.degree() == 1 && second.curve.degree() == 1 ? 1 : kStepsOfCurves;
    if (steps > max_steps) return CutOutcome::kTooMany;
    intersections.clear();
    if (!append_intersections(first, second, precision_, &intersections))
      return CutOutcome::kUnclear;
    for (const CurveIntersection& intersection : intersections) {
      list->add_intersection(site_at(a, first_piece, intersection.a, intersection.point),
                             site_at(b, second_piece, intersection.b, intersection.point));
    }
  }
  return CutOutcome::kCut;
}

// Merges sites near each other into one vertex.
void Arrangement::merge_sites(CancelCheck* cancel_check, SiteList* list) {
  const std::vector<Site>& sites = list->sites;
  DisjointSets<std::uint32_t>& same = list->same;
  struct GridCellHash {
    std::size_t operator()(const std::pair<std::int64_t, std::int64_t>& cell) const {
      return static_cast<std::size_t>(cell.first) * 0x9e3779b97f4a7c15u ^
             static_cast<std::size_t>(cell.second) * 0xc2b2ae3d27d4eb4fu;
    }
  };
  std::unordered_map<std::pair<std::int64_t, std::int64_t>, std::uint32_t, GridCellHash> cells;
  // Differences of distant points can overflow; then any cell will do.
  const auto cell_at = [](double coordinate) {
    constexpr double kMaxCell = 1e18;
    return std::abs(coordinate) < kMaxCell ? static_cast<std::int64_t>(std::floor(coordinate)) : 0;
  };
  const auto cell_of = [&](const Point2& point) {
    const Point2 off = point - contours_.box().low;
    return std::pair{cell_at(off.x / precision_), cell_at(off.y / precision_)};
  };
  for (std::uint32_t i = 0; i < sites.size(); ++i) {
    cancel_check->step();
    const Point2& point = sites[i].point;
    const auto cell = cell_of(point);
    const auto [entry, is_new] = cells.try_emplace(cell, i);
    if (!is_new) {
      same.join(entry->second, i);
      continue;
    }
    for (std::int64_t x = -1; x <= 1; ++x) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        const auto near = cells.find({cell.first + x, cell.second + y});
        if (near == cells.end()) continue;
        const Point2 off = sites[near->second].point - point;
        if (elementary::hypot(off.x, off.y) <= precision_) same.join(near->second, i);
      }
    }
  }

  const std::vector<std::uint32_t> roots = std::move(same).roots();
  // A vertex takes the position of one of its joints, if it has any, so that joints do not move.
  std::vector<std::uint32_t> order(sites.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto key = [&](std::uint32_t i) {
    const Site& site = sites[i];
    return std::tuple(roots[i], !site.is_joint, site.point.x, site.point.y);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    cancel_check->step();
    return key(a) < key(b);
  });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Site& site = sites[order[i]];
    if (i == 0 || roots[order[i]] != roots[order[i - 1]]) {
      vertices_.push_back(site.point);
    }
    cuts_.push_back({site.id, site.parameter, static_cast<std::uint32_t>(vertices_.size()) - 1});
  }
}

CutOutcome Arrangement::cut(ArrangementEffort effort, const Run& run) {
  SiteList list(contours_);
  const CutOutcome outcome = collect_sites(max_steps(effort), run, &list);
  if (outcome != CutOutcome::kCut) return outcome;
  CancelCheck cancel_check(run);
  merge_sites(&cancel_check, &list);
  std::sort(cuts_.begin(), cuts_.end(), [&](const Cut& a, const Cut& b) {
    cancel_check.step();
    return std::tie(a.id, a.parameter, a.vertex) < std::tie(b.id, b.parameter, b.vertex);
  });
  const auto last = std::unique(cuts_.begin(), cuts_.end(), [](const Cut& a, const Cut& b) {
    return a.id == b.id && a.parameter == b.parameter && a.vertex == b.vertex;
  });
  cuts_.erase(last, cuts_.end());
  make_chains(&cancel_check);
  group_chains(&cancel_check);
  return CutOutcome::kCut;
}

void Arrangement::make_chains(CancelCheck* cancel_check) {
  std::uint32_t cut = 0;
  const auto cut_count = static_cast<std::uint32_t>(cuts_.size());
  for (std::uint32_t c = 0; c < contours_.contours().size(); ++c) {
    const std::uint32_t first = cut;
    while (cut < cut_count && cuts_[cut].id.contour == c) ++cut;
    if (cut == first) {
      chains_.push_back({c, OutlineChain::kNone, OutlineChain::kNone});
      continue;
    }
    for (std::uint32_t i = first; i < cut; ++i) {
      cancel_check->step();
      const OutlineChain chain = {c, i, i + 1 < cut ? i + 1 : first};
      if (!is_negligible(chain)) chains_.push_back(chain);
    }
  }
}

// Whether a chain from a vertex back to itself stays within the size of one point.
bool Arrangement::is_negligible(const OutlineChain& chain) const {
  if (cuts_[chain.begin_cut].vertex != cuts_[chain.end_cut].vertex) return false;
  const Point2& vertex = vertices_[cuts_[chain.begin_cut].vertex];
  bool is_small = true;
  visit_parts(chain, [&](const Part& part) {
    const CurvePiece piece = curve_piece(part.piece, chain.contour);
    for (const double t : {part.from, part.to}) {
      const Point2 off = point_at(piece.curve, t) - vertex;
      is_small = is_small && elementary::hypot(off.x, off.y) <= 8.0 * precision_;
    }
    return is_small;
  });
  return is_small;
}

std::optional<Arrangement::Part> Arrangement::only_part(const OutlineChain& chain) const {
  std::optional<Part> only;
  bool is_only = true;
  visit_parts(chain, [&](const Part& part) {
    is_only = !only;
    only = part;
    return is_only;
  });
  if (!is_only) only.reset();
  return only;
}

void Arrangement::group_chains(CancelCheck* cancel_check) {
  struct Entry {
    std::uint32_t low;
    std::uint32_t high;
    std::uint32_t chain;
  };
  group_of_.assign(chains_.size(), OutlineChain::kNone);
  std::vector<Entry> entries;
  for (std::uint32_t i = 0; i < chains_.size(); ++i) {
    if (chains_[i].begin_cut == OutlineChain::kNone) continue;
    const std::uint32_t a = cuts_[chains_[i].begin_cut].vertex;
    const std::uint32_t b = cuts_[chains_[i].end_cut].vertex;
    if (a != b) entries.push_back({std::min(a, b), std::max(a, b), i});
  }
  std::sort(entries.begin(), entries.end(), [&](const Entry& a, const Entry& b) {
    cancel_check->step();
    return std::tie(a.low, a.high, a.chain) < std::tie(b.low, b.high, b.chain);
  });
  for (std::size_t i = 0; i < entries.size(); ++i) {
    cancel_check->step();
    for (std::size_t j = i + 1; j < entries.size() && entries[j].low == entries[i].low &&
                                entries[j].high == entries[i].high;
         ++j) {
      if (group_of_[entries[j].chain] != OutlineChain::kNone) continue;
      const auto first = only_part(chains_[entries[i].chain]);
      const auto second = only_part(chains_[entries[j].chain]);
      if (!first || !second) continue;
      const CurvePiece a = curve_piece(first->piece, chains_[entries[i].chain].contour);
      const CurvePiece b = curve_piece(second->piece, chains_[entries[j].chain].contour);
      if (!runs_along(a, first->from, first->to, b, 8.0 * precision_)) continue;
      std::uint32_t& group = group_of_[entries[i].chain];
      if (group == OutlineChain::kNone) {
        group = static_cast<std::uint32_t>(groups_.size());
        groups_.push_back({entries[i].chain});
      }
      group_of_[entries[j].chain] = group;
      groups_[group].push_back(entries[j].chain);
    }
  }
}

// The part of a chain that extends farthest along one axis, among its first kMaxPartsCompared
// parts. Its middle separates both sides of the chain most clearly.
struct Arrangement::Reach {
  Part part;
  Point2 step;  // from its begin to its end
};

std::optional<Arrangement::Reach> Arrangement::farthest_part(const OutlineChain& chain) const {
  constexpr int kMaxPartsCompared = 32;
  std::optional<Reach> best;
  double best_reach = -1.0;
  int compared = 0;
  visit_parts(chain, [&](const Part& part) {
    const Curve curve = contours_.curve(contours_.contours()[chain.contour], part.piece);
    const MonotonePiece& piece = part.piece;
    const Point2 begin =
        part.from == piece.from ? piece.controls.front() : point_at(curve, part.from);
    const Point2 end = part.to == piece.to ? piece.controls.back() : point_at(curve, part.to);
    const Point2 step = end - begin;
    const double reach = std::max(std::fabs(step.x), std::fabs(step.y));
    if (reach > best_reach) {
      best = {part, step};
      best_reach = reach;
    }
    return ++compared < kMaxPartsCompared;
  });
  return best;
}

void Arrangement::visit(std::size_t first, std::size_t last, const Visitor& visitor) const {
  LayerWindings near_side(layers_);
  LayerWindings far_side(layers_);
  std::vector<PieceId> excluded;
  for (std::size_t i = first; i < last; ++i) {
    const OutlineChain& chain = chains_[i];
    const std::uint32_t group = group_of_[i];
    if (group != OutlineChain::kNone && groups_[group].front() != i) continue;
    std::span<const std::uint32_t> others;  // overlap this chain
    if (group != OutlineChain::kNone) others = std::span(groups_[group]).subspan(1);

    const std::optional<Reach> best = farthest_part(chain);
    if (!best) continue;
    const auto& [part, step] = *best;
    const Curve curve = contours_.curve(contours_.contours()[chain.contour], part.piece);
    const Point2 point = point_at(curve, 0.5 * (part.from + part.to));
    const RayAxis axis = std::fabs(step.y) >= std::fabs(step.x) ? RayAxis::kX : RayAxis::kY;
    // The ray starts on the side of +x, or of +y.
    const bool near_is_right = axis == RayAxis::kX ? step.y > 0.0 : step.x < 0.0;
    const int sign = near_is_right ? 1 : -1;

    excluded.assign(1, {chain.contour, part.piece_index});
    for (const std::uint32_t other : others) {
      excluded.push_back({chains_[other].contour, only_part(chains_[other])->piece_index});
    }
    near_side.clear();
    far_side.clear();
    tree_.add_windings(point, axis, excluded, &near_side);
    for (const std::uint32_t layer : near_side.touched()) {
      far_side.add(layer, near_side[layer] - far_side[layer]);
    }
    far_side.add(contours_.contours()[chain.contour].layer, sign);
    for (const std::uint32_t other : others) {
      const OutlineChain& member = chains_[other];
      const bool along = cuts_[member.begin_cut].vertex == cuts_[chain.begin_cut].vertex;
      far_side.add(contours_.contours()[member.contour].layer, along ? sign : -sign);
    }
    visitor(static_cast<std::uint32_t>(i), near_is_right ? near_side : far_side,
            near_is_right ? far_side : near_side);
  }
}

}  // namespace prefilter
