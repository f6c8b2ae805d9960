// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a source's points in one thread and processes them in several.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "prefilter/base/parallel.h"
#include "prefilter/base/run.h"
#include "prefilter/points/point_source.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {

/// Reads batches, calls make(batch, &part) for several at a time, and join(part) in order.
template <typename Part, typename Make, typename Join>
void for_batches(PointSource* source, const Run& run, const Make& make, const Join& join) {
  const auto width = static_cast<std::size_t>(resolve_threads(run.threads()));
  std::vector<PointBatch> batches(width);
  std::vector<Part> parts(width);
  const double count = static_cast<double>(source->count().value_or(0));
  std::size_t done = 0;
  source->rewind();
  for (bool is_more = true; is_more;) {
    std::size_t filled = 0;
    while (filled < width) {
      is_more = source->read(PointOrder::kMaxPoints, &batches[filled]);
      if (!is_more) break;
      done += batches[filled].positions.size();
      ++filled;
    }
    parallel_for(static_cast<std::int64_t>(filled), Run(run.threads()), [&](std::int64_t i) {
      make(batches[static_cast<std::size_t>(i)], &parts[static_cast<std::size_t>(i)]);
    });
    for (std::size_t i = 0; i < filled; ++i) join(parts[i]);
    run.report(count > 0.0 ? std::min(1.0, static_cast<double>(done) / count) : 0.0);
  }
}

}  // namespace prefilter
