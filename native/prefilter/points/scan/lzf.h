// SPDX-License-Identifier: GPL-3.0-or-later

// Decoder for Marc Lehmann's LibLZF, which PCL uses for point clouds.
#pragma once

#include <cstdint>

#include "prefilter/base/io/byte_reader.h"
#include "prefilter/base/io/temporary_file.h"

namespace prefilter {

/// Decodes the next `compressed` bytes of a file, which must yield `plain` bytes, with a few blocks
/// in memory. Throws Error for damaged data; the message names the file.
void decode_lzf(ByteReader* from, std::uint64_t compressed, std::uint64_t plain, TemporaryFile* to);

}  // namespace prefilter
