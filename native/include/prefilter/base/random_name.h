// SPDX-License-Identifier: GPL-3.0-or-later

// What files are called until they are put in place.
#pragma once

#include <cstddef>
#include <string>

namespace prefilter {

/// The digits of `random_name` that stand for this machine: its start and its name, four of each.
constexpr std::size_t kMachineDigits = 8;

/// ".prefilter-" and hexadecimal digits: those of this machine, and then eight that nobody else
/// thinks of. What is left of a process that was killed is known by them.
std::string random_name();

}  // namespace prefilter
