// SPDX-License-Identifier: GPL-3.0-or-later

// Encodes ETC1S with the frontend (codebooks) and backend (bit streams) of Basis Universal.
#include <encoder/basisu_backend.h>
#include <encoder/basisu_etc.h>
#include <encoder/basisu_frontend.h>
#include <transcoder/basisu_transcoder.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/textures/compress_etc1s.h"

namespace prefilter {
namespace {

constexpr int kEtc1sSide = 4;
constexpr std::ptrdiff_t kEtc1sChannels = 4;
constexpr std::int64_t kMaxEtc1sTexels = std::int64_t{1} << 30;
// Basis Universal's compression levels 0 to 6: from 1 on codebooks are built hierarchically, and
// higher levels refine more.
constexpr std::uint32_t kFastLevel = 1, kNormalLevel = basisu::BASISU_DEFAULT_COMPRESSION_LEVEL,
                        kBestLevel = 4;
// Errors accepted for repeating an earlier block's endpoints or selectors, relative to the block's
// own; the defaults of Basis Universal.
constexpr float kEndpointLoss = 1.5F;
constexpr float kSelectorLoss = 1.25F;
// Codebook sizes grow with a power of the quality, so that file sizes grow about linearly.
constexpr double kMinEndpoints = 32.0, kMaxEndpoints = 8192.0, kEndpointPower = 1.6;
constexpr double kMinSelectors = 96.0, kMaxSelectors = 16128.0, kSelectorPower = 2.6;

void make_etc1s_tables() {
  static std::once_flag once;
  std::call_once(once, [] {
    basist::basisu_transcoder_init();
    basisu::pack_etc1_solid_color_init();
    basisu::interval_timer::init();
  });
}

void check(std::span<const Etc1sImage> levels, const Etc1sOptions& options) {
  if (levels.empty()) throw_invalid("levels: none; 1 or more are needed");
  if (options.quality < kMinEtc1sQuality || options.quality > kMaxEtc1sQuality) {
    throw_invalid("quality: " + std::to_string(options.quality) + "; " +
                  std::to_string(kMinEtc1sQuality) + " to " + std::to_string(kMaxEtc1sQuality) +
                  " are allowed");
  }
  std::int64_t texels = 0;
  for (const Etc1sImage& level : levels) {
    if (level.width < 1 || level.height < 1) {
      throw_invalid("image: " + std::to_string(level.width) + " x " + std::to_string(level.height) +
                    " texels; both sides must be at least 1");
    }
    texels += std::int64_t{level.width} * level.height;
    if (texels > kMaxEtc1sTexels) {
      throw_invalid("levels: more than " + std::to_string(kMaxEtc1sTexels) +
                    " texels, which are the most in ETC1S");
    }
  }
}

/// The levels as slices of blocks for the library: one for color, and one for alpha.
class Slices {
 public:
  Slices(std::span<const Etc1sImage> levels, bool has_alpha) {
    for (std::size_t i = 0; i < levels.size(); ++i) {
      add(levels[i], i, false);
      if (has_alpha) add(levels[i], i, true);
    }
  }

  basisu::pixel_block_vec& blocks() { return blocks_; }
  const basisu::basisu_backend_slice_desc_vec& described() const { return described_; }

 private:
  void add(const Etc1sImage& level, std::size_t number, bool is_alpha) {
    basisu::basisu_backend_slice_desc slice;
    slice.m_first_block_index = static_cast<std::uint32_t>(blocks_.size());
    slice.m_orig_width = static_cast<std::uint32_t>(level.width);
    slice.m_orig_height = static_cast<std::uint32_t>(level.height);
    slice.m_num_blocks_x = static_cast<std::uint32_t>(range_count(level.width, kEtc1sSide));
    slice.m_num_blocks_y = static_cast<std::uint32_t>(range_count(level.height, kEtc1sSide));
    slice.m_width = kEtc1sSide * slice.m_num_blocks_x;
    slice.m_height = kEtc1sSide * slice.m_num_blocks_y;
    slice.m_num_macroblocks_x = (slice.m_num_blocks_x + 1) / 2;
    slice.m_num_macroblocks_y = (slice.m_num_blocks_y + 1) / 2;
    slice.m_mip_index = static_cast<std::uint32_t>(number);
    slice.m_alpha = is_alpha;
    described_.push_back(slice);
    for (std::uint32_t y = 0; y < slice.m_num_blocks_y; ++y) {
      for (std::uint32_t x = 0; x < slice.m_num_blocks_x; ++x) {
        blocks_.push_back(block_at(level, static_cast<int>(x), static_cast<int>(y), is_alpha));
      }
    }
  }

  static basisu::pixel_block block_at(const Etc1sImage& level, int column, int row, bool is_alpha) {
    basisu::pixel_block block;
    for (int y = 0; y < kEtc1sSide; ++y) {
      for (int x = 0; x < kEtc1sSide; ++x) {
        const std::ptrdiff_t from_y = std::min(kEtc1sSide * row + y, level.height - 1);
        const std::ptrdiff_t from_x = std::min(kEtc1sSide * column + x, level.width - 1);
        const std::uint8_t* texel = level.rgba + kEtc1sChannels * (from_y * level.width + from_x);
        const auto color = [&](int channel) { return texel[is_alpha ? 3 : channel]; };
        block.m_pixels[y][x].set_noclamp_rgba(color(0), color(1), color(2), 255);
      }
    }
    return block;
  }

  basisu::pixel_block_vec blocks_;
  basisu::basisu_backend_slice_desc_vec described_;
};

std::uint32_t level_for(BlockEffort effort) {
  if (effort == BlockEffort::kFast) return kFastLevel;
  return effort == BlockEffort::kBest ? kBestLevel : kNormalLevel;
}

std::uint32_t codebook_size(double fewest, double most, double power, const Etc1sOptions& options,
                            std::size_t blocks) {
  const double share = elementary::pow(options.quality / double{kMaxEtc1sQuality}, power);
  const double size = fewest + (most - fewest) * share;
  return static_cast<std::uint32_t>(std::min(size, std::max(fewest, static_cast<double>(blocks))));
}

basisu::basisu_frontend::params codebook_params(basisu::pixel_block_vec& blocks,
                                                const Etc1sOptions& options) {
  basisu::basisu_frontend::params params;
  params.m_num_source_blocks = static_cast<std::uint32_t>(blocks.size());
  params.m_pSource_blocks = blocks.data();
  params.m_max_endpoint_clusters =
      codebook_size(kMinEndpoints, kMaxEndpoints, kEndpointPower, options, blocks.size());
  params.m_max_selector_clusters =
      codebook_size(kMinSelectors, kMaxSelectors, kSelectorPower, options, blocks.size());
  params.m_compression_level = level_for(options.effort);
  params.m_perceptual = options.is_color;
  params.m_dump_endpoint_clusterization = false;
  params.m_pGlobal_codebooks = nullptr;
  // If this were set, clusters would depend on the number of threads; the jobs of the pool do not.
  params.m_multithreaded = false;
  return params;
}

std::vector<std::uint8_t> copied(const basisu::uint8_vec& bytes) {
  return {bytes.data(), bytes.data() + bytes.size()};
}

Etc1sTexture texture_of(const basisu::basisu_backend_output& output) {
  Etc1sTexture texture;
  texture.endpoint_count = static_cast<int>(output.m_num_endpoints);
  texture.selector_count = static_cast<int>(output.m_num_selectors);
  texture.endpoints = copied(output.m_endpoint_palette);
  texture.selectors = copied(output.m_selector_palette);
  texture.tables = copied(output.m_slice_image_tables);
  for (std::uint32_t i = 0; i < output.m_slice_desc.size(); ++i) {
    if (output.m_slice_desc[i].m_alpha) {
      texture.levels.back().alpha = copied(output.m_slice_image_data[i]);
    } else {
      texture.levels.push_back({copied(output.m_slice_image_data[i]), {}});
    }
  }
  return texture;
}

}  // namespace

Etc1sTexture compress_etc1s(std::span<const Etc1sImage> levels, const Etc1sOptions& options,
                            const Run& run) {
  check(levels, options);
  make_etc1s_tables();
  run.report(0.0);
  Slices slices(levels, options.has_alpha);
  basisu::job_pool pool(static_cast<std::uint32_t>(resolve_threads(run.threads())));
  const auto codebooks = std::make_unique<basisu::basisu_frontend>();
  basisu::basisu_frontend::params params = codebook_params(slices.blocks(), options);
  params.m_pJob_pool = &pool;
  const bool is_valid = codebooks->init(params) && codebooks->compress();
  run.report(0.8);
  basisu::basisu_backend references;
  basisu::basisu_backend_params how;
  how.m_etc1s = true;
  how.m_compression_level = level_for(options.effort);
  how.m_validate = false;
  // Allowed losses shrink from the middle of the quality range on, to preserve high quality.
  const float share = static_cast<float>(options.quality) / static_cast<float>(kMaxEtc1sQuality);
  const float loss = std::clamp(2.0F - 2.0F * share, 0.25F, 1.0F);
  how.m_endpoint_rdo_quality_thresh = kEndpointLoss * loss;
  how.m_selector_rdo_quality_thresh = kSelectorLoss * loss;
  if (is_valid) references.init(codebooks.get(), how, slices.described());
  if (!is_valid || references.encode() == 0) {
    throw_invalid("levels: Basis Universal cannot compress them as ETC1S");
  }
  run.report(1.0);
  return texture_of(references.get_output());
}

}  // namespace prefilter
