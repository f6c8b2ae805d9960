// SPDX-License-Identifier: GPL-3.0-or-later

// How a surface is made within a limit of memory, and what it takes at the least.
#pragma once

#include <cstddef>
#include <cstdint>

#include "prefilter/points/reconstruct.h"
#include "prefilter/points/reconstruct/sample_store.h"

namespace prefilter {

/// What a cloud is like, as far as memory goes.
struct CloudLoad {
  std::size_t points = 0;
  std::size_t attributes = 0;
  WaveletBasis basis = WaveletBasis::kHaar;
  bool is_simplified = false;  // the mesh
};

struct MemoryPlan {
  int threads = 1;         // so many slabs at a time
  bool keeps_all = false;  // slabs are made once, and kept until they are needed no more
  bool is_held = true;     // the cells that a store holds may stay in memory
  std::uint64_t left = 0;  // bytes for the mesh, where that has to be kept
};

/// How many batches of points may be in memory at a time.
int batches_at_once(const CloudLoad& load, const ReconstructOptions& options);

/// The bytes that are needed once all samples are in a store, for so many slabs at a time, without
/// what the store holds. Measured, see tests/python/test_memory_limit.py: neither less than what is
/// taken nor a third more, but for some MiB.
double bytes_needed(const SampleStore& store, const CloudLoad& load, bool keeps_all, int threads);

/// The fastest way within the limit. A limit of 0 stands for as little as can be. Throws Error
/// where the limit is less than that; the message says how much would do.
MemoryPlan plan_memory(const SampleStore& store, const CloudLoad& load,
                       const ReconstructOptions& options);

}  // namespace prefilter
