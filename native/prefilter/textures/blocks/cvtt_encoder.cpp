// SPDX-License-Identifier: GPL-3.0-or-later

// Convection Texture Tools search all modes, eight blocks at a time. The error of BC6H is measured
// in the bit patterns of half floats ("fast indexing"), which are roughly logarithmic. Measured in
// values, only the brightest texels of a block would count.
#include <ConvectionKernels.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr int kParallelBlocks = cvtt::NumParallelBlocks;
constexpr int kCvttBlockBytes = 16;

cvtt::Options bc6h_options(BlockEffort effort) {
  cvtt::Options options;
  options.flags = cvtt::Flags::BC6H_FastIndexing | cvtt::Flags::Uniform;
  // Four seed points take 3.5 times as long and reduce the error by 4 %.
  options.seedPoints = effort == BlockEffort::kBest ? 4 : 1;
  if (effort == BlockEffort::kFast) options.refineRoundsBC6H = 1;
  return options;
}

class CvttEncoder final : public HalfEncoder {
 public:
  explicit CvttEncoder(BlockEffort effort) : options_(bc6h_options(effort)) {}

  void encode(const BlockRow<HalfBits>& row, std::uint8_t* blocks) override {
    for (int first = 0; first < row.count; first += kParallelBlocks) {
      const int count = std::min(kParallelBlocks, row.count - first);
      std::array<cvtt::PixelBlockF16, kParallelBlocks> texels{};
      const auto texel_bytes = static_cast<std::ptrdiff_t>(sizeof(cvtt::PixelBlockF16));
      std::memcpy(texels.data(), row.texels + texel_bytes / 2 * first,
                  static_cast<std::size_t>(texel_bytes * count));
      std::array<std::uint8_t, kParallelBlocks * kCvttBlockBytes> encoded{};
      cvtt::Kernels::EncodeBC6HU(encoded.data(), texels.data(), options_);
      std::copy_n(encoded.begin(), count * kCvttBlockBytes,
                  blocks + std::ptrdiff_t{kCvttBlockBytes} * first);
    }
  }

 private:
  cvtt::Options options_;
};

cvtt::Options bc7_options() {
  cvtt::Options options;
  options.flags = cvtt::Flags::BC7_EnablePartitioning | cvtt::Flags::BC7_Enable3Subsets |
                  cvtt::Flags::BC7_EnableDualPlane | cvtt::Flags::Uniform;
  // Four seed points take twice as long and reduce the error by 1 %.
  options.seedPoints = 2;
  return options;
}

class CvttBc7Encoder final : public ByteEncoder {
 public:
  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    for (int first = 0; first < row.count; first += kParallelBlocks) {
      const int count = std::min(kParallelBlocks, row.count - first);
      std::array<cvtt::PixelBlockU8, kParallelBlocks> texels{};
      const auto texel_bytes = static_cast<std::ptrdiff_t>(sizeof(cvtt::PixelBlockU8));
      std::memcpy(texels.data(), row.texels + texel_bytes * first,
                  static_cast<std::size_t>(texel_bytes * count));
      std::array<std::uint8_t, kParallelBlocks * kCvttBlockBytes> encoded{};
      cvtt::Kernels::EncodeBC7(encoded.data(), texels.data(), options_);
      std::copy_n(encoded.begin(), count * kCvttBlockBytes,
                  blocks + std::ptrdiff_t{kCvttBlockBytes} * first);
    }
  }

 private:
  cvtt::Options options_ = bc7_options();
};

}  // namespace

std::unique_ptr<HalfEncoder> make_cvtt_encoder(BlockEffort effort) {
  return std::make_unique<CvttEncoder>(effort);
}

std::unique_ptr<ByteEncoder> make_cvtt_bc7_encoder() { return std::make_unique<CvttBc7Encoder>(); }

}  // namespace prefilter
