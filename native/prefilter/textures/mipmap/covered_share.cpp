// SPDX-License-Identifier: GPL-3.0-or-later

// Counts sampled lookups cell by cell; cells on one side of the threshold are decided at once.
#include "prefilter/textures/mipmap/covered_share.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// A linear lookup along an axis: between texels `first` and `first` + 1, by `fraction`.
struct Lookup {
  int first;
  float fraction;
};

std::vector<Lookup> lookups(int cells, int samples, int texels) {
  const std::int64_t count = static_cast<std::int64_t>(cells) * samples;
  std::vector<Lookup> result(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * texels - 0.5;
    const double first = std::floor(at);
    result[static_cast<std::size_t>(i)] = {static_cast<int>(first), static_cast<float>(at - first)};
  }
  return result;
}

// Alpha with a border of one texel defined by the wrap modes, so that lookups need no bounds check.
Image add_border(const ImageView& alpha, WrapModes wrap, const Run& run) {
  Image result(alpha.width + 2, alpha.height + 2, 1);
  parallel_for(result.height, run, [&](std::int64_t row) {
    const int from_y = wrap_index(static_cast<int>(row) - 1, alpha.height, wrap.v);
    if (from_y < 0) return;
    const float* from = alpha.texel(0, from_y);
    float* to = result.texel(0, static_cast<int>(row));
    const auto copy = [&](int from_x, int x) {
      if (from_x >= 0 && std::isfinite(from[from_x])) to[x] = from[from_x];
    };
    copy(wrap_index(-1, alpha.width, wrap.u), 0);
    for (int x = 0; x < alpha.width; ++x) copy(x, x + 1);
    copy(wrap_index(alpha.width, alpha.width, wrap.u), alpha.width + 1);
  });
  return result;
}

void check(const ImageView& alpha, const ImageView& weights, int samples) {
  if (alpha.channels != 1 || weights.channels != 1) {
    throw_invalid("alpha, weights: " + std::to_string(alpha.channels) + " and " +
                  std::to_string(weights.channels) + " channels; 1 each is needed");
  }
  if (samples < 1) {
    throw_invalid("samples: " + std::to_string(samples) + "; at least 1 is needed");
  }
}

// Number of a cell's lookups that reach the threshold. `texels` has the border.
int count_passing(const Image& texels, std::span<const Lookup> columns,
                  std::span<const Lookup> rows, float threshold) {
  // Shortcut for cells with all lookups on the same side of the threshold, as most are.
  float low = *texels.texel(columns.front().first + 1, rows.front().first + 1);
  float high = low;
  for (int y = rows.front().first + 1; y <= rows.back().first + 2; ++y) {
    for (int x = columns.front().first + 1; x <= columns.back().first + 2; ++x) {
      low = std::min(low, *texels.texel(x, y));
      high = std::max(high, *texels.texel(x, y));
    }
  }
  if (high < threshold) return 0;
  if (low >= threshold) return static_cast<int>(columns.size() * rows.size());

  int hits = 0;
  for (const Lookup& y : rows) {
    for (const Lookup& x : columns) {
      const float* const below = texels.texel(x.first + 1, y.first + 1);
      const float* const above = below + texels.width;
      const float at_below = below[0] + (below[1] - below[0]) * x.fraction;
      const float at_above = above[0] + (above[1] - above[0]) * x.fraction;
      hits += at_below + (at_above - at_below) * y.fraction >= threshold ? 1 : 0;
    }
  }
  return hits;
}

}  // namespace

double covered_share(const ImageView& alpha, const ImageView& weights, int samples, float threshold,
                     WrapModes wrap, const Run& run) {
  check(alpha, weights, samples);
  const Stages stages(run, {1, 9});
  const Image texels = add_border(alpha, wrap, stages[0]);
  const std::vector<Lookup> columns = lookups(weights.width, samples, alpha.width);
  const std::vector<Lookup> rows = lookups(weights.height, samples, alpha.height);
  const auto lookups_of = [samples](const std::vector<Lookup>& all, std::int64_t cell) {
    return std::span(all).subspan(static_cast<std::size_t>(cell) * samples, samples);
  };
  const auto per_row = static_cast<std::size_t>(weights.height);
  std::vector<double> kept(per_row);
  std::vector<double> all(per_row);
  parallel_for(weights.height, stages[1], [&](std::int64_t cell_y) {
    double kept_here = 0.0;
    double all_here = 0.0;
    for (int cell_x = 0; cell_x < weights.width; ++cell_x) {
      const double weight = *weights.texel(cell_x, static_cast<int>(cell_y));
      if (!(weight > 0.0)) continue;
      all_here += weight;
      const int hits =
          count_passing(texels, lookups_of(columns, cell_x), lookups_of(rows, cell_y), threshold);
      kept_here += weight * hits / (static_cast<double>(samples) * samples);
    }
    kept[static_cast<std::size_t>(cell_y)] = kept_here;
    all[static_cast<std::size_t>(cell_y)] = all_here;
  });

  double kept_sum = 0.0;
  double all_sum = 0.0;
  for (std::size_t y = 0; y < per_row; ++y) {
    kept_sum += kept[y];
    all_sum += all[y];
  }
  if (!(all_sum > 0.0)) throw_invalid("weights: none is positive; at least one is needed");
  return kept_sum / all_sum;
}

}  // namespace prefilter
