// SPDX-License-Identifier: GPL-3.0-or-later

// Lossless compression of the levels of a texture file with zstd, as in KTX 2 files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/run.h"

namespace prefilter {

/// Compresses bytes to one zstd frame (RFC 8878) that records their number. The result is the same
/// on all processors. Throws Error if `progress` cancels.
std::vector<std::uint8_t> supercompress(const std::uint8_t* bytes, std::size_t count,
                                        const Run& run);

/// Decompresses zstd frames to exactly `count` bytes. Throws Error if they are damaged or hold a
/// different number of bytes.
std::vector<std::uint8_t> decompress(std::span<const std::uint8_t> frames, std::size_t count);

}  // namespace prefilter
