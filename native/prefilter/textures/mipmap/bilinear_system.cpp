// SPDX-License-Identifier: GPL-3.0-or-later

// Section 7.3: least squares with the bilinear basis, for one level independently of the others.
#include "prefilter/textures/mipmap/bilinear_system.h"

#include <algorithm>

namespace prefilter {
namespace {

constexpr std::ptrdiff_t kTexelsPerReport = 1 << 16;

// Integrals along one axis of a dual cell (between two texel centers) of the products of its two
// tents: low x low, low x high and high x high. Computed from the moments.
void tent_products(const double* moments, int stride, double* products) {
  const double m0 = moments[0];
  const double m1 = moments[stride];
  const double m2 = moments[2 * stride];
  products[0] = m0 - 2.0 * m1 + m2;
  products[1] = m1 - m2;
  products[2] = m2;
}

// Integral over a cell of the function with these moments times the tent that is 1 at corner (i,
// j).
template <typename Moments>
float tent_integral(const Moments& m, int row_stride, int i, int j) {
  const double low_x = i == 0 ? m[0] - m[1] : m[1];
  const double high_x = i == 0 ? m[row_stride] - m[row_stride + 1] : m[row_stride + 1];
  return static_cast<float>(j == 0 ? low_x - high_x : high_x);
}

// Integrals over a cell of the image times each of its tents.
template <std::size_t C>
NinePointSystem<float>::TentIntegrals tent_integrals(const std::array<ImageMoments, C>& moments) {
  NinePointSystem<float>::TentIntegrals integrals{};
  for (int k = 0; k < 4; ++k) {
    for (std::size_t c = 0; c < C; ++c) {
      integrals[k].v[static_cast<int>(c)] = tent_integral(moments[c], 2, k % 2, k / 2);
    }
  }
  return integrals;
}

}  // namespace

TargetShares target_shares(double footprint) {
  const double variance = footprint * footprint;
  if (variance <= 1.0) return {1.0 - variance, variance, 0.0};
  const double own = (variance - 1.0) / 3.0;
  return {0.0, 1.0 - own, own};
}

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
  for (int k = 0; k < 4; ++k) {
    const std::ptrdiff_t texel = corner(column, row, k);
    if (texel >= 0) weights_[texel] += tent_integral(moments.weight, 3, k % 2, k / 2);
  }
  system_.add_cell(column, row, products, tent_integrals(moments.image));
}

template <int C>
std::ptrdiff_t BilinearSystem<C>::corner(int column, int row, int k) const {
  const int x = wrap_index(column + k % 2, system_.width(), wrap_.u);
  const int y = wrap_index(row + k / 2, system_.height(), wrap_.v);
  return x >= 0 && y >= 0 ? system_.at(x, y) : -1;
}

template <int C>
void BilinearSystem<C>::add_finer_means(const MomentBlock<C>& block) {
  for_each_dual_cell_of_means(block, [this](const auto& moments, int column, int row) {
    const NinePointSystem<float>::TentIntegrals integrals = tent_integrals(moments);
    for (int k = 0; k < 4; ++k) {
      const std::ptrdiff_t texel = corner(column, row, k);
      if (texel >= 0) finer_means_[texel].v += integrals[k].v;
    }
  });
}

template <int C>
Image BilinearSystem<C>::means() const {
  Image means(system_.width(), system_.height(), C);
  for (int y = 0; y < system_.height(); ++y) {
    for (int x = 0; x < system_.width(); ++x) {
      const std::ptrdiff_t j = system_.at(x, y);
      if (!(weights_[j] > 0.0F)) continue;
      for (int c = 0; c < C; ++c) means.texel(x, y)[c] = system_.right_side(j).v[c] / weights_[j];
    }
  }
  return means;
}

template <int C>
void BilinearSystem<C>::add_links(const std::vector<SeamLink>& links, double texels_by_area,
                                  const Run& run) {
  const auto is_part = [this](std::ptrdiff_t j) {
    return system_.diagonal(j) > 0.0F && weights_[j] > 0.0F;
  };
  links_ = LinkForm(texel_links(links, system_, texels_by_area), is_part, run);
}

template <int C>
void BilinearSystem<C>::start_at_means(const Run& run) {
  double sum = 0.0;
  std::int64_t used = 0;
  const auto size = static_cast<std::ptrdiff_t>(system_.size());
  for (std::ptrdiff_t j = 0; j < size; ++j) {
    if (!(system_.diagonal(j) > 0.0F)) continue;
    sum += system_.diagonal(j);
    ++used;
  }
  regularization_ =
      static_cast<float>(used > 0 ? kRegularization * sum / static_cast<double>(used) : 0.0);
  system_.make_texels();
  for (std::ptrdiff_t j = 0; j < size; ++j) {
    if (j % kTexelsPerReport == 0) run.report(0.0);
    if (!(system_.diagonal(j) > 0.0F) || !(weights_[j] > 0.0F)) {
      system_.diagonal(j) = 0.0F;
      continue;
    }
    for (int c = 0; c < C; ++c) {
      const double mean = static_cast<double>(system_.right_side(j).v[c]) / weights_[j];
      system_.texel(j).v[c] = static_cast<float>(mean);
    }
  }
}

template <int C>
ChannelSums BilinearSystem<C>::square_of_target(const TargetShares& target,
                                                const ChannelSums& own_finer) const {
  const auto& [image, finer, own] = target;
  ChannelSums sums{};
  for (int c = 0; c < C; ++c) {
    sums[c] = image * image * squares_.image[c] + finer * finer * squares_.means[c] +
              own * own * own_squares_.means[c] +
              2.0 * (image * finer * squares_.image_means[c] +
                     image * own * own_squares_.image_means[c] + own * finer * own_finer[c]);
  }
  return sums;
}

template <int C>
void BilinearSystem<C>::prepare(const TargetShares& target, const EquationShares& shares,
                                const Run& run) {
  start_at_means(run);
  const auto image_share = static_cast<float>(target.image);
  const auto finer_share = static_cast<float>(target.finer_means);
  const auto own_share = static_cast<float>(target.own_means);
  const auto times = static_cast<float>(shares.times);
  const auto known = static_cast<float>(shares.known);
  const bool has_squares = has_links() && target.image != 1.0;
  std::vector<LaneValues> own_means;
  if (own_share != 0.0F || has_squares) own_means = system_.product();
  if (has_links()) target_.resize(system_.size());
  ChannelSums own_finer{};
  const auto size = static_cast<std::ptrdiff_t>(system_.size());
  for (std::ptrdiff_t j = 0; j < size; ++j) {
    if (j % kTexelsPerReport == 0) run.report(0.0);
    if (!(system_.diagonal(j) > 0.0F)) continue;
    const Lanes image = system_.right_side(j).v;
    const Lanes mean = system_.texel(j).v;
    Lanes right = image_share * image;
    if (finer_share != 0.0F) right += finer_share * finer_means_[j].v;
    if (own_share != 0.0F) right += own_share * own_means[j].v;
    if (has_links()) target_[j].v = right;
    for (int c = 0; c < C && has_squares; ++c) {
      own_squares_.means[c] += static_cast<double>(own_means[j].v[c]) * mean[c];
      own_squares_.image_means[c] += static_cast<double>(image[c]) * mean[c];
      own_finer[c] += static_cast<double>(finer_means_[j].v[c]) * mean[c];
    }
    system_.right_side(j).v = times * (right - known * image) + regularization_ * mean;
    system_.diagonal(j) += regularization_;
  }
  if (has_links()) target_square_ = square_of_target(target, own_finer);
  own_squares_.image = squares_.image;
  std::vector<LaneValues>().swap(finer_means_);
  std::vector<float>().swap(weights_);
  run.report(0.0);
  system_.invert_diagonal();
}

template <int C>
int BilinearSystem<C>::linked_sweeps() const {
  constexpr double kTexelSweeps = 1 << 18;
  constexpr int kMinSweeps = 12;
  constexpr int kMaxSweeps = 200;
  const auto steps = static_cast<double>(system_.size() + links_.entry_count());
  return static_cast<int>(std::clamp<double>(kTexelSweeps / steps, kMinSweeps, kMaxSweeps));
}

template <int C>
double BilinearSystem<C>::target_square(int first_channel) const {
  double sum = 0.0;
  for (int c = first_channel; c < C; ++c) sum += target_square_[c];
  return sum;
}

template <int C>
double BilinearSystem<C>::squared_error(int first_channel, int threads) const {
  const ChannelSums form = system_.form(target_, regularization_, threads);
  double sum = target_square(first_channel);
  for (int c = first_channel; c < C; ++c) sum += form[c];
  return sum;
}

template <int C>
auto BilinearSystem<C>::solve(const TargetShares& target, const SolveOptions& options,
                              SeamBudget* budget, const Run& run) -> Solution {
  prepare(target, {}, run);
  const Stages stages(run, {3, 7});
  int sweeps = system_.solve(options, has_links() ? stages[0] : run);
  if (has_links()) {
    const int first = budget->first_channel;
    SolveOptions linked = options;
    linked.max_sweeps = linked_sweeps();
    const LinkedFit fit{[&](double weight, const Run& part) {
                          weigh_links(weight);
                          sweeps += system_.solve(linked, part);
                        },
                        [&] { return squared_error(first, run.threads()); }};
    fit_within(target_square(first), fit, stages[1], &system_, budget);
  }
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
