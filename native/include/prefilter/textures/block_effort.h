// SPDX-License-Identifier: GPL-3.0-or-later

// How much time encoders take to search for closer blocks.
#pragma once

#include <string>

namespace prefilter {

enum class BlockEffort { kFast, kNormal, kBest };

/// "fast", "normal" or "best". Throws Error for any other name.
BlockEffort block_effort_named(const std::string& name);

}  // namespace prefilter
