// SPDX-License-Identifier: GPL-3.0-or-later

// All slabs of a cloud, from below, with few in memory at a time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "prefilter/base/parallel.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// What a walk brings slabs to.
struct SlabWalk {
  SlabStage stage = SlabStage::kNone;
  int margin = 0;        // so many slabs to both sides of a slab are to be there, too
  bool is_last = false;  // slabs are forgotten for good
  int begin = 0;         // the slabs
  int end = std::numeric_limits<int>::max();
};

/// Bring(s) slabs to a stage, some at a time with those next to them, and calls visit(s) for
/// each, on any thread, and then join(s), in order. Without a reason to keep them slabs are
/// forgotten as soon as no other one needs them, and none is made twice.
template <typename Visit, typename Join>
void for_slabs(const SlabWalk& walk, const Progress& progress, int threads, Slabs* slabs,
               const Visit& visit, const Join& join) {
  // What the next slabs are made from is that of the one below them, at the most.
  const int reach = std::max(walk.margin, 1);
  const int width = resolve_threads(threads);
  const int last = std::min(walk.end, slabs->count());
  for (int begin = walk.begin; begin < last; begin += width) {
    const int end = std::min(begin + width, last);
    slabs->bring(begin - walk.margin, end + walk.margin, walk.stage);
    parallel_for(end - begin, threads, Progress(),
                 [&](std::int64_t i) { visit(begin + static_cast<int>(i)); });
    for (int s = begin; s < end; ++s) join(s);
    slabs->drop_below(end - reach, walk.is_last);
    progress.report(static_cast<double>(end - walk.begin) / (last - walk.begin));
  }
  slabs->drop_below(slabs->count(), walk.is_last);
}

}  // namespace prefilter
