// SPDX-License-Identifier: GPL-3.0-or-later

// Cuts triangles to texels, tile by tile (section 7.2).
#include "prefilter/geometry/texels/coverage.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/moments/axis_parts.h"
#include "prefilter/geometry/texels/tiles.h"

namespace prefilter {
namespace {

// Sums the surface's mass in the cells between the lines of a window.
class MassSink final : public CellSink {
 public:
  MassSink(const CellWindow& window, const AxisParts& x_parts, const AxisParts& y_parts,
           double uniform_density)
      : window_(window),
        x_parts_(x_parts),
        y_parts_(y_parts),
        masses_(static_cast<std::size_t>(x_parts.count()) * y_parts.count()) {
    if (uniform_density == 0.0) return;
    for (int y = window.y0; y < window.y1; ++y) add_full(y, window.x0, window.x1, uniform_density);
  }

  const double* row(int row) const { return masses_.data() + index(0, row); }

 private:
  std::ptrdiff_t index(int column, int row) const {
    return static_cast<std::ptrdiff_t>(row) * x_parts_.count() + column;
  }
  void add_full(int y, int x0, int x1, double density) override {
    const int rows_end = y_parts_.first_of(y - window_.y0 + 1);
    const int columns_end = x_parts_.first_of(x1 - window_.x0);
    for (int row = y_parts_.first_of(y - window_.y0); row < rows_end; ++row) {
      const double by_width = density * y_parts_.width(row);
      for (int column = x_parts_.first_of(x0 - window_.x0); column < columns_end; ++column) {
        masses_[index(column, row)] += by_width * x_parts_.width(column);
      }
    }
  }
  void add_piece(int x, int y, const CellPiece& piece) override {
    const int in_x = x - window_.x0;
    const int in_y = y - window_.y0;
    if (x_parts_.parts_of(in_x) == 1 && y_parts_.parts_of(in_y) == 1) {
      masses_[index(x_parts_.first_of(in_x), y_parts_.first_of(in_y))] += piece.mass();
      return;
    }
    y_parts_.cut(piece, 1, in_y, [&](int row, const CellPiece& strip) {
      x_parts_.cut(strip, 0, in_x, [&](int column, const CellPiece& part) {
        masses_[index(column, row)] += part.mass();
      });
    });
  }

  CellWindow window_;
  const AxisParts& x_parts_;
  const AxisParts& y_parts_;
  std::vector<double> masses_;
};

std::vector<double> whole_lines(int size) {
  std::vector<double> lines(static_cast<std::size_t>(size) + 1);
  std::iota(lines.begin(), lines.end(), 0.0);
  return lines;
}

// Indices of the lines at both ends of a window.
std::pair<int, int> lines_between(const std::vector<double>& lines, int low, int high) {
  const auto at = [&](int line) {
    return static_cast<int>(std::lower_bound(lines.begin(), lines.end(), line) - lines.begin());
  };
  return {at(low), at(high)};
}

}  // namespace

std::vector<float> cell_masses(const TexelTriangles& triangles, const std::vector<double>& x_lines,
                               const std::vector<double>& y_lines, const Run& run) {
  const Stages stages(run, {3, 7});
  const Tiles tiles(triangles, stages[0]);
  const std::size_t columns = x_lines.size() - 1;
  std::vector<float> masses(columns * (y_lines.size() - 1));
  parallel_for(tiles.count(), stages[1], [&](std::int64_t tile) {
    const CellWindow window = tiles.window(tile);
    const auto [x_first, x_last] = lines_between(x_lines, window.x0, window.x1);
    const auto [y_first, y_last] = lines_between(y_lines, window.y0, window.y1);
    const AxisParts x_parts(x_lines, x_first, x_last, 1.0);
    const AxisParts y_parts(y_lines, y_first, y_last, 1.0);
    MassSink sink(window, x_parts, y_parts, triangles.uniform_density);
    for (const std::uint32_t* k = tiles.begin(tile); k != tiles.end(tile); ++k) {
      cut_to_cells(triangles.triangles[*k], window, &sink);
    }
    for (int y = 0; y < y_parts.count(); ++y) {
      const double* row = sink.row(y);
      float* target = masses.data() + (y_first + y) * columns + x_first;
      for (int x = 0; x < x_parts.count(); ++x) target[x] = static_cast<float>(row[x]);
    }
  });
  return masses;
}

std::vector<float> texel_masses(const TexelTriangles& triangles, const Run& run) {
  return cell_masses(triangles, whole_lines(triangles.width), whole_lines(triangles.height), run);
}

std::vector<unsigned char> touched_texels(const std::vector<const Surface*>& surfaces, int width,
                                          int height, WrapModes wrap, const Run& run) {
  const Stages stages(run, {3, 7});
  const std::vector<float> masses = texel_masses(
      map_to_texels(surfaces, width, height, wrap, MassOf::kPresence, stages[0]), stages[1]);
  std::vector<unsigned char> touched(masses.size());
  for (std::size_t i = 0; i < masses.size(); ++i) touched[i] = masses[i] > 0.0F ? 1 : 0;
  return touched;
}

std::vector<unsigned char> looked_up_texels(const std::vector<const Surface*>& surfaces, int width,
                                            int height, WrapModes wrap, const Run& run) {
  const Stages stages(run, {3, 6, 1});
  const std::vector<float> halves = texel_masses(
      map_to_texels(surfaces, 2 * width, 2 * height, wrap, MassOf::kArea, stages[0]), stages[1]);
  // Between neighboring texel centers a lookup reads the texels on both sides. So texel i is read
  // from the half-texel cells 2 i - 1 to 2 i + 2.
  std::vector<unsigned char> read(static_cast<std::size_t>(width) * height);
  parallel_for(height, stages[2], [&](std::int64_t y) {
    std::vector<unsigned char> column_read(2 * static_cast<std::size_t>(width));
    for (int k = -1; k < 3; ++k) {
      const int row = wrap_index(2 * static_cast<int>(y) + k, 2 * height, wrap.v);
      if (row < 0) continue;
      const float* masses = halves.data() + static_cast<std::size_t>(row) * column_read.size();
      for (std::size_t i = 0; i < column_read.size(); ++i) {
        column_read[i] |= masses[i] > 0.0F ? 1 : 0;
      }
    }
    for (int x = 0; x < width; ++x) {
      for (int k = -1; k < 3; ++k) {
        const int column = wrap_index(2 * x + k, 2 * width, wrap.u);
        if (column >= 0) read[y * width + x] |= column_read[column];
      }
    }
  });
  return read;
}

}  // namespace prefilter
