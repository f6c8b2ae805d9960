// SPDX-License-Identifier: GPL-3.0-or-later

#include <smmintrin.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "bench/sampling/peers.h"

namespace prefilter::bench {
namespace {

__m128 load(const float* texel) { return _mm_loadu_ps(texel); }

__m128 load(const std::uint8_t* texel) {
  int word;
  std::memcpy(&word, texel, sizeof word);
  return _mm_cvtepi32_ps(_mm_cvtepu8_epi32(_mm_cvtsi32_si128(word)));
}

__m128 mix(__m128 a, __m128 b, __m128 share) {
  return _mm_add_ps(a, _mm_mul_ps(share, _mm_sub_ps(b, a)));
}

template <typename Value>
struct Level {
  const Value* texels;
  int side;  // a power of 2

  __m128 bilinear(float u, float v) const {
    const float x = u * static_cast<float>(side) - 0.5F;
    const float y = v * static_cast<float>(side) - 0.5F;
    const float low_x = std::floor(x);
    const float low_y = std::floor(y);
    const int mask = side - 1;
    const int x0 = static_cast<int>(low_x) & mask;
    const int y0 = static_cast<int>(low_y) & mask;
    const int x1 = (x0 + 1) & mask;
    const int y1 = (y0 + 1) & mask;
    const Value* row0 = texels + 4 * y0 * side;
    const Value* row1 = texels + 4 * y1 * side;
    const __m128 share = _mm_set1_ps(x - low_x);
    return mix(mix(load(row0 + 4 * x0), load(row0 + 4 * x1), share),
               mix(load(row1 + 4 * x0), load(row1 + 4 * x1), share), _mm_set1_ps(y - low_y));
  }
};

template <typename Value>
class Trilinear : public Peer {
 public:
  explicit Trilinear(const std::vector<std::vector<Value>>& levels) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      levels_.push_back({levels[i].data(), kSide >> i});
    }
  }

  void sample(const Samples& samples, float* result) override {
    const __m128 unit = _mm_set1_ps(sizeof(Value) == 1 ? 1.0F / 255.0F : 1.0F);
    const auto last = static_cast<float>(levels_.size() - 1);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      const auto [u, v] = samples.float_coordinates[i];
      const float mip_value = std::clamp(std::log2(samples.float_scales[i]), 0.0F, last);
      const int finer = static_cast<int>(mip_value);
      const float share = mip_value - static_cast<float>(finer);
      __m128 value = levels_[finer].bilinear(u, v);
      if (share > 0.0F) value = mix(value, levels_[finer + 1].bilinear(u, v), _mm_set1_ps(share));
      _mm_storeu_ps(result + 4 * i, _mm_mul_ps(value, unit));
    }
  }

 private:
  std::vector<Level<Value>> levels_;
};

}  // namespace

std::unique_ptr<Peer> written_trilinear(const Texture& texture, bool bytes) {
  if (bytes) return std::make_unique<Trilinear<std::uint8_t>>(texture.bytes);
  return std::make_unique<Trilinear<float>>(texture.floats);
}

}  // namespace prefilter::bench
