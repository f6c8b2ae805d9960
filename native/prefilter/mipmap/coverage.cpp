#include "prefilter/mipmap/coverage.h"

#include "prefilter/mipmap/tiles.h"

namespace prefilter {
namespace {

class MassSink final : public CellSink {
 public:
  MassSink(const CellWindow& window, double initial)
      : window_(window),
        width_(window.x1 - window.x0),
        masses_(static_cast<std::size_t>(width_) * (window.y1 - window.y0), initial) {}

  const double* row(int y) const { return masses_.data() + index(window_.x0, y); }

 private:
  std::ptrdiff_t index(int x, int y) const {
    return static_cast<std::ptrdiff_t>(y - window_.y0) * width_ + x - window_.x0;
  }
  void add_full(int y, int x0, int x1, double density) override {
    for (int x = x0; x < x1; ++x) masses_[index(x, y)] += density;
  }
  void add_piece(int x, int y, const CellPiece& piece) override {
    masses_[index(x, y)] += piece.mass();
  }

  CellWindow window_;
  int width_;
  std::vector<double> masses_;
};

}  // namespace

std::vector<float> texel_masses(const TexelTriangles& triangles, const Progress& progress,
                                int threads) {
  const Tiles tiles(triangles, progress.part(0.0, 0.3));
  std::vector<float> masses(static_cast<std::size_t>(triangles.width) * triangles.height);
  parallel_for(tiles.count(), threads, progress.part(0.3, 1.0), [&](std::int64_t tile) {
    const CellWindow window = tiles.window(tile);
    MassSink sink(window, triangles.uniform_density);
    for (const std::uint32_t* k = tiles.begin(tile); k != tiles.end(tile); ++k) {
      cut_to_cells(triangles.triangles[*k], window, &sink);
    }
    for (int y = window.y0; y < window.y1; ++y) {
      const double* row = sink.row(y);
      float* target = masses.data() + static_cast<std::ptrdiff_t>(y) * triangles.width + window.x0;
      for (int x = 0; x < window.x1 - window.x0; ++x) target[x] = static_cast<float>(row[x]);
    }
  });
  return masses;
}

std::vector<unsigned char> touched_texels(const std::vector<const Surface*>& surfaces, int width,
                                          int height, WrapModes wrap, const Progress& progress,
                                          int threads) {
  const std::vector<float> masses = texel_masses(
      map_to_texels(surfaces, width, height, wrap, MassOf::kPresence, progress.part(0.0, 0.3)),
      progress.part(0.3, 1.0), threads);
  std::vector<unsigned char> touched(masses.size());
  for (std::size_t i = 0; i < masses.size(); ++i) touched[i] = masses[i] > 0.0F ? 1 : 0;
  return touched;
}

std::vector<unsigned char> looked_up_texels(const std::vector<const Surface*>& surfaces, int width,
                                            int height, WrapModes wrap, const Progress& progress,
                                            int threads) {
  // A half-texel cell is read through the two texels beside it along each axis.
  const std::vector<float> halves = texel_masses(
      map_to_texels(surfaces, 2 * width, 2 * height, wrap, MassOf::kArea, progress.part(0.0, 0.3)),
      progress.part(0.3, 1.0), threads);
  std::vector<unsigned char> read(static_cast<std::size_t>(width) * height);
  for (int hy = 0; hy < 2 * height; ++hy) {
    for (int hx = 0; hx < 2 * width; ++hx) {
      if (!(halves[static_cast<std::size_t>(hy) * 2 * width + hx] > 0.0F)) continue;
      const int first_x = (hx + 1) / 2 - 1;
      const int first_y = (hy + 1) / 2 - 1;
      for (int dy = 0; dy < 2; ++dy) {
        for (int dx = 0; dx < 2; ++dx) {
          const int x = wrap_index(first_x + dx, width, wrap.u);
          const int y = wrap_index(first_y + dy, height, wrap.v);
          if (x >= 0 && y >= 0) read[static_cast<std::size_t>(y) * width + x] = 1;
        }
      }
    }
  }
  return read;
}

}  // namespace prefilter
