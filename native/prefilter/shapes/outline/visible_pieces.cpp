// SPDX-License-Identifier: GPL-3.0-or-later

// All contours of all layers are cut at their intersections. The winding numbers to the left and to
// the right of each chain determine which layers are visible, and through which overlays. Where
// that differs for a layer, the chain is on the boundary of one of its pieces.
#include "prefilter/shapes/outline/visible_pieces.h"

#include <algorithm>
#include <atomic>
#include <compare>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/shapes/outline/fill_rule.h"

namespace prefilter {
namespace {

constexpr std::int64_t kChainsPerRange = 256;

// A visible layer and the translucent layers above it, from the top.
struct Visibility {
  std::uint32_t layer;
  std::vector<std::uint32_t> overlays;

  friend auto operator<=>(const Visibility&, const Visibility&) = default;
};

// A chain on the boundary of the region with this visibility.
struct VisibilityEdge {
  Visibility visibility;
  BoundaryChain chain;
};

// Lists the visible layers at a point, from the top.
void find_visibilities(std::span<const CoveringLayer> layers, const LayerWindings& windings,
                       std::vector<std::uint32_t>* touched, std::vector<Visibility>* visibilities) {
  visibilities->clear();
  touched->assign(windings.touched().begin(), windings.touched().end());
  std::sort(touched->begin(), touched->end(), std::greater<>());
  touched->erase(std::unique(touched->begin(), touched->end()), touched->end());
  std::vector<std::uint32_t> overlays;
  for (const std::uint32_t layer : *touched) {
    if (!is_filled(windings[layer], layers[layer].fill_rule)) continue;
    visibilities->push_back({layer, overlays});
    if (layers[layer].is_opaque) return;
    overlays.push_back(layer);
  }
}

// Work of comparing the visibilities on both sides of a chain.
std::size_t steps_of(const std::vector<Visibility>& visibilities) {
  std::size_t steps = 1;
  for (const Visibility& visibility : visibilities) steps += 1 + visibility.overlays.size();
  return steps;
}

// Finds the boundary chains of all regions, grouped by region. Nothing if the total work of all
// threads exceeds `max_steps` steps; whether it does is independent of their order.
std::optional<std::vector<VisibilityEdge>> find_edges(const Arrangement& arrangement,
                                                      std::span<const CoveringLayer> layers,
                                                      std::size_t max_steps, const Run& run) {
  std::atomic<std::size_t> steps = 0;
  const auto count = static_cast<std::int64_t>(arrangement.chain_count());
  std::vector<std::vector<VisibilityEdge>> parts(range_count(count, kChainsPerRange));
  parallel_ranges(count, kChainsPerRange, run, [&](std::int64_t begin, std::int64_t end) {
    std::vector<VisibilityEdge>& edges = parts[begin / kChainsPerRange];
    std::vector<std::uint32_t> touched;
    std::vector<Visibility> on_right;
    std::vector<Visibility> on_left;
    const auto append = [&](const std::vector<Visibility>& here,
                            const std::vector<Visibility>& there, std::uint32_t chain,
                            bool reversed) {
      for (const Visibility& visibility : here) {
        if (std::find(there.begin(), there.end(), visibility) == there.end()) {
          edges.push_back({visibility, {chain, reversed}});
        }
      }
    };
    if (steps > max_steps) return;
    arrangement.visit(
        begin, end,
        [&](std::uint32_t chain, const LayerWindings& right, const LayerWindings& left) {
          if (steps > max_steps) return;
          find_visibilities(layers, right, &touched, &on_right);
          find_visibilities(layers, left, &touched, &on_left);
          steps += touched.size() + steps_of(on_right) + steps_of(on_left);
          append(on_left, on_right, chain, false);
          append(on_right, on_left, chain, true);
        });
  });
  if (steps > max_steps) return std::nullopt;
  std::vector<VisibilityEdge> all;
  for (const auto& edges : parts) all.insert(all.end(), edges.begin(), edges.end());
  std::stable_sort(all.begin(), all.end(), [](const VisibilityEdge& a, const VisibilityEdge& b) {
    return a.visibility < b.visibility;
  });
  return all;
}

}  // namespace

std::optional<std::vector<VisiblePiece>> visible_pieces(std::span<const CoveringLayer> layers,
                                                        ArrangementEffort effort, const Run& run) {
  std::vector<const Outline*> outlines;
  for (const CoveringLayer& layer : layers) outlines.push_back(layer.outline);
  Arrangement arrangement(outlines, kArrangementPrecisions[0]);
  const Stages stages(run, {2, 2, 1});
  if (arrangement.cut(effort, stages[0]) != CutOutcome::kCut) return std::nullopt;
  constexpr std::size_t kComparisonsPerStep = 8;
  const std::size_t max_steps = arrangement.max_steps(effort);
  const auto edges = find_edges(
      arrangement, layers,
      max_steps > SIZE_MAX / kComparisonsPerStep ? max_steps : kComparisonsPerStep * max_steps,
      stages[1]);
  if (!edges) return std::nullopt;
  std::vector<std::size_t> starts;  // first edge of each piece, and the number of edges
  for (std::size_t i = 0; i < edges->size(); ++i) {
    if (i == 0 || !((*edges)[i].visibility == (*edges)[i - 1].visibility)) starts.push_back(i);
  }
  std::vector<VisiblePiece> pieces(starts.size());
  starts.push_back(edges->size());
  std::atomic<bool> all_traced = true;
  parallel_for(static_cast<std::int64_t>(pieces.size()), stages[2], [&](std::int64_t index) {
    const auto i = static_cast<std::size_t>(index);
    const auto own = std::span(*edges).subspan(starts[i], starts[i + 1] - starts[i]);
    const Visibility& visibility = own.front().visibility;
    pieces[i] = {visibility.layer, {visibility.overlays.rbegin(), visibility.overlays.rend()}, {}};
    std::vector<BoundaryChain> boundary;
    for (const VisibilityEdge& edge : own) boundary.push_back(edge.chain);
    if (!arrangement.trace(boundary, &pieces[i].outline)) all_traced = false;
  });
  run.report(1.0);
  if (!all_traced) return std::nullopt;
  return pieces;
}

}  // namespace prefilter
