// SPDX-License-Identifier: GPL-3.0-or-later

// All contours of all layers are cut where they meet. To the left and to the right of each part the
// winding numbers tell which layers are seen, and how much of each: where that differs for a layer,
// the part is on the boundary of one of its pieces.
#include "prefilter/outline/visible_pieces.h"

#include <algorithm>
#include <compare>

#include "prefilter/base/parallel.h"
#include "prefilter/outline/arrangement.h"
#include "prefilter/outline/fill_rule.h"
#include "prefilter/outline/polygon_clipper.h"
#include "prefilter/outline/set_operations.h"

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

// Boundaries of all views: edges of the same one in a row.
std::vector<ViewEdge> find_edges(const Arrangement& arrangement,
                                 std::span<const CoveringLayer> layers, int threads,
                                 const Progress& progress) {
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
        arrangement.visit(
            begin, end,
            [&](std::uint32_t chain, const LayerWindings& right, const LayerWindings& left) {
              find_views(layers, right, &touched, &on_right);
              find_views(layers, left, &touched, &on_left);
              append(on_left, on_right, chain, false);
              append(on_right, on_left, chain, true);
            });
      });
  std::vector<ViewEdge> all;
  for (const auto& edges : parts) all.insert(all.end(), edges.begin(), edges.end());
  std::stable_sort(all.begin(), all.end(),
                   [](const ViewEdge& a, const ViewEdge& b) { return a.view < b.view; });
  return all;
}

// One layer's pieces by polygons: the layers over it divide them, one after the other.
std::vector<VisiblePiece> pieces_by_polygons(std::span<const CoveringLayer> layers,
                                             std::size_t index, double tolerance) {
  constexpr FillRule kRule = FillRule::kNonzero;
  const auto polygons_of = [&](std::size_t layer) {
    const Outline& outline = *layers[layer].outline;
    return flattened(combine_polygons(flattened(outline, tolerance), layers[layer].fill_rule, {},
                                      layers[layer].fill_rule, OutlineOperation::kUnion),
                     tolerance);
  };
  const Box2 box = control_box(*layers[index].outline);
  std::vector<VisiblePiece> pieces = {{index, {}, {}}};
  for (const Polygon& polygon : polygons_of(index)) {
    pieces[0].outline.move_to(polygon[0]);
    for (std::size_t i = 1; i < polygon.size(); ++i) pieces[0].outline.line_to(polygon[i]);
    pieces[0].outline.close();
  }
  for (std::size_t above = index + 1; above < layers.size(); ++above) {
    const Box2 other = control_box(*layers[above].outline);
    if (!(box.low.x <= other.high.x && other.low.x <= box.high.x && box.low.y <= other.high.y &&
          other.low.y <= box.high.y)) {
      continue;
    }
    const std::vector<Polygon> cover = polygons_of(above);
    std::vector<VisiblePiece> divided;
    for (const VisiblePiece& piece : pieces) {
      const std::vector<Polygon> polygons = flattened(piece.outline, tolerance);
      divided.push_back(
          {index, piece.veils,
           combine_polygons(polygons, kRule, cover, kRule, OutlineOperation::kDifference)});
      if (layers[above].is_opaque) continue;
      divided.push_back(
          {index, piece.veils,
           combine_polygons(polygons, kRule, cover, kRule, OutlineOperation::kIntersection)});
      divided.back().veils.push_back(static_cast<std::uint32_t>(above));
    }
    std::erase_if(divided, [](const VisiblePiece& piece) { return piece.outline.empty(); });
    pieces = std::move(divided);
  }
  return pieces;
}

}  // namespace

std::vector<VisiblePiece> visible_pieces(std::span<const CoveringLayer> layers, int threads,
                                         const Progress& progress, double tolerance) {
  std::vector<const Outline*> outlines;
  for (const CoveringLayer& layer : layers) outlines.push_back(layer.outline);
  Arrangement arrangement(outlines, kPrecisions[0]);
  std::vector<std::vector<VisiblePiece>> pieces(layers.size());
  std::vector<ViewEdge> edges;
  std::vector<std::size_t> starts;  // of the edges of a layer, and their end
  if (arrangement.cut(progress.part(0.0, 0.4))) {
    edges = find_edges(arrangement, layers, threads, progress.part(0.4, 0.8));
    for (std::uint32_t layer = 0; layer <= layers.size(); ++layer) {
      const auto first =
          std::partition_point(edges.begin(), edges.end(),
                               [&](const ViewEdge& edge) { return edge.view.layer < layer; });
      starts.push_back(static_cast<std::size_t>(first - edges.begin()));
    }
  }
  parallel_for(static_cast<std::int64_t>(layers.size()), threads, progress.part(0.8, 1.0),
               [&](std::int64_t index) {
                 const auto layer = static_cast<std::size_t>(index);
                 bool is_clear = !starts.empty();
                 std::vector<BoundaryChain> boundary;
                 for (std::size_t i = is_clear ? starts[layer] : 0;
                      is_clear && i < starts[layer + 1];) {
                   const View& view = edges[i].view;
                   VisiblePiece piece = {layer, {view.veils.rbegin(), view.veils.rend()}, {}};
                   boundary.clear();
                   for (; i < starts[layer + 1] && edges[i].view == view; ++i) {
                     boundary.push_back(edges[i].chain);
                   }
                   is_clear = arrangement.trace(boundary, &piece.outline);
                   pieces[layer].push_back(std::move(piece));
                 }
                 if (!is_clear) pieces[layer] = pieces_by_polygons(layers, layer, tolerance);
               });
  std::vector<VisiblePiece> all;
  for (std::vector<VisiblePiece>& some : pieces) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  progress.report(1.0);
  return all;
}

}  // namespace prefilter
