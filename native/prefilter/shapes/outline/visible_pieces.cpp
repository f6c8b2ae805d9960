// SPDX-License-Identifier: GPL-3.0-or-later

// All contours of all layers are cut where they meet. To the left and to the right of each part the
// winding numbers tell which layers are seen, and how much of each: where that differs for a layer,
// the part is on the boundary of one of its pieces.
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

// A layer that is seen at a place, and what it is seen through, from the top.
struct View {
  std::uint32_t layer;
  std::vector<std::uint32_t> veils;

  friend auto operator<=>(const View&, const View&) = default;
};

// A part of the boundary of where it is seen like that.
struct ViewEdge {
  View view;
  BoundaryChain chain;
};

// What is seen at a place, from the top.
void find_views(std::span<const CoveringLayer> layers, const LayerWindings& windings,
                std::vector<std::uint32_t>* touched, std::vector<View>* views) {
  views->clear();
  touched->assign(windings.touched().begin(), windings.touched().end());
  std::sort(touched->begin(), touched->end(), std::greater<>());
  touched->erase(std::unique(touched->begin(), touched->end()), touched->end());
  std::vector<std::uint32_t> veils;
  for (const std::uint32_t layer : *touched) {
    if (!is_filled(windings[layer], layers[layer].fill_rule)) continue;
    views->push_back({layer, veils});
    if (layers[layer].is_opaque) return;
    veils.push_back(layer);
  }
}

// What comparing the views on both sides of a chain takes.
std::size_t steps_of(const std::vector<View>& views) {
  std::size_t steps = 1;
  for (const View& view : views) steps += 1 + view.veils.size();
  return steps;
}

// Boundaries of all views: edges of the same one in a row. Nothing where that takes more steps than
// `most`, in the sum of all chains, in whatever order threads come to them.
std::optional<std::vector<ViewEdge>> find_edges(const Arrangement& arrangement,
                                                std::span<const CoveringLayer> layers,
                                                std::size_t most, int threads,
                                                const Progress& progress) {
  std::atomic<std::size_t> steps = 0;
  const auto count = static_cast<std::int64_t>(arrangement.chain_count());
  std::vector<std::vector<ViewEdge>> parts(range_count(count, kChainsPerRange));
  parallel_ranges(
      count, kChainsPerRange, threads, progress, [&](std::int64_t begin, std::int64_t end) {
        std::vector<ViewEdge>& edges = parts[begin / kChainsPerRange];
        std::vector<std::uint32_t> touched;
        std::vector<View> on_right;
        std::vector<View> on_left;
        const auto append = [&](const std::vector<View>& here, const std::vector<View>& there,
                                std::uint32_t chain, bool reversed) {
          for (const View& view : here) {
            if (std::find(there.begin(), there.end(), view) == there.end()) {
              edges.push_back({view, {chain, reversed}});
            }
          }
        };
        if (steps > most) return;
        arrangement.visit(
            begin, end,
            [&](std::uint32_t chain, const LayerWindings& right, const LayerWindings& left) {
              if (steps > most) return;
              find_views(layers, right, &touched, &on_right);
              find_views(layers, left, &touched, &on_left);
              steps += touched.size() + steps_of(on_right) + steps_of(on_left);
              append(on_left, on_right, chain, false);
              append(on_right, on_left, chain, true);
            });
      });
  if (steps > most) return std::nullopt;
  std::vector<ViewEdge> all;
  for (const auto& edges : parts) all.insert(all.end(), edges.begin(), edges.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const ViewEdge& a, const ViewEdge& b) { return a.view < b.view; });
  return all;
}

}  // namespace

std::optional<std::vector<VisiblePiece>> visible_pieces(std::span<const CoveringLayer> layers,
                                                        ArrangementEffort effort, int threads,
                                                        const Progress& progress) {
  std::vector<const Outline*> outlines;
  for (const CoveringLayer& layer : layers) outlines.push_back(layer.outline);
  Arrangement arrangement(outlines, kPrecisions[0]);
  if (arrangement.cut(effort, progress.part(0.0, 0.4)) != CutOutcome::kCut) return std::nullopt;
  constexpr std::size_t kStepsPerStep = 8;
  const std::size_t most = arrangement.most_steps(effort);
  const auto edges =
      find_edges(arrangement, layers, most > SIZE_MAX / kStepsPerStep ? most : kStepsPerStep * most,
                 threads, progress.part(0.4, 0.8));
  if (!edges) return std::nullopt;
  std::vector<std::size_t> starts;  // of the edges of a piece, and their end
  for (std::size_t i = 0; i < edges->size(); ++i) {
    if (i == 0 || !((*edges)[i].view == (*edges)[i - 1].view)) starts.push_back(i);
  }
  std::vector<VisiblePiece> pieces(starts.size());
  starts.push_back(edges->size());
  std::atomic<bool> is_clear = true;
  parallel_for(static_cast<std::int64_t>(pieces.size()), threads, progress.part(0.8, 1.0),
               [&](std::int64_t index) {
                 const auto i = static_cast<std::size_t>(index);
                 const auto own = std::span(*edges).subspan(starts[i], starts[i + 1] - starts[i]);
                 const View& view = own.front().view;
                 pieces[i] = {view.layer, {view.veils.rbegin(), view.veils.rend()}, {}};
                 std::vector<BoundaryChain> boundary;
                 for (const ViewEdge& edge : own) boundary.push_back(edge.chain);
                 if (!arrangement.trace(boundary, &pieces[i].outline)) is_clear = false;
               });
  progress.report(1.0);
  if (!is_clear) return std::nullopt;
  return pieces;
}

}  // namespace prefilter
