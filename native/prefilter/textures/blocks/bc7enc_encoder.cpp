// SPDX-License-Identifier: GPL-3.0-or-later

// bc7enc searches modes 1 and 6 for opaque blocks, and 5, 6 and 7 for others: partitions by
// estimates, endpoints first along the principal axis and then by least squares.
#include <bc7enc.h>

#include "prefilter/textures/blocks/encoders.h"

namespace prefilter {
namespace {

constexpr std::ptrdiff_t kBc7encTexelBytes = 4 * 4 * 4;
constexpr std::uint32_t kBc7encOpaqueWeight = 1024;

bc7enc_compress_block_params parameters(BlockEffort effort) {
  bc7enc_compress_block_params params{};
  bc7enc_compress_block_params_init(&params);
  // Equal weights for red, green, blue and alpha, as their meaning is unknown.
  bc7enc_compress_block_params_init_linear_weights(&params);
  // A higher level gains 2 % in combination with BC7F and takes half as much time again; more than
  // 16 partitions gain 0.1 dB and take a quarter more.
  const bool is_best = effort == BlockEffort::kBest;
  params.m_uber_level = is_best ? BC7ENC_MAX_UBER_LEVEL : 1;
  params.m_max_partitions = is_best ? BC7ENC_MAX_PARTITIONS : 16;
  params.m_mode17_partition_estimation_filterbank = false;
  return params;
}

/// Whether a block of mode 6 for opaque texels has an endpoint alpha of 254: the bit shared by the
/// channels of an endpoint then followed the colors.
bool has_alpha_254(const std::uint8_t* block) {
  const bool is_mode_6 = (block[0] & 0x7f) == 0x40;
  return is_mode_6 && ((block[7] & 0x80) == 0 || (block[8] & 1) == 0);
}

class Bc7encEncoder final : public ByteEncoder {
 public:
  explicit Bc7encEncoder(BlockEffort effort)
      : parameters_(parameters(effort)), opaque_(parameters(effort)) {
    static const bool has_tables = [] {
      bc7enc_compress_block_init();
      return true;
    }();
    static_cast<void>(has_tables);
    opaque_.m_force_alpha = true;
    opaque_.m_weights[3] = kBc7encOpaqueWeight;
  }

  void encode(const BlockRow<std::uint8_t>& row, std::uint8_t* blocks) override {
    for (int i = 0; i < row.count; ++i) {
      const std::uint8_t* texels = row.texels + kBc7encTexelBytes * i;
      std::uint8_t* block = blocks + std::ptrdiff_t{BC7ENC_BLOCK_SIZE} * i;
      const bool has_alpha = bc7enc_compress_block(block, texels, &parameters_);
      if (!has_alpha && has_alpha_254(block)) bc7enc_compress_block(block, texels, &opaque_);
    }
  }

 private:
  bc7enc_compress_block_params parameters_;
  /// For blocks whose alpha must stay 255.
  bc7enc_compress_block_params opaque_;
};

}  // namespace

std::unique_ptr<ByteEncoder> make_bc7enc_encoder(BlockEffort effort) {
  return std::make_unique<Bc7encEncoder>(effort);
}

}  // namespace prefilter
