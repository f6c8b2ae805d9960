// SPDX-License-Identifier: GPL-3.0-or-later

// Levels of a texture file compressed once more, without loss, as KTX 2 files may hold them;
// and back.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/base/progress.h"

namespace prefilter {

/// The bytes as one frame of zstd (RFC 8878) that tells their number. The same for all processors.
///
/// Throws Error where `progress` cancels.
std::vector<std::uint8_t> supercompress(const std::uint8_t* bytes, std::size_t count,
                                        const Progress& progress);

/// What frames of zstd hold, which is `count` bytes.
///
/// Throws Error where they hold anything else or are damaged.
std::vector<std::uint8_t> decompress(std::span<const std::uint8_t> frames, std::size_t count);

}  // namespace prefilter
