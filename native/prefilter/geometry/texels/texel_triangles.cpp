// SPDX-License-Identifier: GPL-3.0-or-later

// Clips triangles at the lines between tiles, and moves the parts as the wrap mode does.
#include "prefilter/geometry/texels/texel_triangles.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

constexpr double kMaxTiles = 1 << 20;
// Farther out, rounding errors of coordinates are too large to place triangles in the image.
constexpr double kMaxTexcoordReach = 1 << 30;

struct Extent {
  double low, high;
};

Extent extent(const MassTriangle& triangle, double GridPoint::*axis) {
  const auto [low, high] = std::minmax(
      {triangle.corners[0].*axis, triangle.corners[1].*axis, triangle.corners[2].*axis});
  return {low, high};
}

class Mapper final : public CellSink {
 public:
  Mapper(int width, int height, WrapModes wrap, TexelTriangles* out)
      : width_(width), height_(height), wrap_(wrap), out_(out) {}

  // `triangle` is in units of tiles; error messages contain the indices.
  void add(const MassTriangle& triangle, std::size_t surface_index, std::size_t triangle_index) {
    const Extent u = extent(triangle, &GridPoint::x);
    const Extent v = extent(triangle, &GridPoint::y);
    if (u.low >= 0.0 && u.high <= 1.0 && v.low >= 0.0 && v.high <= 1.0) {
      push(triangle);
      return;
    }
    const double tiles = tile_count(u, wrap_.u) * tile_count(v, wrap_.v);
    const double repeated = std::max(repeated_reach(u, wrap_.u), repeated_reach(v, wrap_.v));
    const double reach = std::max({-u.low, u.high, -v.low, v.high});
    if (tiles > kMaxTiles || repeated > kMaxTiles || reach > kMaxTexcoordReach) {
      throw_invalid(
          "surface " + std::to_string(surface_index) + ", uvs: triangle " +
          std::to_string(triangle_index) + " spans u from " + to_text(u.low) + " to " +
          to_text(u.high) + " and v from " + to_text(v.low) + " to " + to_text(v.high) +
          "; a repeated texture may be met in at most 2^20 tiles, up to 2^20 tiles from the "
          "origin, and any other up to 2^30");
    }
    if (wrap_.u == Wrap::kRepeat && wrap_.v == Wrap::kRepeat) {
      const CellSpan columns = cell_span(u.low, u.high);
      const CellSpan rows = cell_span(v.low, v.high);
      cut_to_cells(triangle, {columns.first, rows.first, columns.last + 1, rows.last + 1}, this);
    } else {
      // Parts beyond the edge move onto it and keep their mass.
      cut(whole_piece(triangle, true), 0, wrap_.u, u, [&](const CellPiece& part) {
        cut(part, 1, wrap_.v, v, [&](const CellPiece& inner) { push_fan(inner); });
      });
    }
  }

 private:
  void add_full(int, int x0, int x1, double density) override {
    const double mass = density * (x1 - x0);
    out_->uniform_density += mass / (static_cast<double>(width_) * height_);
  }

  void add_piece(int tile_x, int tile_y, const CellPiece& piece) override {
    CellPiece moved = piece;
    for (int i = 0; i < moved.count; ++i) {
      moved.corners[i].x -= tile_x;
      moved.corners[i].y -= tile_y;
    }
    push_fan(moved);
  }

  static double tile_count(const Extent& extent, Wrap mode) {
    return mode == Wrap::kRepeat ? std::floor(extent.high) - std::floor(extent.low) + 1.0 : 1.0;
  }

  static double repeated_reach(const Extent& extent, Wrap mode) {
    return mode == Wrap::kRepeat ? std::max(std::abs(extent.low), std::abs(extent.high)) : 0.0;
  }

  // Cuts a piece along one axis at the breaks of the wrap mode, and moves each part to the place
  // where a lookup there reads the image.
  template <typename Use>
  static void cut(const CellPiece& piece, int axis, Wrap mode, const Extent& extent,
                  const Use& use) {
    const auto move_all = [axis](CellPiece part, const auto& move) {
      for (int i = 0; i < part.count; ++i) {
        double& value = axis == 0 ? part.corners[i].x : part.corners[i].y;
        value = move(value);
      }
      return part;
    };
    CellPiece part;
    CellPiece rest = piece;
    CellPiece beyond;
    if (mode == Wrap::kRepeat) {
      const CellSpan tiles = cell_span(extent.low, extent.high);
      for (int tile = tiles.first; tile <= tiles.last; ++tile) {
        split_piece(rest, axis, tile + 1, &part, &beyond);
        const auto shift = [tile](double value) { return value - tile; };
        use(move_all(tile == tiles.last ? rest : part, shift));
        rest = beyond;
      }
      return;
    }
    const auto to_edge = [](double value) { return std::clamp(value, 0.0, 1.0); };
    if (extent.low < 0.0) {
      split_piece(rest, axis, 0.0, &part, &beyond);
      if (mode == Wrap::kClamp) use(move_all(part, to_edge));
      rest = beyond;
    }
    if (extent.high > 1.0) {
      split_piece(rest, axis, 1.0, &part, &beyond);
      if (mode == Wrap::kClamp) use(move_all(beyond, to_edge));
      rest = part;
    }
    use(rest);
  }

  void push_fan(const CellPiece& piece) {
    for (int i = 2; i < piece.count; ++i) {
      CellPiece triangle = piece;
      for (int k = 1; k < 3; ++k) {
        triangle.corners[k] = piece.corners[i - 2 + k];
        triangle.sources[k] = piece.sources[i - 2 + k];
      }
      triangle.count = 3;
      push({{triangle.corners[0], triangle.corners[1], triangle.corners[2]}, triangle.mass()});
    }
  }

  void push(MassTriangle triangle) {
    if (!(triangle.mass > 0.0)) return;
    for (GridPoint& corner : triangle.corners) {
      corner.x = std::clamp(corner.x, 0.0, 1.0) * width_;
      corner.y = std::clamp(corner.y, 0.0, 1.0) * height_;
    }
    keep_off_far_edge(&GridPoint::x, width_, &triangle);
    keep_off_far_edge(&GridPoint::y, height_, &triangle);
    out_->triangles.push_back(triangle);
  }

  // Triangles that lie entirely on the image's far edge belong to the last texel, as cells are
  // half-open.
  static void keep_off_far_edge(double GridPoint::*axis, int size, MassTriangle* triangle) {
    for (const GridPoint& corner : triangle->corners) {
      if (corner.*axis != size) return;
    }
    for (GridPoint& corner : triangle->corners) corner.*axis = std::nextafter(size, 0.0);
  }

  int width_;
  int height_;
  WrapModes wrap_;
  TexelTriangles* out_;
};

}  // namespace

TexelTriangles map_to_texels(const std::vector<const Surface*>& surfaces, int width, int height,
                             WrapModes wrap, MassOf mass_of, const Run& run) {
  double total_area = 0.0;
  struct TriangleRange {
    std::size_t surface, first, last;
  };
  constexpr std::size_t kTrianglesAtOnce = 1 << 14;
  std::vector<TriangleRange> ranges;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    total_area += surfaces[s]->total_area();
    const std::size_t count = surfaces[s]->triangle_count();
    for (std::size_t first = 0; first < count; first += kTrianglesAtOnce) {
      ranges.push_back({s, first, std::min(first + kTrianglesAtOnce, count)});
    }
  }
  // Scaled so that masses are of order 1 in any unit of length.
  const double scale = total_area > 0.0 ? static_cast<double>(width) * height / total_area : 0.0;

  std::vector<TexelTriangles> mapped(ranges.size());
  const auto range_count = static_cast<std::int64_t>(ranges.size());
  const Stages stages(run, {9, 1});
  parallel_for(range_count, stages[0], [&](std::int64_t i) {
    const TriangleRange& range = ranges[i];
    const Surface& surface = *surfaces[range.surface];
    mapped[i].triangles.reserve(range.last - range.first);
    Mapper mapper(width, height, wrap, &mapped[i]);
    for (std::size_t k = range.first; k < range.last; ++k) {
      MassTriangle triangle;
      triangle.mass = mass_of == MassOf::kPresence ? 1.0 : surface.areas[k] * scale;
      if (!(triangle.mass > 0.0)) continue;
      for (int c = 0; c < 3; ++c) triangle.corners[c] = {surface.uvs[k][c].u, surface.uvs[k][c].v};
      mapper.add(triangle, range.surface, k);
    }
  });

  TexelTriangles out;
  if (mapped.size() == 1) out = std::move(mapped[0]);
  out.width = width;
  out.height = height;
  if (mapped.size() > 1) {
    std::vector<std::size_t> starts = {0};
    for (const TexelTriangles& part : mapped) {
      starts.push_back(starts.back() + part.triangles.size());
      out.uniform_density += part.uniform_density;
    }
    out.triangles.resize(starts.back());
    parallel_for(range_count, stages[1], [&](std::int64_t i) {
      std::copy(mapped[i].triangles.begin(), mapped[i].triangles.end(),
                out.triangles.begin() + static_cast<std::ptrdiff_t>(starts[i]));
      std::vector<MassTriangle>().swap(mapped[i].triangles);
    });
  }
  out.total_mass = out.uniform_mass();
  for (const MassTriangle& triangle : out.triangles) out.total_mass += triangle.mass;
  return out;
}

}  // namespace prefilter
