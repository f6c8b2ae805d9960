// SPDX-License-Identifier: GPL-3.0-or-later

// Section 7.3: the off-diagonal blocks A_l,l+1, integrated cell by cell from moments.
#include "prefilter/textures/mipmap/level_coupling.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// The product of two linear functions f and g of a cell's coordinate x, as coefficients of 1, x and
// x^2.
std::array<double, 3> product(const std::array<double, 2>& f, const std::array<double, 2>& g) {
  return {f[0] * g[0], f[0] * g[1] + f[1] * g[0], f[1] * g[1]};
}

// The tents of the texels on the low and high side of a cell, as constant and slope.
std::array<std::array<double, 2>, 2> tents(const Placement& place) {
  return {{{1.0 - place.offset, -place.scale}, {place.offset, place.scale}}};
}

constexpr int kCoupledRowsPerTask = 32;

}  // namespace

int LevelCoupling::Axis::first(int texel) const {
  // The texel's tent starts at the center of the preceding texel.
  const double begin = (texel - 0.5) * next_size / size - 0.5;
  return static_cast<int>(std::floor(begin + 1e-9));
}

int LevelCoupling::Axis::slot(int low, int high, int next, int* texel) const {
  const int unwrapped = low + high;
  *texel = wrap_index(unwrapped, size, wrap);
  return next - first(wrap == Wrap::kRepeat ? unwrapped : *texel);
}

std::vector<LevelCoupling::Triple> LevelCoupling::Axis::next_texels() const {
  std::vector<Triple> triples(size);
  for (int texel = 0; texel < size; ++texel) {
    for (int k = 0; k < 3; ++k) {
      const int next = wrap_index(first(texel) + k, next_size, wrap);
      // Index next_size has zero entries in NinePointSystem.
      triples[texel][k] = next >= 0 ? next : next_size;
    }
  }
  return triples;
}

LevelCoupling::LevelCoupling(int width, int height, int next_width, int next_height, WrapModes wrap)
    : x_{width, next_width, wrap.u},
      y_{height, next_height, wrap.v},
      columns_(x_.next_texels()),
      rows_(y_.next_texels()),
      products_(static_cast<std::size_t>(width) * height) {}

std::vector<LevelCoupling::Overlap> LevelCoupling::overlaps(const Axis& axis,
                                                            const CellPlace* places,
                                                            const CellPlace* next_places,
                                                            int count) {
  std::vector<Overlap> found(static_cast<std::size_t>(count));
  for (int at = 0; at < count; ++at) {
    const auto fine = tents(places[at].placement);
    const auto coarse = tents(next_places[at].placement);
    auto& [texels, slots, products] = found[at];
    for (int i = 0; i < 4; ++i) {
      slots[i] = axis.slot(places[at].texel, i % 2, next_places[at].texel + i / 2, &texels[i % 2]);
      products[i] = product(fine[i % 2], coarse[i / 2]);
      assert(texels[i % 2] < 0 || (slots[i] >= 0 && slots[i] < 3));
    }
  }
  return found;
}

template <int C>
void LevelCoupling::add(const MomentBlock<C>& block) {
  const int next = block.level + 1;
  const std::vector<Overlap> columns =
      overlaps(x_, block.x_places(block.level), block.x_places(next), block.width);
  const std::vector<Overlap> rows =
      overlaps(y_, block.y_places(block.level), block.y_places(next), block.height);
  for (int y = 0; y < block.height; ++y) {
    const Overlap& in_y = rows[y];
    for (int x = 0; x < block.width; ++x) {
      const CellMoments<C>& cell = block.at(x, y);
      if (cell.empty()) continue;
      const Overlap& in_x = columns[x];
      for (int k = 0; k < 4; ++k) {
        const int row = in_y.texels[k % 2];
        if (row < 0) continue;
        // Row of moments, summed over y with this pair of tents along y.
        const std::array<double, 3>& along_y = in_y.products[k];
        double line[3];
        for (int a = 0; a < 3; ++a) {
          line[a] = along_y[0] * cell.weight[a] + along_y[1] * cell.weight[3 + a] +
                    along_y[2] * cell.weight[6 + a];
        }
        std::array<float, 9>* texels =
            products_.data() + static_cast<std::ptrdiff_t>(row) * x_.size;
        for (int i = 0; i < 4; ++i) {
          const int column = in_x.texels[i % 2];
          if (column < 0) continue;
          const std::array<double, 3>& along_x = in_x.products[i];
          const double value = along_x[0] * line[0] + along_x[1] * line[1] + along_x[2] * line[2];
          texels[column][3 * in_y.slots[k] + in_x.slots[i]] += static_cast<float>(value);
        }
      }
    }
  }
}

void LevelCoupling::subtract_coarse(const NinePointSystem<float>& fine,
                                    const NinePointSystem<float>& coarse, float scale, int threads,
                                    std::vector<LaneValues>* sums) const {
  parallel_for(y_.size, Run(threads), [&](std::int64_t row) {
    const std::array<float, 9>* products = products_.data() + row * x_.size;
    LaneValues* row_sums = sums->data() + fine.at(0, static_cast<int>(row));
    const LaneValues* texels[3];
    for (int k = 0; k < 3; ++k) texels[k] = &coarse.texel(coarse.at(0, rows_[row][k]));
    for (int x = 0; x < x_.size; ++x) {
      Lanes sum{};
      for (int k = 0; k < 9; ++k) sum += products[x][k] * texels[k / 3][columns_[x][k % 3]].v;
      row_sums[x].v -= scale * sum;
    }
  });
}

template <typename Texel>
void LevelCoupling::add_fine_texels(const Texel& texel, const NinePointSystem<float>& coarse,
                                    const Run& run, std::vector<LaneValues>* sums) const {
  // Each band of the next level's rows gathers its contributions in the order of the finer rows.
  parallel_ranges(y_.next_size, kCoupledRowsPerTask, run, [&](int begin, int end) {
    for (int y = 0; y < y_.size; ++y) {
      for (int slot = 0; slot < 3; ++slot) {
        const int row = rows_[y][slot];
        if (row < begin || row >= end) continue;
        const std::array<float, 9>* products =
            products_.data() + static_cast<std::ptrdiff_t>(y) * x_.size;
        LaneValues* row_sums = sums->data() + coarse.at(0, row);
        for (int x = 0; x < x_.size; ++x) {
          const Lanes value = texel(x, y);
          for (int k = 0; k < 3; ++k) {
            row_sums[columns_[x][k]].v += products[x][3 * slot + k] * value;
          }
        }
      }
    }
  });
}

void LevelCoupling::subtract_fine(const NinePointSystem<float>& fine,
                                  const NinePointSystem<float>& coarse, float scale, int threads,
                                  std::vector<LaneValues>* sums) const {
  const auto texel = [&](int x, int y) { return -scale * fine.texel(fine.at(x, y)).v; };
  add_fine_texels(texel, coarse, Run(threads), sums);
}

void LevelCoupling::add_fine(const Image& image, const NinePointSystem<float>& coarse,
                             const Run& run, std::vector<LaneValues>* sums) const {
  const auto texel = [&](int x, int y) {
    const float* values = image.view().texel(x, y);
    Lanes lanes{};
    for (int c = 0; c < image.channels; ++c) lanes[c] = values[c];
    return lanes;
  };
  add_fine_texels(texel, coarse, run, sums);
}

template void LevelCoupling::add<1>(const MomentBlock<1>&);
template void LevelCoupling::add<2>(const MomentBlock<2>&);
template void LevelCoupling::add<3>(const MomentBlock<3>&);
template void LevelCoupling::add<4>(const MomentBlock<4>&);

}  // namespace prefilter
