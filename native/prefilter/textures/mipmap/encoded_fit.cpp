// SPDX-License-Identifier: GPL-3.0-or-later

// Section 7.3 for a nonlinear reader: the residual is decode(sum_j b_j t_j) - I, with the Jacobian
// b_j decode'. Solved by bounded Gauss-Newton iterations with step halving per channel.
#include "prefilter/textures/mipmap/encoded_fit.h"

#include <algorithm>
#include <cmath>

#include "prefilter/base/parallel.h"
#include "prefilter/geometry/moments/four_point_rule.h"
#include "prefilter/geometry/texels/tiles.h"
#include "prefilter/images/srgb_decoder.h"

namespace prefilter {
namespace {

constexpr int kMaxGaussNewtonRounds = 10;
// Iterations end once no channel's sum of squares falls by more than this share of its total
// decrease.
constexpr double kMinRelativeGain = 1e-3;
constexpr int kSweepsPerRound = 20;

}  // namespace

template <int C>
EncodedFit<C>::EncodedFit(int width, int height, int image_width, int image_height, WrapModes wrap)
    : wrap_(wrap),
      image_height_(image_height),
      tile_columns_((image_width + Tiles::kSize - 1) / Tiles::kSize),
      tile_rows_((image_height + Tiles::kSize - 1) / Tiles::kSize),
      system_(width, height, wrap),
      cells_(static_cast<std::size_t>(sweep_block_count(image_width, image_height))) {}

template <int C>
void EncodedFit<C>::add(const MomentBlock<C>& block) {
  std::vector<Cell>& cells = cells_[block.index];
  for_each_dual_cell(block, [&](const CellMoments<C>& moments, int column, int row) {
    const FourPointRule rule(moments.weight);
    Cell cell;
    cell.column = column;
    cell.row = row;
    for (int k = 0; k < 2; ++k) {
      cell.x[k] = static_cast<float>(rule.x(k));
      cell.y[k] = static_cast<float>(rule.y(2 * k));
    }
    cell.same = static_cast<float>(rule.same);
    cell.opposite = static_cast<float>(rule.opposite);
    for (int c = 0; c < kColors; ++c) {
      const std::array<double, 4> integrals = rule.integrals(moments.image[c]);
      for (int k = 0; k < 4; ++k) cell.image[k][c] = static_cast<float>(integrals[k]);
    }
    cells.push_back(cell);
  });
  cells.shrink_to_fit();
}

template <int C>
auto EncodedFit<C>::assemble(const std::vector<Cell>& cells) -> Sums {
  const SrgbDecoder& decode = SrgbDecoder::instance();
  Sums sums;
  for (const Cell& cell : cells) {
    Lanes corners[4];
    for (int k = 0; k < 4; ++k) {
      const int x = wrap_index(cell.column + k % 2, system_.width(), wrap_.u);
      const int y = wrap_index(cell.row + k / 2, system_.height(), wrap_.v);
      corners[k] = x < 0 || y < 0 ? Lanes{} : system_.texel(system_.at(x, y)).v;
    }
    typename NinePointSystem<LaneValues>::TentProducts products{};
    typename NinePointSystem<LaneValues>::TentIntegrals right{};
    for (int k = 0; k < 4; ++k) {
      const float x = cell.x[k % 2];
      const float y = cell.y[k / 2];
      const float tents[4] = {(1.0F - x) * (1.0F - y), x * (1.0F - y), (1.0F - x) * y, x * y};
      const Lanes encoded = tents[0] * corners[0] + tents[1] * corners[1] + tents[2] * corners[2] +
                            tents[3] * corners[3];
      const float weight = k == 0 || k == 3 ? cell.same : cell.opposite;
      sums.mass += weight;
      Lanes squares{};
      Lanes target{};
      for (int c = 0; c < kColors; ++c) {
        const auto [value, slope] = decode(encoded[c]);
        const float image = cell.image[k][c];
        squares[c] = weight * slope * slope;
        target[c] = slope * (image - weight * value) + squares[c] * encoded[c];
        sums.squares[c] += static_cast<double>(value) * (weight * value - 2.0F * image);
        sums.slopes[c] += squares[c];
      }
      const float along_x[3] = {(1.0F - x) * (1.0F - x), x * (1.0F - x), x * x};
      const float along_y[3] = {(1.0F - y) * (1.0F - y), y * (1.0F - y), y * y};
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) products[3 * j + i].v += along_y[j] * along_x[i] * squares;
      }
      for (int i = 0; i < 4; ++i) right[i].v += tents[i] * target;
    }
    system_.add_cell(cell.column, cell.row, products, right);
  }
  return sums;
}

template <int C>
auto EncodedFit<C>::assemble(const Run& run) -> ColorSums {
  system_.clear();
  std::vector<Sums> sums(cells_.size());
  // Rows of tiles that are not adjacent share no texels.
  for (int color = 0; color < kTileColors; ++color) {
    std::vector<int> rows;
    for (int row = 0; row < tile_rows_; ++row) {
      if (tile_color(row, tile_rows_, image_height_) == color) rows.push_back(row);
    }
    const Run part = run.part(static_cast<double>(color) / kTileColors,
                              static_cast<double>(color + 1) / kTileColors);
    parallel_for(static_cast<std::int64_t>(rows.size()), part, [&](std::int64_t i) {
      const std::size_t first = static_cast<std::size_t>(rows[i]) * tile_columns_;
      for (std::size_t tile = first; tile < first + tile_columns_; ++tile) {
        sums[tile] = assemble(cells_[tile]);
      }
    });
  }
  sums.back() = assemble(cells_.back());
  Sums total;
  for (const Sums& sum : sums) {
    total.mass += sum.mass;
    for (int c = 0; c < kColors; ++c) {
      total.squares[c] += sum.squares[c];
      total.slopes[c] += sum.slopes[c];
    }
  }
  if (!has_slopes_) {
    for (int c = 0; c < kColors; ++c) mean_slopes_[c] = total.slopes[c] / total.mass;
    has_slopes_ = true;
  }
  return total.squares;
}

template <int C>
Lanes EncodedFit<C>::link_weights(double weight) const {
  Lanes weights{};
  for (int c = 0; c < kColors; ++c) weights[c] = static_cast<float>(weight * mean_slopes_[c]);
  return weights;
}

template <int C>
auto EncodedFit<C>::link_squares(double weight) const -> ColorSums {
  const ChannelSums squares =
      links_.value([this](std::ptrdiff_t at) -> const LaneValues& { return system_.texel(at); });
  ColorSums weighed{};
  for (int c = 0; c < kColors; ++c) weighed[c] = weight * mean_slopes_[c] * squares[c];
  return weighed;
}

template <int C>
void EncodedFit<C>::add_links(const std::vector<SeamLink>& links, double texels_by_area,
                              const ChannelSums& squares) {
  all_links_ = texel_links(links, system_, texels_by_area);
  image_squares_ = squares;
}

template <int C>
Image EncodedFit<C>::solve(const Image& start, const std::vector<unsigned char>& used,
                           const SolveOptions& options, SeamBudget* budget, const Run& run) {
  system_.make_texels();
  for (int y = 0; y < system_.height(); ++y) {
    for (int x = 0; x < system_.width(); ++x) {
      if (used[static_cast<std::size_t>(y) * system_.width() + x] == 0) continue;
      for (int c = 0; c < C; ++c) system_.texel(system_.at(x, y)).v[c] = start.texel(x, y)[c];
    }
  }
  if (!all_links_.empty()) {
    std::vector<unsigned char> is_used(system_.size());
    for (int y = 0; y < system_.height(); ++y) {
      for (int x = 0; x < system_.width(); ++x) {
        is_used[system_.at(x, y)] = used[static_cast<std::size_t>(y) * system_.width() + x];
      }
    }
    links_ = LinkForm(
        all_links_, [&](std::ptrdiff_t at) { return is_used[at] != 0; }, run.part(0.0, 0.0));
    std::vector<TexelLink>().swap(all_links_);
  }
  const bool searches = !links_.empty();
  iterate(start, used, 0.0, options, searches ? run.part(0.0, 0.3) : run);
  if (searches) {
    const Run part = run.part(0.3, 0.3);
    double square = 0.0;
    for (int c = 0; c < kColors; ++c) square += image_squares_[c];
    const LinkedFit fit{
        [&](double weight, const Run& fitting) { iterate(start, used, weight, options, fitting); },
        [&] {
          double sum = square;
          for (const double of_channel : assemble(part)) {
            sum += of_channel;
          }
          return sum;
        }};
    fit_within(square, fit, run.part(0.3, 1.0), &system_, budget);
  }
  return system_.take_image(C);
}

template <int C>
auto EncodedFit<C>::sums_with_links(double weight, const Run& run) -> ColorSums {
  ColorSums sums = assemble(run);
  if (weight == 0.0) return sums;
  const ColorSums of_links = link_squares(weight);
  for (int c = 0; c < kColors; ++c) sums[c] += of_links[c];
  return sums;
}

template <int C>
auto EncodedFit<C>::backtrack(const std::vector<LaneValues>& before, const ColorSums& least,
                              double weight, const Run& run, ColorSums sums) -> ColorSums {
  constexpr int kMostHalvings = 5;
  for (int halving = 0; halving <= kMostHalvings; ++halving) {
    Lanes keep{};
    bool worse = false;
    for (int c = 0; c < kColors; ++c) {
      if (!(sums[c] > least[c])) continue;
      keep[c] = halving == kMostHalvings ? 1.0F : 0.5F;
      worse = true;
    }
    if (!worse) break;
    for (std::size_t i = 0; i < before.size(); ++i) {
      LaneValues& texel = system_.texel(static_cast<std::ptrdiff_t>(i));
      texel.v += keep * (before[i].v - texel.v);
    }
    sums = sums_with_links(weight, run);
  }
  return sums;
}

template <int C>
void EncodedFit<C>::add_regularization(const Image& start, const std::vector<unsigned char>& used) {
  const auto for_each_texel = [&](const auto& use) {
    for (int y = 0; y < system_.height(); ++y) {
      for (int x = 0; x < system_.width(); ++x) {
        if (used[static_cast<std::size_t>(y) * system_.width() + x] == 0) continue;
        use(system_.at(x, y), start.texel(x, y));
      }
    }
  };
  Lanes mean{};
  float count = 0.0F;
  for_each_texel([&](std::ptrdiff_t at, const float*) {
    mean += system_.diagonal(at).v;
    count += 1.0F;
  });
  const Lanes pull = static_cast<float>(kRegularization) / std::max(count, 1.0F) * mean;
  for_each_texel([&](std::ptrdiff_t at, const float* texel) {
    Lanes target{};
    for (int c = 0; c < kColors; ++c) target[c] = texel[c];
    system_.diagonal(at).v += pull;
    system_.right_side(at).v += pull * target;
  });
}

template <int C>
void EncodedFit<C>::iterate(const Image& start, const std::vector<unsigned char>& used,
                            double weight, const SolveOptions& options, const Run& run) {
  SolveOptions round_options = options;
  round_options.max_sweeps = kSweepsPerRound;
  round_options.ranges_times_alpha = false;
  std::vector<LaneValues> before(system_.size());
  ColorSums first{};
  ColorSums least{};
  for (int round = 0; round < kMaxGaussNewtonRounds; ++round) {
    const Run part = run.part(static_cast<double>(round) / kMaxGaussNewtonRounds,
                              static_cast<double>(round + 1) / kMaxGaussNewtonRounds);
    const Run assembling = part.part(0.0, 0.4);
    ColorSums sums = sums_with_links(weight, assembling);
    if (round == 0) {
      first = least = sums;
    } else {
      sums = backtrack(before, least, weight, assembling, sums);
      bool settled = true;
      for (int c = 0; c < kColors; ++c) {
        if (least[c] - sums[c] > kMinRelativeGain * (first[c] - sums[c])) settled = false;
        least[c] = std::min(least[c], sums[c]);
      }
      if (settled) break;
    }
    add_regularization(start, used);
    system_.invert_diagonal();
    if (weight > 0.0) system_.weigh_links(&links_, link_weights(weight));
    part.report(0.48);
    for (std::size_t i = 0; i < before.size(); ++i) {
      before[i] = system_.texel(static_cast<std::ptrdiff_t>(i));
    }
    system_.solve(round_options, part.part(0.5, 1.0));
  }
}

template class EncodedFit<1>;
template class EncodedFit<2>;
template class EncodedFit<3>;
template class EncodedFit<4>;

}  // namespace prefilter
