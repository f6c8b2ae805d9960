// SPDX-License-Identifier: GPL-3.0-or-later

// Decodes UASTC and ETC1S with Basis Universal, whose term for it is transcoding to RGBA.
#include <transcoder/basisu_transcoder.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <limits>
#include <mutex>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/textures/blocks/decoders.h"

namespace prefilter {
namespace {

constexpr int kBlockSide = 4;
constexpr std::ptrdiff_t kTexelChannels = 4;

void make_decoding_tables() {
  static std::once_flag once;
  std::call_once(once, [] { basist::basisu_transcoder_init(); });
}

class UastcDecoder final : public ByteDecoder {
 public:
  UastcDecoder() { make_decoding_tables(); }

  void decode(const std::uint8_t* blocks, int count, std::uint8_t* texels) override {
    for (int i = 0; i < count; ++i) {
      basist::uastc_block block;
      std::memcpy(&block, blocks + std::ptrdiff_t{sizeof block} * i, sizeof block);
      std::array<basist::color32, std::size_t{kBlockSide} * kBlockSide> colors;
      if (!basist::unpack_uastc(block, colors.data(), false)) {
        throw_invalid("blocks: one of 'uastc' is damaged");
      }
      for (std::ptrdiff_t y = 0; y < kBlockSide; ++y) {
        std::memcpy(texels + kTexelChannels * kBlockSide * (y * count + i),
                    colors.data() + kBlockSide * y, kTexelChannels * kBlockSide);
      }
    }
  }
};

std::uint32_t size_of(std::span<const std::uint8_t> bytes) {
  if (bytes.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw_invalid("blocks: " + std::to_string(bytes.size()) + " bytes of ETC1S; 4 GiB at most");
  }
  return static_cast<std::uint32_t>(bytes.size());
}

// The library accepts codes of any length from a table with a single symbol, and reads past its
// tree for those longer than its first lookup. Returns false for such tables.
bool has_safe_tables(std::span<const std::uint8_t> bytes, int flag_count, int table_count) {
  basist::bitwise_decoder bits;
  if (!bits.init(bytes.data(), size_of(bytes))) return false;
  for (int i = 0; i < flag_count; ++i) {
    if (bits.get_bits(1) != 0) return true;  // no tables follow, or the library does not read them
  }
  for (int i = 0; i < table_count; ++i) {
    basist::huffman_decoding_table table;
    if (!bits.read_huffman_table(table)) return false;
    const basisu::uint8_vec& lengths = table.get_code_sizes();
    std::uint32_t used = 0;
    std::uint32_t longest = 0;
    for (std::uint32_t symbol = 0; symbol < lengths.size(); ++symbol) {
      used += lengths[symbol] != 0;
      longest = std::max<std::uint32_t>(longest, lengths[symbol]);
    }
    if (used == 1 && longest > basisu::cHuffmanFastLookupBits) return false;
  }
  return true;
}

bool has_safe_tables(const Etc1sCodebooks& codebooks) {
  constexpr int kSelectorFlags = 3;  // global, hybrid, raw
  return has_safe_tables(codebooks.tables, 0, 4) && has_safe_tables(codebooks.endpoints, 0, 4) &&
         has_safe_tables(codebooks.selectors, kSelectorFlags, 1);
}

std::vector<std::uint8_t> decoded(basist::basisu_lowlevel_etc1s_transcoder* transcoder,
                                  const Etc1sLevel& level) {
  if (level.width < 1 || level.height < 1) {
    throw_invalid("image: " + std::to_string(level.width) + " x " + std::to_string(level.height) +
                  " texels; both sides must be at least 1");
  }
  // The library takes one array with color and alpha. The state that it keeps between levels is for
  // videos only.
  std::vector<std::uint8_t> both(level.color.begin(), level.color.end());
  both.insert(both.end(), level.alpha.begin(), level.alpha.end());
  const auto width = static_cast<std::uint32_t>(level.width);
  const auto height = static_cast<std::uint32_t>(level.height);
  std::vector<std::uint8_t> texels(std::size_t{kTexelChannels} * width * height);
  basist::basisu_transcoder_state state;
  if (!transcoder->transcode_image(
          basist::transcoder_texture_format::cTFRGBA32, texels.data(), width * height, both.data(),
          size_of(both), (width + kBlockSide - 1) / kBlockSide,
          (height + kBlockSide - 1) / kBlockSide, width, height, 0, 0, size_of(level.color),
          size_of(level.color), size_of(level.alpha), 0, !level.alpha.empty(), false, 0, &state)) {
    throw_invalid("levels: one in ETC1S is damaged");
  }
  return texels;
}

}  // namespace

std::unique_ptr<ByteDecoder> make_uastc_decoder() { return std::make_unique<UastcDecoder>(); }

std::vector<std::vector<std::uint8_t>> decode_etc1s(const Etc1sCodebooks& codebooks,
                                                    std::span<const Etc1sLevel> levels,
                                                    const Run& run) {
  make_decoding_tables();
  basist::basisu_lowlevel_etc1s_transcoder transcoder;
  const auto is_count = [](int count) { return count >= 1 && count <= 0xffff; };
  if (!is_count(codebooks.endpoint_count) || !is_count(codebooks.selector_count) ||
      !has_safe_tables(codebooks) ||
      !transcoder.decode_tables(codebooks.tables.data(), size_of(codebooks.tables)) ||
      !transcoder.decode_palettes(static_cast<std::uint32_t>(codebooks.endpoint_count),
                                  codebooks.endpoints.data(), size_of(codebooks.endpoints),
                                  static_cast<std::uint32_t>(codebooks.selector_count),
                                  codebooks.selectors.data(), size_of(codebooks.selectors))) {
    throw_invalid("codebooks: those of ETC1S are damaged");
  }
  std::vector<std::vector<std::uint8_t>> images;
  for (const Etc1sLevel& level : levels) {
    images.push_back(decoded(&transcoder, level));
    run.report(static_cast<double>(images.size()) / static_cast<double>(levels.size()));
  }
  return images;
}

}  // namespace prefilter
