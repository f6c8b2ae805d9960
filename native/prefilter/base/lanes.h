// SPDX-License-Identifier: GPL-3.0-or-later

// SIMD vectors of up to four channels.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/vectors.h"

namespace prefilter {

/// A float for each of kMaxChannels channels; unused ones are arbitrary.
using Lanes = Vector<float, kMaxChannels>;

inline Lanes lane_max(Lanes a, Lanes b) { return select(a > b, a, b); }
inline Lanes lane_min(Lanes a, Lanes b) { return select(a < b, a, b); }

/// A wrapper for use as a template argument, where vector attributes would be lost.
struct LaneValues {
  Lanes v{};
};

}  // namespace prefilter
