// SPDX-License-Identifier: GPL-3.0-or-later

// Plans a reconstruction within a memory limit, and computes the minimum.
#pragma once

#include <cstddef>
#include <cstdint>

#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/sample_store.h"

namespace prefilter {

/// Properties of a cloud that determine the memory use.
struct CloudLoad {
  std::size_t points = 0;
  std::size_t attributes = 0;
  WaveletBasis basis = WaveletBasis::kHaar;
  bool is_simplified = false;  // whether the mesh is simplified
};

struct MemoryPlan {
  int threads = 1;         // number of slabs processed at a time
  bool keeps_all = false;  // each slab is processed once and kept until it is no longer needed
  bool is_held = true;     // the cells of the store may stay in memory
  std::uint64_t left = 0;  // bytes left for the mesh, where it has to be stored
};

/// Number of batches of points that fit into memory at a time.
int batches_at_once(const CloudLoad& load, const ReconstructOptions& options);

/// Bytes needed after all samples are in a store, for `threads` slabs at a time, excluding the
/// store's own. Measured (tests/python/test_memory_limit.py): never below the actual use, and above
/// it by at most a third plus some MiB.
double bytes_needed(const SampleStore& store, const CloudLoad& load, bool keeps_all, int threads);

/// Chooses the fastest plan within the limit. A limit of 0 requests the minimum. Throws Error where
/// the limit is below the minimum; the message states the minimum.
MemoryPlan plan_memory(const SampleStore& store, const CloudLoad& load,
                       const ReconstructOptions& options);

}  // namespace prefilter
