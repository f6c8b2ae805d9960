// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/contour/unfold.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "prefilter/remesh/folds.h"

namespace prefilter {

std::vector<Vector3> halfway(const ContourTree& tree, const RootFrame& frame,
                             const SurfaceVertices& vertices) {
  std::vector<Vector3> positions = vertices.positions();
  const auto visit = [&](const auto& self, const CellNode& cell,
                         const CellCoordinates& at) -> void {
    const auto level = static_cast<std::size_t>(cell.depth);
    std::size_t vertex = vertices.first(level, cell.octants);
    for (std::uint64_t cuts = vertices.cuts(level, cell.octants); cuts != 0; cuts &= cuts - 1) {
      const int bit = std::countr_zero(cuts);
      const CellCoordinates leaf = octant_at(at, bit / 6);
      const auto axis = static_cast<std::size_t>(bit % 6 / 2);
      positions[vertex++][axis] = frame.position(
          static_cast<int>(axis), leaf[axis] + ((bit & 1) != 0 ? 1.0 : 0.0), cell.depth + 1);
    }
    for (int o = 0; o < 8; ++o) {
      const CellNode octant = tree.octant(cell, o);
      if (octant.is_split) self(self, octant, octant_at(at, o));
    }
  };
  if (tree.root().is_split) visit(visit, tree.root(), {0, 0, 0});
  return positions;
}

namespace {

constexpr int kSmoothings = 4;

// Of the triangles of a contour, those that fold, by vertices that may be moved.
class Folds {
 public:
  Folds(const VertexSamples& samples, std::size_t vertices, LoopedMesh* looped)
      : samples_(samples),
        vertices_(vertices),
        looped_(*looped),
        is_suspect_(looped->triangles.size(), 1) {}

  // Calls move(vertex) for the vertices of folds, each once; it returns whether it has.
  template <typename Move>
  bool move_vertices(const Move& move) {
    const MeshView<std::int32_t> view{looped_.positions, looped_.triangles};
    std::vector<std::uint8_t> is_seen(looped_.positions.size(), 0);
    std::vector<std::uint8_t> is_moved(looped_.positions.size(), 0);
    bool has_moved = false;
    for (const auto& pair : folded_pairs(view, 0, is_suspect_)) {
      for (const std::uint32_t t : pair) {
        for (const std::int32_t corner : looped_.triangles[t]) {
          const auto v = static_cast<std::size_t>(corner);
          if (v >= vertices_ || is_seen[v] != 0) continue;
          is_seen[v] = 1;
          const bool is_sampled = !samples_.index.empty() && samples_.index[v] >= 0;
          if (is_sampled || !move(v)) continue;
          is_moved[v] = 1;
          has_moved = true;
        }
      }
    }
    for (std::size_t t = 0; t < is_suspect_.size() && has_moved; ++t) {
      const auto& corners = looped_.triangles[t];
      is_suspect_[t] |= std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) {
        return is_moved[static_cast<std::size_t>(v)] != 0;
      });
    }
    return has_moved;
  }

  // The mean of the vertices around each.
  std::vector<Vector3> means() const {
    std::vector<Vector3> sums(vertices_);
    std::vector<double> counts(vertices_, 0.0);
    for (const auto& corners : looped_.triangles) {
      for (std::size_t k = 0; k < 3; ++k) {
        const auto v = static_cast<std::size_t>(corners[k]);
        if (v >= vertices_) continue;
        for (const std::size_t other : {(k + 1) % 3, (k + 2) % 3}) {
          sums[v] = sums[v] + looped_.positions[static_cast<std::size_t>(corners[other])];
        }
        counts[v] += 2.0;
      }
    }
    for (std::size_t v = 0; v < vertices_; ++v)
      sums[v] = (1.0 / std::max(counts[v], 1.0)) * sums[v];
    return sums;
  }

 private:
  const VertexSamples& samples_;
  std::size_t vertices_;
  LoopedMesh& looped_;
  std::vector<std::uint8_t> is_suspect_;
};

}  // namespace

void unfold(const VertexSamples& samples, Crossings* crossings, LoopedMesh* looped) {
  Folds folds(samples, crossings->fitted.size(), looped);
  const auto put_back = [&](std::size_t v) {
    return crossings->put_back(v, &looped->positions[v]);
  };
  while (folds.move_vertices(put_back)) {
  }
  // Between three cells of a gap even these may fold.
  for (int round = 0; round < kSmoothings; ++round) {
    std::vector<Vector3> means;
    const auto smooth = [&](std::size_t v) {
      if (means.empty()) means = folds.means();
      looped->positions[v] = 0.5 * (looped->positions[v] + means[v]);
      crossings->middle[v] = looped->positions[v];
      return true;
    };
    if (!folds.move_vertices(smooth)) return;
  }
}

}  // namespace prefilter
