// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/filters/tent_means.h"

#include <array>

#include "prefilter/base/lanes.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr std::array<float, 3> kTentWeights = {1.0F / 6.0F, 2.0F / 3.0F, 1.0F / 6.0F};

// A texel of up to four channels, and its weight.
struct Weighed {
  Lanes value{};
  float share = 0.0F;

  void add(const Weighed& other, float times) {
    value += times * other.value;
    share += times * other.share;
  }
};

}  // namespace

// Weights are products of weights along the axes: columns are summed first, then rows of sums.
Image tent_means(const ImageView& image, const std::vector<unsigned char>& read, WrapModes wrap,
                 int threads) {
  Image means(image);
  parallel_for(image.height, Run(threads), [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    const auto counts = [&](int x, int from_y) {
      return read.empty() || read[static_cast<std::size_t>(from_y) * image.width + x] != 0;
    };
    std::vector<Weighed> columns(static_cast<std::size_t>(image.width));
    for (int j = 0; j < 3; ++j) {
      const int from_y = wrap_index(y + j - 1, image.height, wrap.v);
      if (from_y < 0) continue;
      for (int x = 0; x < image.width; ++x) {
        if (!counts(x, from_y)) continue;
        const float* texel = image.texel(x, from_y);
        Weighed& column = columns[static_cast<std::size_t>(x)];
        for (int c = 0; c < image.channels; ++c) column.value[c] += kTentWeights[j] * texel[c];
        column.share += kTentWeights[j];
      }
    }
    for (int x = 0; x < image.width; ++x) {
      if (!counts(x, y)) continue;
      Weighed sum;
      for (int i = 0; i < 3; ++i) {
        const int at = x + i - 1;
        const int from_x = at >= 0 && at < image.width ? at : wrap_index(at, image.width, wrap.u);
        if (from_x >= 0) sum.add(columns[static_cast<std::size_t>(from_x)], kTentWeights[i]);
      }
      float* mean = means.texel(x, y);
      for (int c = 0; c < image.channels; ++c) mean[c] = sum.value[c] / sum.share;
    }
  });
  return means;
}

}  // namespace prefilter
