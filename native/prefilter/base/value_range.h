// SPDX-License-Identifier: GPL-3.0-or-later

// Ranges of values.
#pragma once

namespace prefilter {

/// Lowest and highest value a channel may take.
struct ValueRange {
  float low;
  float high;
};

}  // namespace prefilter
