// Section 7.3, least squares with the bilinear basis, one level by itself.
#include "prefilter/mipmap/bilinear_system.h"

#include <algorithm>

namespace prefilter {
namespace {

constexpr std::ptrdiff_t kTexelsPerReport = 1 << 16;

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
    : wrap_(wrap), system_(width, height, wrap), weights_(system_.size()) {}

template <int C>
void BilinearSystem<C>::add(const MomentBlock<C>& block) {
  for_each_dual_cell(block, [this](const CellMoments<C>& moments, int column, int row) {
    add_dual_cell(moments, column, row);
  });
}

template <int C>
void BilinearSystem<C>::add_dual_cell(const CellMoments<C>& moments, int column, int row) {
  double lines[9];
  NinePointSystem<float>::TentProducts products;
  for (int b = 0; b < 3; ++b) tent_products(&moments.weight[3 * b], 1, lines + 3 * b);
  for (int a = 0; a < 3; ++a) {
    double along_y[3];
    tent_products(lines + a, 3, along_y);
    for (int b = 0; b < 3; ++b) products[3 * b + a] = static_cast<float>(along_y[b]);
  }
  NinePointSystem<float>::TentIntegrals right{};
  for (int k = 0; k < 4; ++k) {
    const int i = k % 2;
    const int j = k / 2;
    const auto tent = [&](const auto& m, int row_stride) {
      const double low_x = i == 0 ? m[0] - m[1] : m[1];
      const double high_x = i == 0 ? m[row_stride] - m[row_stride + 1] : m[row_stride + 1];
      return static_cast<float>(j == 0 ? low_x - high_x : high_x);
    };
    for (int c = 0; c < C; ++c) right[k].v[c] = tent(moments.image[c], 2);
    const int x = wrap_index(column + i, system_.width(), wrap_.u);
    const int y = wrap_index(row + j, system_.height(), wrap_.v);
    if (x >= 0 && y >= 0) weights_[system_.at(x, y)] += tent(moments.weight, 3);
  }
  system_.add_cell(column, row, products, right);
}

template <int C>
void BilinearSystem<C>::add_links(const std::vector<SeamLink>& links, double weight) {
  links_ = texel_links(links, system_, weight);
}

template <int C>
void BilinearSystem<C>::prepare(float image_share, const Progress& progress) {
  double sum = 0.0;
  std::int64_t used = 0;
  const auto size = static_cast<std::ptrdiff_t>(system_.size());
  for (std::ptrdiff_t j = 0; j < size; ++j) {
    if (!(system_.diagonal(j) > 0.0F)) continue;
    sum += system_.diagonal(j);
    ++used;
  }
  const double pull = used > 0 ? kPull * sum / static_cast<double>(used) : 0.0;
  system_.make_texels();
  for (std::ptrdiff_t j = 0; j < size; ++j) {
    if (j % kTexelsPerReport == 0) progress.report(0.0);
    if (!(system_.diagonal(j) > 0.0F) || !(weights_[j] > 0.0F)) {
      system_.diagonal(j) = 0.0F;
      continue;
    }
    system_.diagonal(j) += static_cast<float>(pull);
    for (int c = 0; c < C; ++c) {
      const double mean = static_cast<double>(system_.right_side(j).v[c]) / weights_[j];
      system_.texel(j).v[c] = static_cast<float>(mean);
      system_.right_side(j).v[c] =
          image_share * system_.right_side(j).v[c] + static_cast<float>(pull * mean);
    }
  }
  std::vector<float>().swap(weights_);
  system_.add_links(std::move(links_), progress);
  progress.report(0.0);
  system_.invert_diagonal();
}

template <int C>
auto BilinearSystem<C>::solve(const SolveOptions& options, const Progress& progress) -> Solution {
  prepare(1.0F, progress);
  const int sweeps = system_.solve(options, progress);
  Solution solution = take_solution();
  solution.sweeps = sweeps;
  return solution;
}

template <int C>
auto BilinearSystem<C>::take_solution() -> Solution {
  Solution solution;
  for (int y = 0; y < system_.height(); ++y) {
    for (int x = 0; x < system_.width(); ++x) {
      solution.used.push_back(system_.is_part(system_.at(x, y)) ? 1 : 0);
    }
  }
  solution.image = system_.take_image(C);
  return solution;
}

template class BilinearSystem<1>;
template class BilinearSystem<2>;
template class BilinearSystem<3>;
template class BilinearSystem<4>;

}  // namespace prefilter
