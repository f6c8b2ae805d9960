// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/outline/resolve.h"

#include <algorithm>
#include <array>

#include "prefilter/base/curve.h"
#include "prefilter/outline/arrangement.h"
#include "prefilter/outline/convex_contours.h"
#include "prefilter/outline/fill_rule.h"
#include "prefilter/outline/polygon_clipper.h"

namespace prefilter {
namespace {

enum class Outcome : std::uint8_t { kAsItIs, kTraced, kUnclear };

Outcome resolve_exactly(const Outline& outline, FillRule rule, double precision,
                        const Progress& progress, Outline* result) {
  const std::array<const Outline*, 1> outlines = {&outline};
  Arrangement arrangement(outlines, precision);
  if (!arrangement.cut(progress.part(0.0, 0.5))) return Outcome::kUnclear;
  std::vector<BoundaryChain> boundary;
  boundary.reserve(arrangement.chain_count());
  bool all_forward = true;
  const auto visitor = [&](std::uint32_t chain, const LayerWindings& right,
                           const LayerWindings& left) {
    const bool is_left = is_filled(left[0], rule);
    const bool is_right = is_filled(right[0], rule);
    all_forward = all_forward && is_left && !is_right;
    if (is_left != is_right) boundary.push_back({chain, is_right});
  };
  constexpr std::size_t kAtOnce = 256;
  const std::size_t count = arrangement.chain_count();
  for (std::size_t begin = 0; begin < count; begin += kAtOnce) {
    progress.report(0.5 + 0.5 * static_cast<double>(begin) / static_cast<double>(count));
    arrangement.visit(begin, std::min(begin + kAtOnce, count), visitor);
  }
  if (arrangement.all_whole() && all_forward) return Outcome::kAsItIs;
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

std::optional<Outline> resolved(const Outline& outline, FillRule rule, double tolerance,
                                const Progress& progress) {
  if (const auto uses = convex_contour_uses(outline, rule)) {
    if (std::all_of(uses->begin(), uses->end(),
                    [](ContourUse use) { return use == ContourUse::kKept; })) {
      return std::nullopt;
    }
    return contours_of(outline, *uses);
  }
  for (const double precision : kPrecisions) {
    Outline result;
    switch (resolve_exactly(outline, rule, precision, progress, &result)) {
      case Outcome::kAsItIs:
        return std::nullopt;
      case Outcome::kTraced:
        return result;
      case Outcome::kUnclear:
        break;
    }
  }
  return combine_polygons(flattened(outline, tolerance), rule, {}, rule, OutlineOperation::kUnion);
}

Outline resolve(const Outline& outline, FillRule rule, double tolerance) {
  std::optional<Outline> result = resolved(outline, rule, tolerance);
  return result ? std::move(*result) : outline;
}

}  // namespace prefilter
