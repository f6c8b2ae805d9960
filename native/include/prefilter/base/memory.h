// SPDX-License-Identifier: GPL-3.0-or-later

// How much memory there is, so that work too large for it is refused before it begins.
#pragma once

#include <cstdint>
#include <string>

namespace prefilter {

/// Bytes that can be had without driving others out; where the system does not tell, as many as
/// there can be.
std::uint64_t available_memory();

/// Throws Error(kOutOfMemory) where work needs more bytes than there are: "<what> needs about 12
/// GB; 7.5 GB are free".
void check_memory(const std::string& what, double bytes);

}  // namespace prefilter
