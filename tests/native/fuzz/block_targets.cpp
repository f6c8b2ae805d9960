// SPDX-License-Identifier: GPL-3.0-or-later

#include <algorithm>
#include <array>

#include "fuzz/targets.h"
#include "prefilter/base/error.h"
#include "prefilter/base/run.h"
#include "prefilter/textures/decode_blocks.h"
#include "prefilter/textures/supercompress.h"

namespace prefilter {
namespace {

// Takes bytes from the front; fewer where there are no more.
std::span<const std::uint8_t> take(std::size_t count, std::span<const std::uint8_t>* rest) {
  const auto taken = rest->first(std::min(count, rest->size()));
  *rest = rest->subspan(taken.size());
  return taken;
}

// A little-endian number of so many bytes; missing bytes are 0.
std::uint32_t take_number(std::size_t bytes, std::span<const std::uint8_t>* rest) {
  std::uint32_t number = 0;
  int shift = 0;
  for (const std::uint8_t byte : take(bytes, rest)) {
    number |= static_cast<std::uint32_t>(byte) << shift;
    shift += 8;
  }
  return number;
}

}  // namespace

void read_blocks(std::span<const std::uint8_t> bytes) {
  const auto layouts = block_layouts();
  const BlockLayout& layout = layouts[take_number(1, &bytes) % layouts.size()];
  const int width = static_cast<int>(take_number(1, &bytes));
  const int height = static_cast<int>(take_number(1, &bytes));
  const DecodeOptions options{.format = layout.format, .is_srgb = width % 2 == 0};
  try {
    if (layout.is_float) {
      decode_half_blocks(bytes, width, height, options, prefilter::Run());
    } else {
      decode_blocks(bytes, width, height, options, prefilter::Run());
    }
  } catch (const Error&) {
  }
}

void read_etc1s(std::span<const std::uint8_t> bytes) {
  std::array<std::uint32_t, 6> numbers{};
  for (std::uint32_t& number : numbers) number = take_number(2, &bytes);
  Etc1sLevel level;
  level.width = static_cast<int>(take_number(1, &bytes));
  level.height = static_cast<int>(take_number(1, &bytes));
  Etc1sCodebooks codebooks;
  codebooks.endpoint_count = static_cast<int>(numbers[0]);
  codebooks.selector_count = static_cast<int>(numbers[1]);
  codebooks.endpoints = take(numbers[2], &bytes);
  codebooks.selectors = take(numbers[3], &bytes);
  codebooks.tables = take(numbers[4], &bytes);
  level.color = take(numbers[5], &bytes);
  level.alpha = bytes;
  try {
    decode_etc1s(codebooks, {&level, 1}, prefilter::Run());
  } catch (const Error&) {
  }
}

void read_zstd(std::span<const std::uint8_t> bytes) {
  // As many as a level has that a fuzzer can fill a thousand times a second.
  constexpr std::uint32_t kMost = 1 << 20;
  const std::uint32_t count = take_number(4, &bytes) % kMost;
  try {
    decompress(bytes, count);
  } catch (const Error&) {
  }
}

}  // namespace prefilter
