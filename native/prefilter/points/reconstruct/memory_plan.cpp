// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/memory_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/points/reconstruct/gather_samples.h"

namespace prefilter {
namespace {

constexpr double kMib = 1 << 20;
constexpr auto kFloat = static_cast<double>(sizeof(float));

// Of a point in a batch, with its place in the order of cells and its sums.
constexpr double kBytesPerPoint = 110.0;
// Of a finest cell of the samples, with those above it, in all stages; attributes are in those of
// all depths.
constexpr double kBytesPerCell = 190.0;
// In the D4 basis, which has no solve; and the same for each cell that the surface meets.
constexpr double kD4BytesPerCell = 100.0;
constexpr double kD4BytesPerMetCell = 180.0;
constexpr double kDepths = 1.4;
// Of a triangle of a slab that is made, with its leaves, edges and vertices.
constexpr double kBytesPerTriangle = 330.0;
// While a slab's part of the mesh is simplified, one at a time.
constexpr double kSimplifiedBytesPerTriangle = 170.0;
constexpr double kVerticesPerTriangle = 1.0;  // twice the half, as they are copied
constexpr double kTrianglesPerMetCell = 2.1;
// So many slabs to both sides of those at work are in memory, or as much as these take: see
// Slabs::bring.
constexpr int kMargin = 2;
// What does not depend on the cloud.
constexpr double kAlways = 4.0 * kMib;

// How many cells the surface meets for each that has samples: more, where these are few. Of samples
// at random, 1 / (1 - exp(-x)) where cells with samples have x / (1 - exp(-x)) in the mean, which
// this exceeds; leaves are larger where there are still fewer.
double met_cells_per_cell(double points_per_cell) {
  constexpr double kMost = 2.0;
  return std::min(kMost, 1.0 + 0.45 / std::max(points_per_cell - 1.0, 1e-3));
}

// Cells of so many neighboring slabs, at the most.
double cells_of_slabs(const SampleStore& store, int count) {
  double most = 0.0;
  double sum = 0.0;
  for (int s = 0; s < store.slab_count(); ++s) {
    sum += static_cast<double>(store.size(s));
    if (s >= count) sum -= static_cast<double>(store.size(s - count));
    most = std::max(most, sum);
  }
  return most;
}

double batch_bytes(const CloudLoad& load) {
  const auto attributes = static_cast<double>(load.attributes);
  const double points = static_cast<double>(std::min(load.points, PointOrder::kMostPoints));
  return points * (kBytesPerPoint + 2.0 * kFloat * attributes);
}

std::uint64_t as_bytes(double bytes) {
  constexpr double kMost = 0x1p63;
  return bytes < kMost ? static_cast<std::uint64_t>(std::max(bytes, 0.0))
                       : std::numeric_limits<std::uint64_t>::max();
}

std::string in_mib(double bytes) {
  return std::to_string(static_cast<std::uint64_t>(std::ceil(bytes / kMib)));
}

}  // namespace

int batches_at_once(const CloudLoad& load, const ReconstructOptions& options) {
  const double half = static_cast<double>(options.memory_limit) / 2.0;
  const int most = resolve_threads(options.threads);
  const double fit = std::floor(half / std::max(batch_bytes(load), 1.0));
  return fit >= most ? most : std::max(1, static_cast<int>(fit));
}

double bytes_needed(const SampleStore& store, const CloudLoad& load, bool keeps_all, int threads) {
  const bool is_d4 = load.basis == WaveletBasis::kD4;
  const auto attributes = static_cast<double>(load.attributes);
  const double cells = static_cast<double>(std::max<std::size_t>(store.size(), 1));
  const double kept = is_d4 || keeps_all ? cells : cells_of_slabs(store, threads + 2 * kMargin);
  const double met = met_cells_per_cell(static_cast<double>(load.points) / cells);
  const double per_cell = (is_d4 ? kD4BytesPerCell + met * kD4BytesPerMetCell : kBytesPerCell) +
                          kDepths * kFloat * attributes;
  const double triangles = kTrianglesPerMetCell * met * cells_of_slabs(store, threads);
  const double per_triangle = kBytesPerTriangle + kVerticesPerTriangle * kFloat * attributes;
  double bytes = kept * per_cell + triangles * per_triangle;
  if (load.is_simplified) {
    const double most = kTrianglesPerMetCell * met * cells_of_slabs(store, 1);
    bytes += most * (kSimplifiedBytesPerTriangle + kVerticesPerTriangle * kFloat * attributes);
  }
  return kAlways + std::max(batch_bytes(load), bytes);
}

MemoryPlan plan_memory(const SampleStore& store, const CloudLoad& load,
                       const ReconstructOptions& options) {
  const auto limit = static_cast<double>(options.memory_limit);
  const double held = static_cast<double>(store.held_bytes());
  // The D4 basis needs all slabs at once.
  const bool is_all = load.basis == WaveletBasis::kD4;
  const int most = resolve_threads(options.threads);
  for (const bool keeps_all : {true, false}) {
    // What was written to a file is not kept.
    if (keeps_all && store.is_spilled() && !is_all) continue;
    for (int threads = most; threads > 0; --threads) {
      const double needed = bytes_needed(store, load, keeps_all || is_all, threads);
      // Slabs that are kept take their cells out of the store.
      const double stays = keeps_all ? 0.0 : held;
      const double left = limit - needed;
      if (stays <= left) return {threads, keeps_all || is_all, true, as_bytes(left - stays)};
      if (left >= 0.0 && !keeps_all) return {threads, is_all, false, as_bytes(left)};
    }
  }
  if (options.memory_limit > 0) {
    throw_invalid("memory_limit: " + in_mib(limit) + " MiB; at least " +
                  in_mib(bytes_needed(store, load, is_all, 1)) + " MiB are needed for " +
                  std::to_string(store.size()) + " cells, fewer of them for a smaller depth");
  }
  return {1, is_all, false};
}

}  // namespace prefilter
