// SPDX-License-Identifier: GPL-3.0-or-later

// Available memory, to refuse work that is too large before it starts.
#pragma once

#include <cstdint>
#include <string>

namespace prefilter {

/// Bytes that can be allocated without swapping; the largest possible number if unknown.
std::uint64_t available_memory();

/// Throws Error(kOutOfMemory) if more bytes are needed than available: "<what> needs about 12 GB;
/// 7.5 GB are free".
void check_memory(const std::string& what, double bytes);

}  // namespace prefilter
