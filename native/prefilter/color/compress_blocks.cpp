// The fitting is libsquish's: clusters along the principal axis of a block's colours, all ways to
// split them tried, and least squares for the ends (Simon Brown, "DXT Compression Techniques").
#include "prefilter/color/compress_blocks.h"

#include <squish.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

constexpr int kSide = 4;

int squish_flags(const BlockOptions& options) {
  switch (options.format) {
    case BlockFormat::kBc1:
      return squish::kDxt1;
    case BlockFormat::kBc3:
      return squish::kDxt5 | (options.weigh_by_alpha ? squish::kWeightColourByAlpha : 0);
    case BlockFormat::kBc4:
      return squish::kBc4;
    case BlockFormat::kBc5:
      return squish::kBc5;
  }
  return 0;
}

std::size_t block_bytes(BlockFormat format) {
  return format == BlockFormat::kBc1 || format == BlockFormat::kBc4 ? 8 : 16;
}

}  // namespace

std::vector<std::uint8_t> compress_blocks(const std::uint8_t* rgba, int width, int height,
                                          const BlockOptions& options, const Progress& progress) {
  if (width < 1 || height < 1) {
    throw_invalid("image: " + std::to_string(width) + " x " + std::to_string(height) +
                  " texels; both sides must be at least 1");
  }
  const int flags = squish_flags(options);
  const auto columns = static_cast<std::size_t>(range_count(width, kSide));
  const auto rows = static_cast<std::size_t>(range_count(height, kSide));
  const std::size_t bytes = block_bytes(options.format);
  std::vector<std::uint8_t> blocks(rows * columns * bytes);
  parallel_ranges(height, kSide, options.threads, progress, [&](int top, int bottom) {
    std::uint8_t* block = blocks.data() + static_cast<std::size_t>(top / kSide) * columns * bytes;
    for (int left = 0; left < width; left += kSide, block += bytes) {
      const int texel_columns = std::min(kSide, width - left);
      std::array<std::uint8_t, 4 * kSide * kSide> texels{};
      int inside = 0;
      for (int y = 0; y < bottom - top; ++y) {
        const std::uint8_t* source =
            rgba + 4 * (static_cast<std::ptrdiff_t>(top + y) * width + left);
        std::copy_n(source, 4 * texel_columns, texels.data() + 4 * kSide * y);
        inside |= ((1 << texel_columns) - 1) << (kSide * y);
      }
      squish::CompressMasked(texels.data(), inside, block, flags);
    }
  });
  return blocks;
}

}  // namespace prefilter
