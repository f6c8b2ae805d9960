// Section 7.3, least squares with the bilinear basis, one level by itself. A mass matrix that is
// scaled by its diagonal has a condition number of about 9 on whole texels, so a few Gauss-Seidel
// sweeps do; and a sweep that clamps each texel as it goes converges to the solution of the problem
// with bounds.
#include "prefilter/mipmap/bilinear_system.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// Levels of fewer texels are not worth a second thread.
constexpr std::int64_t kTexelsWorthThreads = 64 * 64;

// Integrals over one axis of a dual cell (between two texel centres) of the products of the two
// tents there, low x low, low x high and high x high, from the moments.
void tent_products(const double* moments, int stride, double* products) {
  const double m0 = moments[0];
  const double m1 = moments[stride];
  const double m2 = moments[2 * stride];
  products[0] = m0 - 2.0 * m1 + m2;
  products[1] = m1 - m2;
  products[2] = m2;
}

}  // namespace

template <int C>
BilinearSystem<C>::BilinearSystem(int width, int height, WrapModes wrap)
    : width_(width), height_(height), wrap_(wrap), stride_(width + 1) {
  const std::size_t count = static_cast<std::size_t>(stride_) * (height + 1);
  stencils_.resize(count);
  right_side_.resize(count);
  weights_.resize(count);
}

template <int C>
void BilinearSystem<C>::add(const MomentBlock<C>& block) {
  const CellPlace* x_places = block.x_places(block.level);
  const CellPlace* y_places = block.y_places(block.level);
  const auto run_end = [](const CellPlace* places, int begin, int end) {
    int i = begin + 1;
    while (i < end && places[i].texel == places[begin].texel) ++i;
    return i;
  };
  for (int y_begin = 0; y_begin < block.height;) {
    const int y_end = run_end(y_places, y_begin, block.height);
    for (int x_begin = 0; x_begin < block.width;) {
      const int x_end = run_end(x_places, x_begin, block.width);
      CellMoments<C> moments;
      for (int y = y_begin; y < y_end; ++y) {
        for (int x = x_begin; x < x_end; ++x) {
          const CellMoments<C>& cell = block.at(x, y);
          if (!cell.empty())
            add_child(cell, x_places[x].placement, y_places[y].placement, &moments);
        }
      }
      if (!moments.empty())
        add_dual_cell(moments, x_places[x_begin].texel, y_places[y_begin].texel);
      x_begin = x_end;
    }
    y_begin = y_end;
  }
}

template <int C>
void BilinearSystem<C>::add_dual_cell(const CellMoments<C>& moments, int column, int row) {
  double lines[9];
  double products[9];
  for (int b = 0; b < 3; ++b) tent_products(&moments.weight[3 * b], 1, lines + 3 * b);
  for (int a = 0; a < 3; ++a) {
    double along_y[3];
    tent_products(lines + a, 3, along_y);
    for (int b = 0; b < 3; ++b) products[3 * b + a] = along_y[b];
  }
  const auto product = [&](int in_y, int in_x) {
    return static_cast<float>(products[3 * in_y + in_x]);
  };

  const int x[2] = {wrap_index(column, width_, wrap_.u), wrap_index(column + 1, width_, wrap_.u)};
  const int y[2] = {wrap_index(row, height_, wrap_.v), wrap_index(row + 1, height_, wrap_.v)};
  // Both ends may be one texel: at a clamped edge, or where an axis has only one.
  const int dx = x[0] == x[1] ? 0 : 1;
  const int dy = y[0] == y[1] ? 0 : 1;

  for (int j = 0; j < 2; ++j) {
    if (y[j] < 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (x[i] < 0) continue;
      const std::ptrdiff_t texel = at(x[i], y[j]);
      stencils_[texel].centre += product(2 * j, 2 * i);
      const auto tent = [&](const auto& m, int row_stride) {
        const double low_x = i == 0 ? m[0] - m[1] : m[1];
        const double high_x = i == 0 ? m[row_stride] - m[row_stride + 1] : m[row_stride + 1];
        return static_cast<float>(j == 0 ? low_x - high_x : high_x);
      };
      weights_[texel] += tent(moments.weight, 3);
      for (int c = 0; c < C; ++c) right_side_[texel].v[c] += tent(moments.image[c], 2);
    }
    if (x[0] >= 0 && x[1] >= 0) add_pair(x[0], y[j], dx, 0, product(2 * j, 1));
  }
  if (y[0] < 0 || y[1] < 0) return;
  for (int i = 0; i < 2; ++i) {
    if (x[i] >= 0) add_pair(x[i], y[0], 0, dy, product(1, 2 * i));
  }
  if (x[0] < 0 || x[1] < 0) return;
  add_pair(x[0], y[0], dx, dy, product(1, 1));
  if (dy == 0) {
    add_pair(x[0], y[0], dx, 0, product(1, 1));
  } else {
    add_pair(x[1], y[0], -dx, dy, product(1, 1));
  }
}

template <int C>
void BilinearSystem<C>::add_pair(int x, int y, int dx, int dy, float value) {
  Stencil& stencil = stencils_[at(x, y)];
  if (dy == 0) {
    (dx == 0 ? stencil.centre : stencil.east) += dx == 0 ? 2.0F * value : value;
  } else if (dx == 0) {
    stencil.north += value;
  } else {
    (dx > 0 ? stencil.north_east : stencil.north_west) += value;
  }
}

template <int C>
void BilinearSystem<C>::pull_to_means() {
  double sum = 0.0;
  std::int64_t used = 0;
  for (const Stencil& stencil : stencils_) {
    if (!(stencil.centre > 0.0F)) continue;
    sum += stencil.centre;
    ++used;
  }
  const double pull = used > 0 ? kPull * sum / static_cast<double>(used) : 0.0;
  inverse_.assign(stencils_.size(), 0.0F);
  texels_.assign(stencils_.size(), LaneValues{});
  for (std::size_t j = 0; j < stencils_.size(); ++j) {
    if (!(stencils_[j].centre > 0.0F) || !(weights_[j] > 0.0F)) continue;
    inverse_[j] = static_cast<float>(1.0 / (stencils_[j].centre + pull));
    for (int c = 0; c < C; ++c) {
      const double mean = static_cast<double>(right_side_[j].v[c]) / weights_[j];
      texels_[j].v[c] = static_cast<float>(mean);
      right_side_[j].v[c] += static_cast<float>(pull * mean);
    }
  }
}

template <int C>
int BilinearSystem<C>::row_beside(int y, int step) const {
  const int beside = y + step;
  if (beside >= 0 && beside < height_) return beside;
  return wrap_.v == Wrap::kRepeat ? height_ - 1 - y : height_;
}

template <int C>
bool BilinearSystem<C>::relax_row(int y, const SolveOptions& options, Lanes typical) {
  // A little over-relaxation saves sweeps; from about 1.3 on it costs some.
  constexpr float kRelaxation = 1.15F;
  const int south_row = row_beside(y, -1);
  const int north_row = row_beside(y, 1);
  const Stencil* here = stencils_.data() + at(0, y);
  const Stencil* south = stencils_.data() + at(0, south_row);
  LaneValues* values = texels_.data() + at(0, y);
  const LaneValues* south_values = texels_.data() + at(0, south_row);
  const LaneValues* north_values = texels_.data() + at(0, north_row);
  const LaneValues* right_side = right_side_.data() + at(0, y);
  const float* inverse = inverse_.data() + at(0, y);

  // Open ranges are as wide as floats go, and not infinite: times an alpha of 0 they are 0.
  constexpr float kWidest = std::numeric_limits<float>::max();
  Lanes low{};
  Lanes high{};
  for (int c = 0; c < C; ++c) {
    low[c] = std::max(options.ranges[c].low, -kWidest);
    high[c] = std::min(options.ranges[c].high, kWidest);
  }
  const auto tolerance = static_cast<float>(options.tolerance);

  Lanes excess{};
  const auto relax = [&](int x, int west, int east) {
    const Lanes old = values[x].v;
    Lanes sum = right_side[x].v;
    sum -= here[x].east * values[east].v;
    sum -= here[x].north * north_values[x].v;
    sum -= south[x].north * south_values[x].v;
    sum -= here[x].north_east * north_values[east].v;
    sum -= south[west].north_east * south_values[west].v;
    sum -= here[x].north_west * north_values[west].v;
    sum -= south[east].north_west * south_values[east].v;
    sum -= here[west].east * values[west].v;
    const Lanes free = old + kRelaxation * (sum * inverse[x] - old);
    Lanes scale = Lanes{} + 1.0F;
    if (options.ranges_times_alpha) {
      scale = Lanes{} + std::clamp(free[3], low[3], high[3]);
      scale[3] = 1.0F;
    }
    const Lanes next = lane_min(lane_max(free, low * scale), high * scale);
    values[x].v = next;
    const Lanes step = lane_max(next - old, old - next);
    excess = lane_max(excess, step - tolerance * lane_max(typical, lane_max(next, -next)));
  };
  const bool repeat = wrap_.u == Wrap::kRepeat;
  const int pad = width_;
  if (width_ == 1) {
    relax(0, pad, pad);
  } else {
    relax(0, repeat ? width_ - 1 : pad, 1);
    for (int x = 1; x + 1 < width_; ++x) relax(x, x - 1, x + 1);
    relax(width_ - 1, width_ - 2, repeat ? 0 : pad);
  }
  bool moved = false;
  for (int c = 0; c < C; ++c) moved = moved || excess[c] > 0.0F;
  return moved;
}

template <int C>
Lanes BilinearSystem<C>::typical_values() const {
  std::array<std::vector<float>, C> row_means;
  for (int y = 0; y < height_; ++y) {
    Lanes sum{};
    float used = 0.0F;
    for (std::ptrdiff_t j = at(0, y); j < at(width_, y); ++j) {
      if (!(inverse_[j] > 0.0F)) continue;
      sum += lane_max(texels_[j].v, -texels_[j].v);
      used += 1.0F;
    }
    for (int c = 0; c < C && used > 0.0F; ++c) row_means[c].push_back(sum[c] / used);
  }
  Lanes typical{};
  for (int c = 0; c < C; ++c) {
    std::vector<float>& means = row_means[c];
    if (means.empty()) continue;
    const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
    std::nth_element(means.begin(), middle, means.end());
    typical[c] = *middle;
  }
  return typical;
}

template <int C>
auto BilinearSystem<C>::solve(const SolveOptions& options, const Progress& progress) -> Solution {
  pull_to_means();
  const Lanes typical = typical_values();

  // A row is relaxed while it or a row beside it still moves; the slot past the last row is for a
  // row that is not there. Rows of one colour, 0 and 1 in turn, are not beside each other, so they
  // can move at the same time; of an odd number that repeats, the last is beside the first, and
  // comes by itself.
  std::vector<unsigned char> moves(static_cast<std::size_t>(height_) + 1, 1);
  moves[height_] = 0;
  const auto relax = [&](int y) {
    if (moves[y] == 0 && moves[row_beside(y, -1)] == 0 && moves[row_beside(y, 1)] == 0) return;
    moves[y] = relax_row(y, options, typical) ? 1 : 0;
  };
  const bool odd_ring = wrap_.v == Wrap::kRepeat && height_ > 1 && height_ % 2 == 1;
  const std::int64_t rows_of_colour[2] = {(height_ + 1) / 2 - (odd_ring ? 1 : 0), height_ / 2};

  Solution solution;
  bool done = false;
  std::exception_ptr cancelled;
  const bool small = static_cast<std::int64_t>(width_) * height_ < kTexelsWorthThreads;
  parallel_team(small ? 1 : resolve_threads(options.threads), [&](Team& team) {
    while (!done) {
      for (int colour = 0; colour < 2; ++colour) {
        const std::int64_t end = team.share_end(rows_of_colour[colour]);
        for (std::int64_t i = team.share_begin(rows_of_colour[colour]); i < end; ++i) {
          relax(static_cast<int>(2 * i) + colour);
        }
        team.wait_for_all();
      }
      if (team.rank() == 0) {
        if (odd_ring) relax(height_ - 1);
        ++solution.sweeps;
        const bool settled = std::find(moves.begin(), moves.end(), 1) == moves.end();
        try {
          progress.report(static_cast<double>(solution.sweeps) / options.max_sweeps);
        } catch (...) {
          cancelled = std::current_exception();
        }
        done = settled || solution.sweeps >= options.max_sweeps || cancelled;
      }
      team.wait_for_all();
    }
  });
  if (cancelled) std::rethrow_exception(cancelled);

  solution.image = Image(width_, height_, C);
  solution.used.resize(solution.image.view().texel_count());
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::ptrdiff_t j = at(x, y);
      const bool used = inverse_[j] > 0.0F;
      solution.used[static_cast<std::size_t>(y) * width_ + x] = used ? 1 : 0;
      for (int c = 0; c < C && used; ++c) solution.image.texel(x, y)[c] = texels_[j].v[c];
    }
  }
  return solution;
}

template class BilinearSystem<1>;
template class BilinearSystem<2>;
template class BilinearSystem<3>;
template class BilinearSystem<4>;

}  // namespace prefilter
