// SPDX-License-Identifier: GPL-3.0-or-later

// Sections 7.2 and 7.3: closed-form integrals over triangles cut to the finest cells. On texels
// inside a single triangle the integrals of the image are a fixed 3 x 3 stencil.
#include "prefilter/textures/texels/moment_sweep.h"

#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <mutex>
#include <vector>

#include "prefilter/geometry/moments/axis_parts.h"
#include "prefilter/geometry/moments/four_point_rule.h"
#include "prefilter/geometry/texels/tiles.h"
#include "prefilter/images/srgb_decoder.h"
#include "prefilter/textures/texels/levels.h"

namespace prefilter {
namespace {

// The last level that is visited tile by tile. Tiles of one pass are a tile apart, so they share no
// texel of a level if its texels are at most half a tile wide.
int last_tile_level(int width, int height) {
  const auto fits = [](int size, int level) {
    return 2 * size <= Tiles::kSize * level_size(size, level);
  };
  constexpr int kMaxTileLevel = 4;  // reached if the sides are powers of two
  int level = 1;
  while (level < kMaxTileLevel && fits(width, level + 1) && fits(height, level + 1)) ++level;
  return level;
}

// Cells [x0, x0 + width) x [y0, y0 + height) of a level.
struct CellRange {
  int x0 = 0;
  int y0 = 0;
  int width = 0;
  int height = 0;

  std::size_t count() const { return static_cast<std::size_t>(width) * height; }
};

// The surface's measure on the cells of level 0 in one tile.
class TileMeasure final : public CellSink {
 public:
  void collect(const TexelTriangles& source, const Tiles& tiles, std::int64_t tile,
               const AxisCells& x_cells, const AxisCells& y_cells, const CellRange& range) {
    if (range.count() != pieces_.size() || range.width != range_.width) {
      pieces_.assign(range.count(), {});
      has_pieces_.assign(range.count(), 0);
    } else {
      for (const int cell : touched_) {
        pieces_[cell] = {};
        has_pieces_[cell] = 0;
      }
    }
    touched_.clear();
    // A uniform density is per texel, and a half-texel square is a quarter of one.
    uniform_.assign(range.count(), 0.25 * source.uniform_density);
    range_ = range;

    const CellWindow texels = tiles.window(tile);
    window_ = {2 * texels.x0, 2 * texels.y0, 2 * texels.x1, 2 * texels.y1};
    x_parts_ = AxisParts(x_cells.lines(0), range.x0, range.x0 + range.width, 2.0);
    y_parts_ = AxisParts(y_cells.lines(0), range.y0, range.y0 + range.height, 2.0);
    for (const std::uint32_t* k = tiles.begin(tile); k != tiles.end(tile); ++k) {
      MassTriangle triangle = source.triangles[*k];
      for (GridPoint& corner : triangle.corners) {
        corner.x *= 2.0;
        corner.y *= 2.0;
      }
      cut_to_cells(triangle, window_, this);
    }
  }

  int cell(int x, int y) const { return y * range_.width + x; }
  bool has_pieces(int cell) const { return has_pieces_[cell] != 0; }
  // Mass per half-texel square that covers the cell uniformly.
  double uniform(int cell) const { return uniform_[cell]; }
  WeightMoments moments(int x, int y) const {
    const int at = cell(x, y);
    WeightMoments result = pieces_[at];
    const double mass = uniform_[at] * x_parts_.width(x) * y_parts_.width(y);
    for (int i = 0; i < 9; ++i) result[i] += mass * kUniformMoments[i];
    return result;
  }

 private:
  void add_full(int y, int x0, int x1, double density) override {
    const int rows_end = y_parts_.first_of(y - window_.y0 + 1);
    const int columns_end = x_parts_.first_of(x1 - window_.x0);
    for (int row = y_parts_.first_of(y - window_.y0); row < rows_end; ++row) {
      for (int column = x_parts_.first_of(x0 - window_.x0); column < columns_end; ++column) {
        uniform_[cell(column, row)] += density;
      }
    }
  }

  void add_piece(int x, int y, const CellPiece& piece) override {
    const int in_x = x - window_.x0;
    const int in_y = y - window_.y0;
    if (x_parts_.parts_of(in_x) == 1 && y_parts_.parts_of(in_y) == 1) {
      piece.add_moments(x, y, touch(x_parts_.first_of(in_x), y_parts_.first_of(in_y)));
      return;
    }
    y_parts_.cut(piece, 1, in_y, [&](int row, const CellPiece& strip) {
      x_parts_.cut(strip, 0, in_x,
                   [&](int column, const CellPiece& part) { add_part(column, row, part); });
    });
  }

  void add_part(int column, int row, CellPiece piece) {
    if (!(piece.mass() > 0.0)) return;
    // Positions in the coordinates of the part, from 0 to 1.
    if (!piece.is_barycentric) piece.mass_per_area *= x_parts_.width(column) * y_parts_.width(row);
    for (int i = 0; i < piece.count; ++i) {
      GridPoint& corner = piece.corners[i];
      corner.x = (corner.x - x_parts_.low(column)) / x_parts_.width(column);
      corner.y = (corner.y - y_parts_.low(row)) / y_parts_.width(row);
    }
    piece.add_moments(0.0, 0.0, touch(column, row));
  }

  WeightMoments* touch(int column, int row) {
    const int at = cell(column, row);
    if (has_pieces_[at] == 0) {
      has_pieces_[at] = 1;
      touched_.push_back(at);
    }
    return &pieces_[at];
  }

  CellRange range_;
  CellWindow window_;  // half texels
  AxisParts x_parts_;
  AxisParts y_parts_;
  std::vector<double> uniform_;
  std::vector<WeightMoments> pieces_;
  std::vector<unsigned char> has_pieces_;
  std::vector<int> touched_;
};

// The texels of a tile and a border of one texel, as the wrap mode reads them.
template <int C>
class Patch {
 public:
  static constexpr int kSide = Tiles::kSize + 2;
  using Texel = std::array<double, C>;

  void load(const TexelSource& image, WrapModes wrap, const CellWindow& window) {
    for (int y = window.y0 - 1; y <= window.y1; ++y) {
      const int row = wrap_index(y, image.height, wrap.v);
      for (int x = window.x0 - 1; x <= window.x1; ++x) {
        const int column = wrap_index(x, image.width, wrap.u);
        Texel& texel = texels_[(y - window.y0 + 1) * kSide + x - window.x0 + 1];
        texel.fill(0.0);
        if (row < 0 || column < 0) continue;
        if (image.has_bytes()) {
          const std::uint8_t* bytes = image.byte_texel(column, row);
          for (int c = 0; c < C; ++c) texel[c] = image.value(bytes[c], c);
        } else {
          const float* values = image.floats().texel(column, row);
          for (int c = 0; c < C; ++c) texel[c] = values[c];
        }
      }
    }
  }

  /// A texel of the tile; -1 and the tile's size are the border.
  const Texel& at(int x, int y) const { return texels_[(y + 1) * kSide + x + 1]; }

 private:
  std::array<Texel, kSide * kSide> texels_;
};

// Integrals of I and x I over a texel along one axis, for a bilinear I with values at the centers
// of the texel and its two neighbors.
constexpr double kTexelStencil[2][3] = {{6.0 / 48.0, 36.0 / 48.0, 6.0 / 48.0},
                                        {1.0 / 48.0, 18.0 / 48.0, 5.0 / 48.0}};

template <int C>
void add_uniform_texel(const Patch<C>& patch, int x, int y, double density,
                       ChannelMoments<C>* moments) {
  for (int c = 0; c < C; ++c) {
    double lines[2][3];
    for (int k = 0; k < 3; ++k) {
      const double west = patch.at(x - 1, y + k - 1)[c];
      const double middle = patch.at(x, y + k - 1)[c];
      const double east = patch.at(x + 1, y + k - 1)[c];
      for (int a = 0; a < 2; ++a) {
        lines[a][k] =
            kTexelStencil[a][0] * west + kTexelStencil[a][1] * middle + kTexelStencil[a][2] * east;
      }
    }
    for (int b = 0; b < 2; ++b) {
      for (int a = 0; a < 2; ++a) {
        double sum = 0.0;
        for (int k = 0; k < 3; ++k) sum += kTexelStencil[b][k] * lines[a][k];
        (*moments)[c][2 * b + a] += density * sum;
      }
    }
  }
}

// Image values at the four texel centers around a cell, at [2 * y + x].
template <int C>
using Corners = std::array<std::array<double, C>, 4>;

// Image moments of a cell, placed at `in_x`, `in_y` between four texel centers.
template <int C>
ChannelMoments<C> moments_between(const WeightMoments& w, const Corners<C>& corners,
                                  const Placement& in_x, const Placement& in_y) {
  ChannelMoments<C> moments;
  const double x = in_x.offset;
  const double y = in_y.offset;
  for (int c = 0; c < C; ++c) {
    const double v00 = corners[0][c];
    const double v10 = corners[1][c];
    const double v01 = corners[2][c];
    const double v11 = corners[3][c];
    // Bilinear in the cell's own coordinates: p00 + p10 x + p01 y + p11 x y.
    const double slope_x = v10 - v00;
    const double slope_y = v01 - v00;
    const double twist = v11 - v10 - v01 + v00;
    const double p00 = v00 + slope_x * x + slope_y * y + twist * x * y;
    const double p10 = in_x.scale * (slope_x + twist * y);
    const double p01 = in_y.scale * (slope_y + twist * x);
    const double p11 = in_x.scale * in_y.scale * twist;
    for (int b = 0; b < 2; ++b) {
      for (int a = 0; a < 2; ++a) {
        const int i = 3 * b + a;
        moments[c][2 * b + a] = p00 * w[i] + p10 * w[i + 1] + p01 * w[i + 3] + p11 * w[i + 4];
      }
    }
  }
  return moments;
}

// Image moments of a level 0 cell at `in_x`, `in_y` between texels of the image.
template <int C>
ChannelMoments<C> cell_moments(const WeightMoments& w, const Patch<C>& patch,
                               const CellWindow& texels, const CellPlace& in_x,
                               const CellPlace& in_y) {
  const int column = in_x.texel - texels.x0;
  const int row = in_y.texel - texels.y0;
  return moments_between<C>(w,
                            {patch.at(column, row), patch.at(column + 1, row),
                             patch.at(column, row + 1), patch.at(column + 1, row + 1)},
                            in_x.placement, in_y.placement);
}

// The same for an image with encoded colors, which are decoded after the lookup.
template <int C>
ChannelMoments<C> decoded_cell_moments(const WeightMoments& w, const Patch<C>& patch,
                                       const CellWindow& texels, const CellPlace& in_x,
                                       const CellPlace& in_y) {
  const SrgbDecoder& decode = SrgbDecoder::instance();
  ChannelMoments<C> moments{};
  const FourPointRule rule(w);
  const int column = in_x.texel - texels.x0;
  const int row = in_y.texel - texels.y0;
  for (int k = 0; k < 4; ++k) {
    const double cell_x = rule.x(k);
    const double cell_y = rule.y(k);
    const double x = in_x.placement.offset + in_x.placement.scale * cell_x;
    const double y = in_y.placement.offset + in_y.placement.scale * cell_y;
    for (int c = 0; c < C; ++c) {
      const double low = (1.0 - x) * patch.at(column, row)[c] + x * patch.at(column + 1, row)[c];
      const double high =
          (1.0 - x) * patch.at(column, row + 1)[c] + x * patch.at(column + 1, row + 1)[c];
      double value = (1.0 - y) * low + y * high;
      if (c < encoded_channels(C)) value = decode(static_cast<float>(value)).value;
      value *= rule.weight(k);
      moments[c][0] += value;
      moments[c][1] += cell_x * value;
      moments[c][2] += cell_y * value;
      moments[c][3] += cell_x * cell_y * value;
    }
  }
  return moments;
}

// Buffers for one tile.
template <int C>
struct Workspace {
  TileMeasure measure;
  Patch<C> patch;
  std::vector<CellMoments<C>> cells[2];
  Patch<C> patch_of_means;
  std::vector<ChannelMoments<C>> means[2];  // empty without an image of means
};

template <int C>
class WorkspacePool {
 public:
  std::unique_ptr<Workspace<C>> take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (free_.empty()) return std::make_unique<Workspace<C>>();
    std::unique_ptr<Workspace<C>> workspace = std::move(free_.back());
    free_.pop_back();
    return workspace;
  }
  void give_back(std::unique_ptr<Workspace<C>> workspace) {
    const std::lock_guard<std::mutex> lock(mutex_);
    free_.push_back(std::move(workspace));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Workspace<C>>> free_;
};

template <int C>
class Sweep {
 public:
  using Visit = std::function<void(const MomentBlock<C>&)>;

  Sweep(const TexelTriangles& triangles, const TexelSource& image, WrapModes wrap,
        const SweepOptions& options, const Run& run, const Visit& visit)
      : triangles_(triangles),
        image_(image),
        wrap_(wrap),
        options_(options),
        visit_(visit),
        run_(run),
        tiles_(triangles, run.part(0.0, 0.1)),
        tile_levels_(last_tile_level(image.width, image.height)),
        x_cells_(image.width, full_level_count(image.width, image.height), Tiles::kSize,
                 tile_levels_ + 1),
        y_cells_(image.height, full_level_count(image.width, image.height), Tiles::kSize,
                 tile_levels_ + 1) {
    if (options_.last_level > tile_levels_) coarse_.resize(whole(tile_levels_ + 1).count());
  }

  void run() {
    tiles_.for_each_apart(run_.part(0.1, 1.0), [this](std::int64_t tile) {
      std::unique_ptr<Workspace<C>> workspace = pool_.take();
      sweep_tile(tile, workspace.get());
      pool_.give_back(std::move(workspace));
    });
    sweep_coarse();
  }

 private:
  CellRange whole(int level) const {
    return {0, 0, x_cells_.cell_count(level), y_cells_.cell_count(level)};
  }
  CellRange within(const CellWindow& texels, int level) const {
    const int x0 = x_cells_.cell_at(level, texels.x0);
    const int y0 = y_cells_.cell_at(level, texels.y0);
    return {x0, y0, x_cells_.cell_at(level, texels.x1) - x0,
            y_cells_.cell_at(level, texels.y1) - y0};
  }

  void visit(int level, const CellRange& range, const CellMoments<C>* cells,
             const ChannelMoments<C>* means, std::int64_t index) const {
    if (level < options_.first_level || level > options_.last_level) return;
    MomentBlock<C> block;
    block.level = level;
    block.x0 = range.x0;
    block.y0 = range.y0;
    block.width = range.width;
    block.height = range.height;
    block.cells = cells;
    block.means = means;
    block.x_cells = &x_cells_;
    block.y_cells = &y_cells_;
    block.index = index;
    visit_(block);
  }

  // Adds the moments of a level's cells to `coarse_cells`, the cells of the next level, and `means`
  // to `coarse_means` unless that is null.
  void nest(int level, const CellRange& range, const CellMoments<C>* cells,
            const CellRange& coarse_range, CellMoments<C>* coarse_cells,
            const ChannelMoments<C>* means = nullptr,
            ChannelMoments<C>* coarse_means = nullptr) const {
    const CellParent* x_parents = x_cells_.parents(level).data() + range.x0;
    const CellParent* y_parents = y_cells_.parents(level).data() + range.y0;
    for (int y = 0; y < range.height; ++y) {
      const std::ptrdiff_t row =
          static_cast<std::ptrdiff_t>(y_parents[y].cell - coarse_range.y0) * coarse_range.width -
          coarse_range.x0;
      for (int x = 0; x < range.width; ++x, ++cells) {
        if (cells->empty()) continue;
        const std::ptrdiff_t parent = row + x_parents[x].cell;
        const Placement& in_x = x_parents[x].placement;
        const Placement& in_y = y_parents[y].placement;
        add_child(*cells, in_x, in_y, coarse_cells + parent);
        if (coarse_means == nullptr) continue;
        const std::ptrdiff_t own = static_cast<std::ptrdiff_t>(y) * range.width + x;
        add_image_child(means[own], in_x, in_y, coarse_means + parent);
      }
    }
  }

  bool has_means() const { return options_.means != nullptr; }

  // Image moments of a level 0 cell in a tile.
  ChannelMoments<C> moments_in(const Patch<C>& patch, const WeightMoments& weight,
                               const CellWindow& texels, const CellRange& range, int x,
                               int y) const {
    const CellPlace& in_x = x_cells_.places(0, 0)[range.x0 + x];
    const CellPlace& in_y = y_cells_.places(0, 0)[range.y0 + y];
    return options_.reader == Reader::kSrgbAfter
               ? decoded_cell_moments(weight, patch, texels, in_x, in_y)
               : cell_moments(weight, patch, texels, in_x, in_y);
  }

  // Computes the finest visited level in cells[0] and means[0]; returns the level.
  int start_tile(const CellWindow& texels, Workspace<C>* work) const {
    const bool has_level_0 =
        options_.first_level == 0 || !x_cells_.halves_evenly() || !y_cells_.halves_evenly();
    const CellRange quarters = within(texels, 0);
    const CellRange range = has_level_0 ? quarters : within(texels, 1);
    work->cells[0].assign(range.count(), {});
    if (has_means()) work->means[0].assign(range.count(), {});
    for (int y = 0; y < range.height; ++y) {
      for (int x = 0; x < range.width; ++x) {
        if (has_level_0) {
          start_cell(texels, quarters, x, y, work);
        } else {
          start_texel(texels, quarters, x, y, work);
        }
      }
    }
    return has_level_0 ? 0 : 1;
  }

  // Computes a cell of level 0.
  void start_cell(const CellWindow& texels, const CellRange& range, int x, int y,
                  Workspace<C>* work) const {
    const WeightMoments weight = work->measure.moments(x, y);
    if (weight[0] == 0.0) return;
    const int at = work->measure.cell(x, y);
    work->cells[0][at] = {weight, moments_in(work->patch, weight, texels, range, x, y)};
    if (!has_means()) return;
    work->means[0][at] = moments_in(work->patch_of_means, weight, texels, range, x, y);
  }

  // Computes a texel, which is a cell of level 1. `range` holds the cells of level 0.
  void start_texel(const CellWindow& texels, const CellRange& range, int x, int y,
                   Workspace<C>* work) const {
    const TileMeasure& measure = work->measure;
    const auto at = static_cast<std::size_t>(y) * (texels.x1 - texels.x0) + x;
    CellMoments<C>& texel = work->cells[0][at];
    const int quarters[4] = {measure.cell(2 * x, 2 * y), measure.cell(2 * x + 1, 2 * y),
                             measure.cell(2 * x, 2 * y + 1), measure.cell(2 * x + 1, 2 * y + 1)};
    const double density = measure.uniform(quarters[0]);
    bool even = options_.reader == Reader::kLinear;
    for (const int quarter : quarters) {
      even = even && !measure.has_pieces(quarter) && measure.uniform(quarter) == density;
    }
    if (even) {
      if (!(density > 0.0)) return;
      for (int i = 0; i < 9; ++i) texel.weight[i] += 4.0 * density * kUniformMoments[i];
      add_uniform_texel<C>(work->patch, x, y, 4.0 * density, &texel.image);
      if (!has_means()) return;
      add_uniform_texel<C>(work->patch_of_means, x, y, 4.0 * density, &work->means[0][at]);
      return;
    }
    const Placement halves[2] = {{0.0, 0.5}, {0.5, 0.5}};
    for (int k = 0; k < 4; ++k) {
      const int column = 2 * x + k % 2;
      const int row = 2 * y + k / 2;
      const WeightMoments weight = measure.moments(column, row);
      if (weight[0] == 0.0) continue;
      const auto moments_of = [&](const Patch<C>& patch) {
        return moments_in(patch, weight, texels, range, column, row);
      };
      const Placement& in_x = halves[k % 2];
      const Placement& in_y = halves[k / 2];
      add_child(CellMoments<C>{weight, moments_of(work->patch)}, in_x, in_y, &texel);
      if (!has_means()) continue;
      add_image_child(moments_of(work->patch_of_means), in_x, in_y, &work->means[0][at]);
    }
  }

  void sweep_tile(std::int64_t tile, Workspace<C>* work) {
    const CellWindow texels = tiles_.window(tile);
    if (tiles_.begin(tile) == tiles_.end(tile) && triangles_.uniform_density == 0.0) return;
    work->measure.collect(triangles_, tiles_, tile, x_cells_, y_cells_, within(texels, 0));
    work->patch.load(image_, wrap_, texels);
    if (has_means()) work->patch_of_means.load(options_.means->view(), wrap_, texels);

    int level = start_tile(texels, work);
    int current = 0;
    const int last = std::min(options_.last_level, tile_levels_);
    const auto means_of = [&](int of, int at) {
      return has_means() && of <= 1 ? work->means[at].data() : nullptr;
    };
    visit(level, within(texels, level), work->cells[current].data(), means_of(level, current),
          tile);
    while (level < last) {
      const CellRange next = within(texels, level + 1);
      std::vector<CellMoments<C>>& coarse = work->cells[1 - current];
      coarse.assign(next.count(), {});
      if (has_means() && level == 0) work->means[1 - current].assign(next.count(), {});
      nest(level, within(texels, level), work->cells[current].data(), next, coarse.data(),
           means_of(level, current), means_of(level + 1, 1 - current));
      ++level;
      current = 1 - current;
      visit(level, next, work->cells[current].data(), means_of(level, current), tile);
    }
    // Tiles cover disjoint cells of the coarse grid.
    if (!coarse_.empty()) {
      nest(level, within(texels, level), work->cells[current].data(), whole(level + 1),
           coarse_.data());
    }
  }

  void sweep_coarse() {
    for (int level = tile_levels_ + 1; level <= options_.last_level; ++level) {
      visit(level, whole(level), coarse_.data(), nullptr, tiles_.count());
      if (level == options_.last_level) break;
      std::vector<CellMoments<C>> nested(whole(level + 1).count());
      nest(level, whole(level), coarse_.data(), whole(level + 1), nested.data());
      coarse_ = std::move(nested);
    }
  }

  const TexelTriangles& triangles_;
  const TexelSource& image_;
  WrapModes wrap_;
  SweepOptions options_;
  const Visit& visit_;
  const Run& run_;
  Tiles tiles_;
  int tile_levels_;
  AxisCells x_cells_;
  AxisCells y_cells_;
  WorkspacePool<C> pool_;
  std::vector<CellMoments<C>>
      coarse_;  // the finest coarse level not yet visited, from tile_levels_ + 1 on
};

}  // namespace

std::int64_t sweep_block_count(int width, int height) {
  const std::int64_t columns = (width + Tiles::kSize - 1) / Tiles::kSize;
  const std::int64_t rows = (height + Tiles::kSize - 1) / Tiles::kSize;
  return columns * rows + 1;
}

template <int C>
void sweep_moments(const TexelTriangles& triangles, const TexelSource& image, WrapModes wrap,
                   const SweepOptions& options, const Run& run,
                   const std::function<void(const MomentBlock<C>&)>& visit) {
  assert(image.channels == C);
  assert(options.last_level < full_level_count(image.width, image.height));
  Sweep<C>(triangles, image, wrap, options, run, visit).run();
}

template void sweep_moments<1>(const TexelTriangles&, const TexelSource&, WrapModes,
                               const SweepOptions&, const Run&,
                               const std::function<void(const MomentBlock<1>&)>&);
template void sweep_moments<2>(const TexelTriangles&, const TexelSource&, WrapModes,
                               const SweepOptions&, const Run&,
                               const std::function<void(const MomentBlock<2>&)>&);
template void sweep_moments<3>(const TexelTriangles&, const TexelSource&, WrapModes,
                               const SweepOptions&, const Run&,
                               const std::function<void(const MomentBlock<3>&)>&);
template void sweep_moments<4>(const TexelTriangles&, const TexelSource&, WrapModes,
                               const SweepOptions&, const Run&,
                               const std::function<void(const MomentBlock<4>&)>&);

}  // namespace prefilter
