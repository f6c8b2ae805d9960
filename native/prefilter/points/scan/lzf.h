// SPDX-License-Identifier: GPL-3.0-or-later

// The compression of Marc Lehmann's LibLZF, which point clouds of PCL have.
#pragma once

#include <cstdint>

#include "prefilter/base/io/byte_reader.h"
#include "prefilter/base/io/temporary_file.h"

namespace prefilter {

/// Decodes the next `compressed` bytes of a file, which must give `plain` bytes, without holding
/// more than a few blocks of them. Throws Error where they are damaged; the message names the file.
void decode_lzf(ByteReader* from, std::uint64_t compressed, std::uint64_t plain, TemporaryFile* to);

}  // namespace prefilter
