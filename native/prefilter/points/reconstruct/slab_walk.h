// SPDX-License-Identifier: GPL-3.0-or-later

// Processes all slabs of a cloud from bottom to top, with few in memory at a time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "prefilter/base/parallel.h"
#include "prefilter/base/run.h"
#include "prefilter/points/reconstruct/slabs.h"

namespace prefilter {

/// How for_slabs advances and drops slabs.
struct SlabWalk {
  SlabStage stage = SlabStage::kNone;
  int margin = 0;        // slabs on each side that are advanced as well
  bool is_last = false;  // the last walk: slabs are dropped even if all are kept
  int begin = 0;         // first slab
  int end = std::numeric_limits<int>::max();
};

/// Advances slabs to a stage, several at a time with their neighbors, and calls visit(s) for each
/// in any thread and then join(s) in order. Unless all are kept, slabs are dropped as soon as no
/// other one needs them, and none is processed twice.
template <typename Visit, typename Join>
void for_slabs(const SlabWalk& walk, const Run& run, Slabs* slabs, const Visit& visit,
               const Join& join) {
  // The next slabs depend at most on the one below them.
  const int reach = std::max(walk.margin, 1);
  const int width = resolve_threads(run.threads());
  const int last = std::min(walk.end, slabs->count());
  for (int begin = walk.begin; begin < last; begin += width) {
    const int end = std::min(begin + width, last);
    slabs->advance_to(begin - walk.margin, end + walk.margin, walk.stage);
    parallel_for(end - begin, Run(run.threads()),
                 [&](std::int64_t i) { visit(begin + static_cast<int>(i)); });
    for (int s = begin; s < end; ++s) join(s);
    slabs->drop_below(end - reach, walk.is_last);
    run.report(static_cast<double>(end - walk.begin) / (last - walk.begin));
  }
  slabs->drop_below(slabs->count(), walk.is_last);
}

}  // namespace prefilter
