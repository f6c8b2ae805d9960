// SPDX-License-Identifier: GPL-3.0-or-later

// Section 4.2 on sparse grids: analysis from fine to coarse, then synthesis from coarse to fine.
#include "prefilter/wavelet/d4_transform.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/run.h"
#include "prefilter/wavelet/daubechies.h"

namespace prefilter::d4 {
namespace {

// [1] to [7]: the wavelet coefficients of one depth; [0] is unused.
using Details = BrickGrid<8>;

// A filter that computes every second point k from the points 2 k - 2 to 2 k + 4.
using Halving = std::array<float, 7>;
// Filters along the axis of a difference and across it, for coarser differences and for wavelets.
constexpr std::size_t kWindow = 13;
constexpr std::size_t kBricksPerBatch = 1U << 14U;

struct Filters {
  Halving low{};
  Halving high{};
  Halving difference{};
  Halving sums{};
};

Filters make_filters() {
  Filters f;
  float sum = 0.0F;
  for (std::size_t l = 0; l < 4; ++l) {
    const auto low = static_cast<float>(kLow[l]) / 2.0F;
    const auto high = static_cast<float>(kHigh[l]) / 2.0F;
    f.low[l + 2] = low;
    f.high[l] = high;
    f.difference[l + 2] += low;
    f.difference[l + 3] += low;
    sum += high;
    if (l < 3) f.sums[l] = sum;
  }
  return f;
}

// Filters and halves the middle axis: [kBefore][kWindow][kAfter] to [kBefore][4][kAfter].
template <std::size_t kBefore, std::size_t kAfter>
void halve(const float* from, const Halving& filter, float* to) {
  for (std::size_t b = 0; b < kBefore; ++b) {
    for (std::size_t i = 0; i < 4; ++i) {
      float* const out = to + (b * 4 + i) * kAfter;
      std::fill_n(out, kAfter, 0.0F);
      for (std::size_t l = 0; l < 7; ++l) {
        if (filter[l] == 0.0F) continue;
        const float* const in = from + (b * kWindow + 2 * i + l) * kAfter;
        for (std::size_t c = 0; c < kAfter; ++c) out[c] += filter[l] * in[c];
      }
    }
  }
}

// Filters a window along z, y and x.
void halve_all(const float* window, const Halving& x, const Halving& y, const Halving& z,
               float* to) {
  std::array<float, 4 * kWindow * kWindow> along_z;
  std::array<float, 4 * 4 * kWindow> along_y;
  halve<1, kWindow * kWindow>(window, z, along_z.data());
  halve<4, kWindow>(along_z.data(), y, along_y.data());
  halve<16, 1>(along_y.data(), x, to);
}

constexpr std::size_t kWindowPoints = kWindow * kWindow * kWindow;

using DifferenceWindow = std::array<float, 3 * kWindowPoints>;

Differences::Brick restricted(const DifferenceWindow& window, const Filters& f) {
  Differences::Brick result;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto along = [&](std::size_t axis) -> const Halving& {
      return axis == a ? f.difference : f.low;
    };
    halve_all(window.data() + a * kWindowPoints, along(0), along(1), along(2),
              result.data() + a * 64);
  }
  return result;
}

Details::Brick details_of(const DifferenceWindow& window, const Filters& f) {
  Details::Brick result{};
  std::array<float, 64> part;
  for (std::size_t e = 1; e < 8; ++e) {
    const auto axes = static_cast<float>((e & 1) + ((e >> 1) & 1) + (e >> 2));
    for (std::size_t a = 0; a < 3; ++a) {
      if (((e >> a) & 1) == 0) continue;
      const auto along = [&](std::size_t axis) -> const Halving& {
        if (axis == a) return f.sums;
        return ((e >> axis) & 1) != 0 ? f.high : f.low;
      };
      halve_all(window.data() + a * kWindowPoints, along(0), along(1), along(2), part.data());
      for (std::size_t i = 0; i < 64; ++i) result[e * 64 + i] += part[i] / axes;
    }
  }
  return result;
}

void sort_unique(std::vector<BrickPosition>* bricks) {
  std::sort(bricks->begin(), bricks->end());
  bricks->erase(std::unique(bricks->begin(), bricks->end()), bricks->end());
}

// The bricks of the next coarser depth that contain points 2 b - 2 to 2 b + 2 of a brick b: those
// that depend on it, and those that it depends on.
std::vector<BrickPosition> coarser_bricks(const std::vector<BrickPosition>& bricks) {
  std::vector<BrickPosition> result;
  for (const BrickPosition& b : bricks) {
    for (int corner = 0; corner < 8; ++corner) {
      BrickPosition coarse;
      for (std::size_t a = 0; a < 3; ++a) {
        coarse[a] = (2 * b[a] + (((corner >> a) & 1) != 0 ? 2 : -2)) >> 2;
      }
      result.push_back(coarse);
    }
  }
  sort_unique(&result);
  return result;
}

// Calls make(i) for all bricks in parallel, then keep(i, made) in order.
template <typename Brick, typename Make, typename Keep>
void for_bricks(std::size_t count, const Run& run, const Make& make, const Keep& keep) {
  constexpr std::size_t kBricksPerRound = 1024;
  constexpr std::int64_t kBricksPerTask = 32;
  std::vector<Brick> made(std::min(count, kBricksPerRound));
  for (std::size_t first = 0; first < count; first += kBricksPerRound) {
    const std::size_t size = std::min(kBricksPerRound, count - first);
    run.report(static_cast<double>(first) / static_cast<double>(count));
    parallel_ranges(static_cast<std::int64_t>(size), kBricksPerTask, Run(run.threads()),
                    [&](std::int64_t begin, std::int64_t end) {
                      for (auto i = static_cast<std::size_t>(begin);
                           i < static_cast<std::size_t>(end); ++i) {
                        made[i] = make(first + i);
                      }
                    });
    for (std::size_t i = 0; i < size; ++i) keep(first + i, made[i]);
  }
}

// The differences around a brick of the next coarser depth.
std::unique_ptr<DifferenceWindow> window_around(const Differences& finer, const BrickPosition& b) {
  auto window = std::make_unique<DifferenceWindow>();
  finer.window<kWindow>({8 * b[0] - 2, 8 * b[1] - 2, 8 * b[2] - 2}, window.get());
  return window;
}

void restrict_to(const Differences& finer, const Run& run, Differences* coarser) {
  const Filters filters = make_filters();
  const std::vector<BrickPosition> bricks = coarser_bricks(finer.positions());
  for_bricks<Differences::Brick>(
      bricks.size(), run,
      [&](std::size_t i) { return restricted(*window_around(finer, bricks[i]), filters); },
      [&](std::size_t i, const Differences::Brick& made) {
        Differences::Brick& brick = coarser->make(bricks[i]);
        for (std::size_t k = 0; k < brick.size(); ++k) brick[k] += made[k];
      });
}

// The details in the given bricks.
Details details_in(const std::vector<BrickPosition>& bricks, const Differences& finer, int depth,
                   const Run& run) {
  const Filters filters = make_filters();
  Details details(depth, kShardBits);
  for_bricks<Details::Brick>(
      bricks.size(), run,
      [&](std::size_t i) { return details_of(*window_around(finer, bricks[i]), filters); },
      [&](std::size_t i, const Details::Brick& made) { details.make(bricks[i]) = made; });
  return details;
}

// The means of depth 0, as sums of differences starting outside the function's support. There are
// six paths, which agree for closed surfaces; the median ignores the worst.
Means first_means(const Differences& differences) {
  constexpr std::int32_t kLow0 = -4;
  constexpr std::size_t kSide = 8;
  const auto window = std::make_unique<std::array<float, 3 * kSide * kSide * kSide>>();
  differences.window<kSide>({kLow0, kLow0, kLow0}, window.get());
  const auto at = [&](std::size_t a, std::array<std::size_t, 3> p, std::size_t along) {
    p[a] = along;
    return static_cast<double>((*window)[((a * kSide + p[2]) * kSide + p[1]) * kSide + p[0]]);
  };
  Means means(0, kShardBits);
  for (std::size_t z = 0; z < kSide; ++z) {
    for (std::size_t y = 0; y < kSide; ++y) {
      for (std::size_t x = 0; x < kSide; ++x) {
        const std::array<std::size_t, 3> p = {x, y, z};
        std::array<double, 6> estimates{};
        for (std::size_t a = 0; a < 3; ++a) {
          for (std::size_t i = p[a]; i < kSide; ++i) estimates[2 * a] += at(a, p, i);
          for (std::size_t i = 0; i < p[a]; ++i) estimates[2 * a + 1] -= at(a, p, i);
        }
        std::sort(estimates.begin(), estimates.end());
        const BrickPosition b = {x < 4 ? -1 : 0, y < 4 ? -1 : 0, z < 4 ? -1 : 0};
        means.make(b)[((z & 3) * 4 + (y & 3)) * 4 + (x & 3)] =
            static_cast<float>((estimates[2] + estimates[3]) / 2.0);
      }
    }
  }
  return means;
}

// Doubles the resolution along one axis: [kBefore][5][kAfter] to [kBefore][4][kAfter].
template <std::size_t kBefore, std::size_t kAfter>
void add_doubled(const float* from, bool is_high, float* to) {
  // The weight of point 2 b - 2 + i for point 4 b + r is at [r + 12 - 2 i].
  std::array<float, 16> weights{};
  for (std::size_t l = 0; l < 4; ++l) {
    weights[l + (is_high ? 6 : 8)] = static_cast<float>(is_high ? kHigh[l] : kLow[l]);
  }
  for (std::size_t b = 0; b < kBefore; ++b) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t i = 0; i < 5; ++i) {
        const float weight = weights[r + 12 - 2 * i];
        if (weight == 0.0F) continue;
        const float* const in = from + (b * 5 + i) * kAfter;
        float* const out = to + (b * 4 + r) * kAfter;
        for (std::size_t c = 0; c < kAfter; ++c) out[c] += weight * in[c];
      }
    }
  }
}

// The means in a brick, from the means and details of the next coarser depth.
Means::Brick means_in(const BrickPosition& b, const Means& coarser, const Details& details) {
  constexpr std::size_t kPoints = 125;
  std::array<float, kPoints> mean;
  std::array<float, 8 * kPoints> all;
  const BrickPosition low = {2 * b[0] - 2, 2 * b[1] - 2, 2 * b[2] - 2};
  coarser.window<5>(low, &mean);
  details.window<5>(low, &all);
  std::copy(mean.begin(), mean.end(), all.begin());
  std::array<float, 4 * 4 * 25> along_x{};  // for the four combinations along y and z: [z][y][x]
  for (std::size_t e = 0; e < 8; ++e) {
    add_doubled<25, 1>(all.data() + e * kPoints, (e & 1) != 0, along_x.data() + (e >> 1) * 100);
  }
  std::array<float, 2 * 80> along_y{};
  for (std::size_t e = 0; e < 4; ++e) {
    add_doubled<5, 4>(along_x.data() + e * 100, (e & 1) != 0, along_y.data() + (e >> 1) * 80);
  }
  Means::Brick result{};
  for (std::size_t e = 0; e < 2; ++e) {
    add_doubled<1, 16>(along_y.data() + e * 80, e != 0, result.data());
  }
  return result;
}

}  // namespace

void add_sample(const Vector3& point, const std::array<float, 3>& area, Differences* differences) {
  BrickPosition last;
  std::array<std::array<float, 4>, 3> phi{};
  std::array<std::array<float, 4>, 3> lambda;
  for (std::size_t a = 0; a < 3; ++a) {
    const double cell = std::floor(point[a]);
    last[a] = static_cast<std::int32_t>(cell);
    const Values values = values_at(static_cast<float>(point[a] - cell));
    // In the order of the points, starting at last - 3.
    for (std::size_t i = 0; i < 3; ++i) phi[a][3 - i] = values.phi[i];
    for (std::size_t i = 0; i < 4; ++i) lambda[a][3 - i] = values.lambda[i] * area[a];
  }
  const BrickPosition first = {last[0] - 3, last[1] - 3, last[2] - 3};
  for (std::int32_t bz = first[2] >> 2; bz <= last[2] >> 2; ++bz) {
    for (std::int32_t by = first[1] >> 2; by <= last[1] >> 2; ++by) {
      for (std::int32_t bx = first[0] >> 2; bx <= last[0] >> 2; ++bx) {
        Differences::Brick& brick = differences->make({bx, by, bz});
        for (std::int32_t z = std::max(first[2], 4 * bz); z <= std::min(last[2], 4 * bz + 3); ++z) {
          const auto k = static_cast<std::size_t>(z - first[2]);
          for (std::int32_t y = std::max(first[1], 4 * by); y <= std::min(last[1], 4 * by + 3);
               ++y) {
            const auto j = static_cast<std::size_t>(y - first[1]);
            const float along_x = phi[1][j] * phi[2][k];
            const float along_y = lambda[1][j] * phi[2][k];
            const float along_z = phi[1][j] * lambda[2][k];
            const auto row = static_cast<std::size_t>(((z & 3) * 4 + (y & 3)) * 4);
            for (std::int32_t x = std::max(first[0], 4 * bx); x <= std::min(last[0], 4 * bx + 3);
                 ++x) {
              const auto i = static_cast<std::size_t>(x - first[0]);
              const std::size_t p = row + static_cast<std::size_t>(x & 3);
              brick[p] += lambda[0][i] * along_x;
              brick[64 + p] += phi[0][i] * along_y;
              brick[128 + p] += phi[0][i] * along_z;
            }
          }
        }
      }
    }
  }
}

std::vector<Means> transform(std::vector<Differences> differences,
                             std::vector<std::vector<BrickPosition>> needed, const Run& run) {
  const std::size_t depth = differences.size() - 1;
  // Most of the time is spent in the finest depth, and there on the details.
  constexpr double kRestrictShare = 0.2;
  for (std::size_t k = depth; k > 0; --k) {
    const bool is_finest = k == depth;
    restrict_to(differences[k], run.part(is_finest ? 0.0 : 0.15, is_finest ? 0.15 : kRestrictShare),
                &differences[k - 1]);
    sort_unique(&needed[k]);
    const std::vector<BrickPosition> more = coarser_bricks(needed[k]);
    needed[k - 1].insert(needed[k - 1].end(), more.begin(), more.end());
  }
  std::vector<Means> means;
  means.push_back(first_means(differences[0]));
  for (std::size_t k = 1; k <= depth; ++k) {
    const Means& coarser = means.back();
    Means finer(static_cast<int>(k), kShardBits);
    // In batches sorted by z, as details need the most memory.
    std::vector<BrickPosition>& bricks = needed[k];
    std::sort(bricks.begin(), bricks.end(), [](const BrickPosition& a, const BrickPosition& b) {
      return std::array{a[2], a[1], a[0]} < std::array{b[2], b[1], b[0]};
    });
    std::vector<BrickPosition> all = coarser_bricks(differences[k].positions());
    const Run part = run.part(k < depth ? kRestrictShare : 0.4, k < depth ? 0.4 : 1.0);
    const auto count = static_cast<double>(bricks.size());
    for (std::size_t begin = 0; begin < bricks.size();) {
      std::size_t end = std::min(begin + kBricksPerBatch, bricks.size());
      while (end < bricks.size() && bricks[end][2] == bricks[end - 1][2]) ++end;
      const std::int32_t low = (2 * bricks[begin][2] - 2) >> 2;
      const std::int32_t high = (2 * bricks[end - 1][2] + 2) >> 2;
      std::vector<BrickPosition> around;
      for (const BrickPosition& b : all) {
        if (b[2] >= low && b[2] <= high) around.push_back(b);
      }
      const double from = static_cast<double>(begin) / count;
      const double to = static_cast<double>(end) / count;
      const double between = from + 0.8 * (to - from);
      const Details details =
          details_in(around, differences[k], static_cast<int>(k) - 1, part.part(from, between));
      for_bricks<Means::Brick>(
          end - begin, part.part(between, to),
          [&](std::size_t i) { return means_in(bricks[begin + i], coarser, details); },
          [&](std::size_t i, const Means::Brick& made) { finer.make(bricks[begin + i]) = made; });
      begin = end;
    }
    differences[k] = Differences(0, kShardBits);
    means.push_back(std::move(finer));
  }
  return means;
}

std::array<float, 64> function_at(const Means& means, const BrickPosition& b) {
  static const Values kHalf = values_at(0.5F);
  std::array<float, 216> window;
  means.window<6>({4 * b[0] - 2, 4 * b[1] - 2, 4 * b[2] - 2}, &window);
  // Weights of the points from two before on: phi(5/2), phi(3/2), phi(1/2).
  const std::array<float, 3> weights = {kHalf.phi[2], kHalf.phi[1], kHalf.phi[0]};
  std::array<float, 64> result{};
  std::array<float, 144> along_x{};
  std::array<float, 96> along_y{};
  for (std::size_t row = 0; row < 36; ++row) {
    for (std::size_t x = 0; x < 4; ++x) {
      for (std::size_t i = 0; i < 3; ++i) {
        along_x[row * 4 + x] += weights[i] * window[row * 6 + x + i];
      }
    }
  }
  for (std::size_t z = 0; z < 6; ++z) {
    for (std::size_t y = 0; y < 4; ++y) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t x = 0; x < 4; ++x) {
          along_y[(z * 4 + y) * 4 + x] += weights[i] * along_x[(z * 6 + y + i) * 4 + x];
        }
      }
    }
  }
  for (std::size_t z = 0; z < 4; ++z) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t c = 0; c < 16; ++c) {
        result[z * 16 + c] += weights[i] * along_y[(z + i) * 16 + c];
      }
    }
  }
  return result;
}

}  // namespace prefilter::d4
