#include "prefilter/filters/tent_means.h"

#include <array>

#include "prefilter/base/parallel.h"

namespace prefilter {

Image tent_means(const ImageView& image, const std::vector<unsigned char>& read, WrapModes wrap,
                 int threads) {
  constexpr std::array<float, 3> kShares = {1.0F / 6.0F, 2.0F / 3.0F, 1.0F / 6.0F};
  const auto counts = [&](int x, int y) {
    return read.empty() || read[static_cast<std::size_t>(y) * image.width + x] != 0;
  };
  Image means(image);
  parallel_for(image.height, threads, Progress(), [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    for (int x = 0; x < image.width; ++x) {
      if (!counts(x, y)) continue;
      std::array<float, kMaxChannels> sums{};
      float shares = 0.0F;
      for (int j = 0; j < 3; ++j) {
        const int from_y = wrap_index(y + j - 1, image.height, wrap.v);
        if (from_y < 0) continue;
        for (int i = 0; i < 3; ++i) {
          const int from_x = wrap_index(x + i - 1, image.width, wrap.u);
          if (from_x < 0 || !counts(from_x, from_y)) continue;
          const float share = kShares[i] * kShares[j];
          const float* texel = image.texel(from_x, from_y);
          for (int c = 0; c < image.channels; ++c) sums[c] += share * texel[c];
          shares += share;
        }
      }
      float* mean = means.texel(x, y);
      for (int c = 0; c < image.channels; ++c) mean[c] = sums[c] / shares;
    }
  });
  return means;
}

}  // namespace prefilter
