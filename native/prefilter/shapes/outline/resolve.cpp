// SPDX-License-Identifier: GPL-3.0-or-later

// Convex contours take a fast path. Others are cut into chains, and a chain is on the boundary
// where only one of its sides is filled. Ambiguous intersections fall back to polygons clipped on
// an integer grid.
#include "prefilter/shapes/resolve.h"

#include <algorithm>
#include <array>

#include "prefilter/base/curve.h"
#include "prefilter/shapes/outline/arrangement.h"
#include "prefilter/shapes/outline/convex_contours.h"
#include "prefilter/shapes/outline/fill_rule.h"
#include "prefilter/shapes/outline/polygon_clipper.h"
#include "prefilter/shapes/outline/resolve_within_budget.h"

namespace prefilter {
namespace {

enum class Outcome : std::uint8_t { kUnchanged, kTraced, kUnclear, kTooMany };

Outcome resolve_exactly(const Outline& outline, FillRule rule, double precision,
                        ArrangementEffort effort, const Run& run, Outline* result) {
  const std::array<const Outline*, 1> outlines = {&outline};
  Arrangement arrangement(outlines, precision);
  const CutOutcome cut = arrangement.cut(effort, run.part(0.0, 0.5));
  if (cut != CutOutcome::kCut) {
    return cut == CutOutcome::kUnclear ? Outcome::kUnclear : Outcome::kTooMany;
  }
  std::vector<BoundaryChain> boundary;
  boundary.reserve(arrangement.chain_count());
  bool all_forward = true;
  std::size_t steps = 0;
  const auto visitor = [&](std::uint32_t chain, const LayerWindings& right,
                           const LayerWindings& left) {
    steps += right.touched().size() + left.touched().size();
    const bool is_left = is_filled(left[0], rule);
    const bool is_right = is_filled(right[0], rule);
    all_forward = all_forward && is_left && !is_right;
    if (is_left != is_right) boundary.push_back({chain, is_right});
  };
  constexpr std::size_t kChainsPerReport = 256;
  // One step of the effort is intersecting two lines; comparing winding numbers is this much
  // cheaper.
  constexpr std::size_t kWindingsPerStep = 128;
  const std::size_t count = arrangement.chain_count();
  for (std::size_t begin = 0; begin < count; begin += kChainsPerReport) {
    run.report(0.5 + 0.5 * static_cast<double>(begin) / static_cast<double>(count));
    arrangement.visit(begin, std::min(begin + kChainsPerReport, count), visitor);
    if (steps / kWindingsPerStep > arrangement.max_steps(effort)) return Outcome::kTooMany;
  }
  if (arrangement.has_no_cuts() && all_forward) return Outcome::kUnchanged;
  return arrangement.trace(boundary, result) ? Outcome::kTraced : Outcome::kUnclear;
}

Outline contours_of(const Outline& outline, std::span<const ContourUse> uses) {
  Outline result;
  result.reserve(outline.points().size(), outline.segments().size());
  for (std::size_t c = 0; c < uses.size(); ++c) {
    if (uses[c] == ContourUse::kDropped || outline.contour(c).empty()) continue;
    append_contour(outline, c, uses[c] == ContourUse::kReversed, &result);
  }
  return result;
}

}  // namespace

namespace {

// Resolves convex contours that are disjoint or nested.
bool resolve_convex(const Outline& outline, FillRule rule, std::optional<Outline>* changed) {
  const auto uses = convex_contour_uses(outline, rule);
  if (!uses) return false;
  const bool are_all_kept = std::all_of(uses->begin(), uses->end(),
                                        [](ContourUse use) { return use == ContourUse::kKept; });
  if (!are_all_kept) *changed = contours_of(outline, *uses);
  return true;
}

bool resolve_by_arrangement(const Outline& outline, FillRule rule, ArrangementEffort effort,
                            const Run& run, std::optional<Outline>* changed) {
  for (const double precision : kArrangementPrecisions) {
    Outline result;
    switch (resolve_exactly(outline, rule, precision, effort, run, &result)) {
      case Outcome::kUnchanged:
        return true;
      case Outcome::kTraced:
        *changed = std::move(result);
        return true;
      case Outcome::kTooMany:
        return false;
      case Outcome::kUnclear:
        break;
    }
  }
  return false;
}

}  // namespace

bool resolve_within_budget(const Outline& outline, FillRule rule, const Run& run,
                           std::optional<Outline>* changed) {
  changed->reset();
  return resolve_convex(outline, rule, changed) ||
         resolve_by_arrangement(outline, rule, ArrangementEffort::kBounded, run, changed);
}

std::optional<Outline> resolved(const Outline& outline, FillRule rule, double tolerance,
                                const Run& run) {
  std::optional<Outline> changed;
  if (resolve_convex(outline, rule, &changed) ||
      resolve_by_arrangement(outline, rule, ArrangementEffort::kUnbounded, run, &changed)) {
    return changed;
  }
  return combine_polygons(flattened(outline, tolerance), rule, {}, rule, OutlineOperation::kUnion);
}

Outline resolve(const Outline& outline, FillRule rule, double tolerance) {
  std::optional<Outline> result = resolved(outline, rule, tolerance);
  return result ? std::move(*result) : outline;
}

}  // namespace prefilter
