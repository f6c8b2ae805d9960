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

constexpr int kEffort = 18;  // of 22
constexpr std::size_t kBytesAtOnce = 128 << 10;

struct FreeContext {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};

void check(std::size_t result) {
  if (ZSTD_isError(result) != 0) throw std::bad_alloc();
}

}  // namespace

std::vector<std::uint8_t> supercompress(const std::uint8_t* bytes, std::size_t count,
                                        const Progress& progress) {
  const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
  if (context == nullptr) throw std::bad_alloc();
  check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kEffort));
  check(ZSTD_CCtx_setPledgedSrcSize(context.get(), count));
  std::vector<std::uint8_t> frame(ZSTD_compressBound(count));
  ZSTD_outBuffer output{frame.data(), frame.size(), 0};
  for (std::size_t start = 0;;) {
    const std::size_t end = std::min(start + kBytesAtOnce, count);
    const bool is_last = end == count;
    ZSTD_inBuffer input{bytes + start, end - start, 0};
    // There is room for all of the frame, so a call takes its whole input.
    check(ZSTD_compressStream2(context.get(), &output, &input,
                               is_last ? ZSTD_e_end : ZSTD_e_continue));
    progress.report(is_last ? 1.0 : static_cast<double>(end) / static_cast<double>(count));
    if (is_last) break;
    start = end;
  }
  frame.resize(output.pos);
  return frame;
}

std::vector<std::uint8_t> decompress(std::span<const std::uint8_t> frames, std::size_t count) {
  // A frame of zeros is the densest: 128 KiB in a block of 4 bytes.
  constexpr std::size_t kMostRatio = 1 << 15;
  if (count / kMostRatio > frames.size()) {
    throw_invalid("levels: " + std::to_string(frames.size()) + " bytes of zstd cannot hold " +
                  std::to_string(count));
  }
  std::vector<std::uint8_t> bytes(count);
  const std::size_t found = ZSTD_decompress(bytes.data(), count, frames.data(), frames.size());
  if (ZSTD_isError(found) != 0) {
    throw_invalid("levels: zstd says: " + std::string(ZSTD_getErrorName(found)));
  }
  if (found != count) {
    throw_invalid("levels: " + std::to_string(found) + " bytes where " + std::to_string(count) +
                  " are needed");
  }
  return bytes;
}

}  // namespace prefilter
