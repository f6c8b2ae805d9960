// SPDX-License-Identifier: GPL-3.0-or-later

// Ranges of values.
#pragma once

namespace prefilter {

/// Lowest and highest value of a channel.
struct ValueRange {
  float low;
  float high;
};

}  // namespace prefilter
