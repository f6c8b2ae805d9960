// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/supercompress.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
#include <new>
#include <string>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr int kZstdLevel = 18;  // of 22
constexpr std::size_t kBytesPerCall = 128 << 10;

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

void check(std::size_t result) {
  if (ZSTD_isError(result) != 0) throw std::bad_alloc();
}

}  // namespace

std::vector<std::uint8_t> supercompress(const std::uint8_t* bytes, std::size_t count,
                                        const Run& run) {
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (context == nullptr) throw std::bad_alloc();
  check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kZstdLevel));
  check(ZSTD_CCtx_setPledgedSrcSize(context.get(), count));
  std::vector<std::uint8_t> frame(ZSTD_compressBound(count));
  ZSTD_outBuffer output{frame.data(), frame.size(), 0};
  for (std::size_t start = 0;;) {
    const std::size_t end = std::min(start + kBytesPerCall, count);
    const bool is_last = end == count;
    ZSTD_inBuffer input{bytes + start, end - start, 0};
    // The output has room for the whole frame, so each call consumes its input.
    check(ZSTD_compressStream2(context.get(), &output, &input,
                               is_last ? ZSTD_e_end : ZSTD_e_continue));
    run.report(is_last ? 1.0 : static_cast<double>(end) / static_cast<double>(count));
    if (is_last) break;
    start = end;
  }
  frame.resize(output.pos);
  return frame;
}

std::vector<std::uint8_t> decompress(std::span<const std::uint8_t> frames, std::size_t count) {
  // The densest frame is all zeros: 128 KiB per block of 4 bytes.
  constexpr std::size_t kMaxRatio = 1 << 15;
  if (count / kMaxRatio > frames.size()) {
    throw_invalid("levels: " + std::to_string(frames.size()) + " bytes of zstd cannot hold " +
                  std::to_string(count));
  }
  std::vector<std::uint8_t> bytes(count);
  const std::size_t size = ZSTD_decompress(bytes.data(), count, frames.data(), frames.size());
  if (ZSTD_isError(size) != 0) {
    throw_invalid("levels: zstd says: " + std::string(ZSTD_getErrorName(size)));
  }
  if (size != count) {
    throw_invalid("levels: " + std::to_string(size) + " bytes where " + std::to_string(count) +
                  " are needed");
  }
  return bytes;
}

}  // namespace prefilter
