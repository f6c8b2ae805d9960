// SPDX-License-Identifier: GPL-3.0-or-later

// Names of temporary files.
#pragma once

#include <cstddef>
#include <string>

namespace prefilter {

/// Number of digits in `random_name` that identify this machine: half for its start, half for its
/// name.
constexpr std::size_t kMachineDigits = 8;

/// ".prefilter-" and hexadecimal digits: those of this machine, then eight random ones. Files left
/// behind by killed processes are recognized by this pattern.
std::string random_name();

}  // namespace prefilter
