// Sections 7.2 and 7.3: closed-form integrals over triangles cut to the half-texel grid. Where a
// texel lies inside of one triangle the integrals of the image are a fixed 3 x 3 stencil.
#include "prefilter/mipmap/moment_sweep.h"

#include <array>
#include <bit>
#include <cassert>
#include <memory>
#include <mutex>
#include <vector>

#include "prefilter/mipmap/levels.h"
#include "prefilter/mipmap/tiles.h"

namespace prefilter {
namespace {

// A tile must be at least two texels wide at a level that it visits by itself: then tiles that are
// not neighbours have no texel in common.
constexpr int kTileLevels =
    static_cast<int>(std::bit_width(static_cast<unsigned>(Tiles::kSize))) - 2;

// How often an axis was halved by a level: an axis of one texel stays.
int halvings(int size, int level) {
  return std::min(level, static_cast<int>(std::bit_width(static_cast<unsigned>(size))) - 1);
}

int half_cells(int size, int image_size, int level) {
  return 2 * size >> halvings(image_size, level);
}

struct Grid {
  int width = 0;
  int height = 0;
};

Half half_of(int child, bool halved) {
  if (!halved) return Half::kWhole;
  return child % 2 == 0 ? Half::kLow : Half::kHigh;
}

// The cells of the next level from those of this one.
template <int C>
void nest(const CellMoments<C>* fine, Grid fine_grid, Grid coarse_grid, CellMoments<C>* coarse) {
  std::fill(coarse, coarse + static_cast<std::ptrdiff_t>(coarse_grid.width) * coarse_grid.height,
            CellMoments<C>{});
  const bool halves_x = coarse_grid.width < fine_grid.width;
  const bool halves_y = coarse_grid.height < fine_grid.height;
  for (int y = 0; y < fine_grid.height; ++y) {
    CellMoments<C>* row =
        coarse + static_cast<std::ptrdiff_t>(halves_y ? y / 2 : y) * coarse_grid.width;
    for (int x = 0; x < fine_grid.width; ++x, ++fine) {
      if (fine->empty()) continue;
      add_child(*fine, half_of(x, halves_x), half_of(y, halves_y), row + (halves_x ? x / 2 : x));
    }
  }
}

// The surface's measure on the half-texel cells of one tile.
class TileMeasure final : public CellSink {
 public:
  static constexpr int kSide = 2 * Tiles::kSize;

  TileMeasure() : uniform_(kSide * kSide), pieces_(kSide * kSide), has_pieces_(kSide * kSide) {}

  void collect(const TexelTriangles& source, const Tiles& tiles, std::int64_t tile) {
    for (const int cell : touched_) {
      pieces_[cell] = {};
      has_pieces_[cell] = 0;
    }
    touched_.clear();
    std::fill(uniform_.begin(), uniform_.end(), 0.25 * source.uniform_density);

    const CellWindow texels = tiles.window(tile);
    x0_ = 2 * texels.x0;
    y0_ = 2 * texels.y0;
    const CellWindow window{x0_, y0_, 2 * texels.x1, 2 * texels.y1};
    for (const std::uint32_t* k = tiles.begin(tile); k != tiles.end(tile); ++k) {
      MassTriangle triangle = source.triangles[*k];
      for (Point2& corner : triangle.corners) {
        corner.x *= 2.0;
        corner.y *= 2.0;
      }
      cut_to_cells(triangle, window, this);
    }
  }

  static int cell(int x, int y) { return y * kSide + x; }
  bool has_pieces(int cell) const { return has_pieces_[cell] != 0; }
  double uniform(int cell) const { return uniform_[cell]; }
  WeightMoments moments(int cell) const {
    WeightMoments result = pieces_[cell];
    for (int i = 0; i < 9; ++i) result[i] += uniform_[cell] * kUniformMoments[i];
    return result;
  }

 private:
  void add_full(int y, int x0, int x1, double density) override {
    for (int x = x0; x < x1; ++x) uniform_[cell(x - x0_, y - y0_)] += density;
  }
  void add_piece(int x, int y, const CellPiece& piece) override {
    const int at = cell(x - x0_, y - y0_);
    if (has_pieces_[at] == 0) {
      has_pieces_[at] = 1;
      touched_.push_back(at);
    }
    piece.add_moments(x, y, &pieces_[at]);
  }

  int x0_ = 0;
  int y0_ = 0;
  std::vector<double> uniform_;  // mass of triangles that hold the whole cell
  std::vector<WeightMoments> pieces_;
  std::vector<unsigned char> has_pieces_;
  std::vector<int> touched_;
};

// The texels of a tile and one beside it all around, as the wrap mode reads them.
template <int C>
class Patch {
 public:
  static constexpr int kSide = Tiles::kSize + 2;
  using Texel = std::array<double, C>;

  void load(const ImageView& image, WrapModes wrap, const CellWindow& window) {
    for (int y = window.y0 - 1; y <= window.y1; ++y) {
      const int row = wrap_index(y, image.height, wrap.v);
      for (int x = window.x0 - 1; x <= window.x1; ++x) {
        const int column = wrap_index(x, image.width, wrap.u);
        Texel& texel = texels_[(y - window.y0 + 1) * kSide + x - window.x0 + 1];
        for (int c = 0; c < C; ++c) {
          texel[c] = row < 0 || column < 0 ? 0.0 : image.texel(column, row)[c];
        }
      }
    }
  }

  /// Texel of the tile; -1 and the tile's size are the ones beside it.
  const Texel& at(int x, int y) const { return texels_[(y + 1) * kSide + x + 1]; }

 private:
  std::array<Texel, kSide * kSide> texels_;
};

// Integrals of I and x I over a texel along one axis, for a bilinear I with values at the centres
// of the texel and its two neighbours.
constexpr double kTexelStencil[2][3] = {{6.0 / 48.0, 36.0 / 48.0, 6.0 / 48.0},
                                        {1.0 / 48.0, 18.0 / 48.0, 5.0 / 48.0}};

template <int C>
void add_uniform_texel(const Patch<C>& patch, int x, int y, double density,
                       CellMoments<C>* moments) {
  for (int i = 0; i < 9; ++i) moments->weight[i] += density * kUniformMoments[i];
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
        moments->image[c][2 * b + a] += density * sum;
      }
    }
  }
}

// Moments of half-texel cell (hx, hy) of the tile, at level 0.
template <int C>
CellMoments<C> half_texel_moments(const TileMeasure& measure, const Patch<C>& patch, int hx,
                                  int hy) {
  CellMoments<C> moments;
  moments.weight = measure.moments(TileMeasure::cell(hx, hy));
  if (moments.empty()) return moments;
  // The cell lies in the half of its texel beside column `column` and the next.
  const bool high_x = hx % 2 == 0;
  const bool high_y = hy % 2 == 0;
  const int column = hx / 2 - (high_x ? 1 : 0);
  const int row = hy / 2 - (high_y ? 1 : 0);
  const WeightMoments& w = moments.weight;
  for (int c = 0; c < C; ++c) {
    const double v00 = patch.at(column, row)[c];
    const double v10 = patch.at(column + 1, row)[c];
    const double v01 = patch.at(column, row + 1)[c];
    const double v11 = patch.at(column + 1, row + 1)[c];
    // Bilinear in the cell's x and y: p00 + p10 x + p01 y + p11 x y.
    const double dx = 0.5 * (v10 - v00);
    const double dy = 0.5 * (v01 - v00);
    const double p11 = 0.25 * (v11 - v10 - v01 + v00);
    const double p10 = dx + (high_y ? p11 : 0.0);
    const double p01 = dy + (high_x ? p11 : 0.0);
    const double p00 =
        v00 + (high_x ? dx : 0.0) + (high_y ? dy : 0.0) + (high_x && high_y ? p11 : 0.0);
    for (int b = 0; b < 2; ++b) {
      for (int a = 0; a < 2; ++a) {
        const int i = 3 * b + a;
        moments.image[c][2 * b + a] = p00 * w[i] + p10 * w[i + 1] + p01 * w[i + 3] + p11 * w[i + 4];
      }
    }
  }
  return moments;
}

// Memory that one tile needs at a time.
template <int C>
struct Workspace {
  TileMeasure measure;
  Patch<C> patch;
  std::vector<CellMoments<C>> cells[2];
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

  Sweep(const TexelTriangles& triangles, const ImageView& image, WrapModes wrap,
        const SweepOptions& options, const Progress& progress, const Visit& visit)
      : triangles_(triangles),
        image_(image),
        wrap_(wrap),
        options_(options),
        visit_(visit),
        progress_(progress),
        tiles_(triangles, progress.part(0.0, 0.1)) {
    if (options_.last_level > kTileLevels) {
      coarse_grid_ = grid(image.width, image.height, kTileLevels + 1);
      coarse_.resize(static_cast<std::size_t>(coarse_grid_.width) * coarse_grid_.height);
    }
  }

  void run() {
    tiles_.for_each_apart(options_.threads, progress_.part(0.1, 1.0), [this](std::int64_t tile) {
      std::unique_ptr<Workspace<C>> workspace = pool_.take();
      sweep_tile(tile, workspace.get());
      pool_.give_back(std::move(workspace));
    });
    sweep_coarse();
  }

 private:
  Grid grid(int width, int height, int level) const {
    return {half_cells(width, image_.width, level), half_cells(height, image_.height, level)};
  }

  void visit(int level, const CellWindow& texels, const CellMoments<C>* cells,
             std::int64_t index) const {
    if (level < options_.first_level || level > options_.last_level) return;
    MomentBlock<C> block;
    block.level = level;
    block.x0 = half_cells(texels.x0, image_.width, level);
    block.y0 = half_cells(texels.y0, image_.height, level);
    block.width = half_cells(texels.x1 - texels.x0, image_.width, level);
    block.height = half_cells(texels.y1 - texels.y0, image_.height, level);
    block.cells = cells;
    block.index = index;
    visit_(block);
  }

  // The finest level that is visited, in cells[0]; returns which level that is.
  int start_tile(const CellWindow& texels, Workspace<C>* work) const {
    const TileMeasure& measure = work->measure;
    const int width = texels.x1 - texels.x0;
    const int height = texels.y1 - texels.y0;
    std::vector<CellMoments<C>>& cells = work->cells[0];
    // A cell of level 1 is a texel only where both axes are halved.
    if (options_.first_level == 0 || image_.width == 1 || image_.height == 1) {
      cells.assign(static_cast<std::size_t>(4) * width * height, {});
      for (int hy = 0; hy < 2 * height; ++hy) {
        for (int hx = 0; hx < 2 * width; ++hx) {
          cells[static_cast<std::size_t>(hy) * 2 * width + hx] =
              half_texel_moments(measure, work->patch, hx, hy);
        }
      }
      return 0;
    }
    cells.assign(static_cast<std::size_t>(width) * height, {});
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        CellMoments<C>& texel = cells[static_cast<std::size_t>(y) * width + x];
        const int quarters[4] = {
            TileMeasure::cell(2 * x, 2 * y), TileMeasure::cell(2 * x + 1, 2 * y),
            TileMeasure::cell(2 * x, 2 * y + 1), TileMeasure::cell(2 * x + 1, 2 * y + 1)};
        const double density = measure.uniform(quarters[0]);
        bool even = true;
        for (const int quarter : quarters) {
          even = even && !measure.has_pieces(quarter) && measure.uniform(quarter) == density;
        }
        if (even) {
          if (density > 0.0) add_uniform_texel(work->patch, x, y, 4.0 * density, &texel);
          continue;
        }
        for (int k = 0; k < 4; ++k) {
          const int hx = 2 * x + k % 2;
          const int hy = 2 * y + k / 2;
          const CellMoments<C> quarter = half_texel_moments(measure, work->patch, hx, hy);
          if (!quarter.empty()) add_child(quarter, half_of(hx, true), half_of(hy, true), &texel);
        }
      }
    }
    return 1;
  }

  void sweep_tile(std::int64_t tile, Workspace<C>* work) {
    const CellWindow texels = tiles_.window(tile);
    const int width = texels.x1 - texels.x0;
    const int height = texels.y1 - texels.y0;
    if (tiles_.begin(tile) == tiles_.end(tile) && triangles_.uniform_density == 0.0) return;
    work->measure.collect(triangles_, tiles_, tile);
    work->patch.load(image_, wrap_, texels);

    int level = start_tile(texels, work);
    int current = 0;
    const int last = std::min(options_.last_level, kTileLevels);
    visit(level, texels, work->cells[current].data(), tile);
    while (level < last) {
      const Grid fine = grid(width, height, level);
      const Grid next = grid(width, height, level + 1);
      work->cells[1 - current].resize(static_cast<std::size_t>(next.width) * next.height);
      nest(work->cells[current].data(), fine, next, work->cells[1 - current].data());
      ++level;
      current = 1 - current;
      visit(level, texels, work->cells[current].data(), tile);
    }
    if (!coarse_.empty()) store(texels, level, work->cells[current].data());
  }

  // Nests a tile's last level once more, into its place in the coarse grid.
  void store(const CellWindow& texels, int level, const CellMoments<C>* cells) {
    const Grid fine = grid(texels.x1 - texels.x0, texels.y1 - texels.y0, level);
    const Grid next = grid(texels.x1 - texels.x0, texels.y1 - texels.y0, level + 1);
    const Grid corner = grid(texels.x0, texels.y0, level + 1);
    std::vector<CellMoments<C>> nested(static_cast<std::size_t>(next.width) * next.height);
    nest(cells, fine, next, nested.data());
    for (int y = 0; y < next.height; ++y) {
      std::copy_n(nested.data() + static_cast<std::ptrdiff_t>(y) * next.width, next.width,
                  coarse_.data() +
                      static_cast<std::ptrdiff_t>(corner.height + y) * coarse_grid_.width +
                      corner.width);
    }
  }

  void sweep_coarse() {
    const CellWindow whole{0, 0, image_.width, image_.height};
    for (int level = kTileLevels + 1; level <= options_.last_level; ++level) {
      visit(level, whole, coarse_.data(), tiles_.count());
      const Grid fine = grid(image_.width, image_.height, level);
      const Grid next = grid(image_.width, image_.height, level + 1);
      std::vector<CellMoments<C>> nested(static_cast<std::size_t>(next.width) * next.height);
      nest(coarse_.data(), fine, next, nested.data());
      coarse_ = std::move(nested);
    }
  }

  const TexelTriangles& triangles_;
  const ImageView& image_;
  WrapModes wrap_;
  SweepOptions options_;
  const Visit& visit_;
  const Progress& progress_;
  Tiles tiles_;
  WorkspacePool<C> pool_;
  Grid coarse_grid_;
  std::vector<CellMoments<C>> coarse_;  // half-texel cells of level kTileLevels + 1
};

}  // namespace

std::int64_t sweep_block_count(int width, int height) {
  const std::int64_t columns = (width + Tiles::kSize - 1) / Tiles::kSize;
  const std::int64_t rows = (height + Tiles::kSize - 1) / Tiles::kSize;
  return columns * rows + 1;
}

template <int C>
void sweep_moments(const TexelTriangles& triangles, const ImageView& image, WrapModes wrap,
                   const SweepOptions& options, const Progress& progress,
                   const std::function<void(const MomentBlock<C>&)>& visit) {
  assert(image.channels == C);
  assert(options.last_level < full_level_count(image.width, image.height));
  Sweep<C>(triangles, image, wrap, options, progress, visit).run();
}

template void sweep_moments<1>(const TexelTriangles&, const ImageView&, WrapModes,
                               const SweepOptions&, const Progress&,
                               const std::function<void(const MomentBlock<1>&)>&);
template void sweep_moments<2>(const TexelTriangles&, const ImageView&, WrapModes,
                               const SweepOptions&, const Progress&,
                               const std::function<void(const MomentBlock<2>&)>&);
template void sweep_moments<3>(const TexelTriangles&, const ImageView&, WrapModes,
                               const SweepOptions&, const Progress&,
                               const std::function<void(const MomentBlock<3>&)>&);
template void sweep_moments<4>(const TexelTriangles&, const ImageView&, WrapModes,
                               const SweepOptions&, const Progress&,
                               const std::function<void(const MomentBlock<4>&)>&);

}  // namespace prefilter
