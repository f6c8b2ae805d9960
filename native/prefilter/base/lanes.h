// SPDX-License-Identifier: GPL-3.0-or-later

// Up to four channels, added and multiplied together by the processor.
#pragma once

#include "prefilter/base/image.h"
#include "prefilter/base/vectors.h"

namespace prefilter {

/// A float for each of kMaxChannels channels; those that an image lacks are unused.
using Lanes = Vector<float, kMaxChannels>;

inline Lanes lane_max(Lanes a, Lanes b) { return select(a > b, a, b); }
inline Lanes lane_min(Lanes a, Lanes b) { return select(a < b, a, b); }

/// A vector of the processor where a template argument is needed.
struct LaneValues {
  Lanes v{};
};

}  // namespace prefilter
