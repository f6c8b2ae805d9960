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

// Bytes per point of a batch, including its entry in the sorted order and its sums.
constexpr double kBytesPerPoint = 110.0;
// Bytes per finest sample cell, ancestors included, summed over all stages. Attributes are stored
// at every depth and come on top.
constexpr double kBytesPerCell = 190.0;
// The same in the D4 basis, which has no solve: per cell with samples, and per cell that the
// surface crosses.
constexpr double kD4BytesPerCell = 100.0;
constexpr double kD4BytesPerCrossedCell = 180.0;
constexpr double kCellsPerFinestCell = 1.4;
// Bytes per triangle of a slab while it is contoured, including its leaves, edges and vertices.
constexpr double kBytesPerTriangle = 330.0;
// Additional bytes per triangle while a slab's part of the mesh is simplified, one slab at a time.
constexpr double kSimplifiedBytesPerTriangle = 170.0;
constexpr double kVerticesPerTriangle = 1.0;  // twice the half, as they are copied
constexpr double kTrianglesPerCrossedCell = 2.1;
// Slabs kept on each side of those in work: see Slabs::advance_to.
constexpr int kMargin = 2;
// Bytes that do not depend on the cloud.
constexpr double kFixedBytes = 4.0 * kMib;

// Cells that the surface crosses per cell with samples; more where samples are sparse. For randomly
// placed samples with a mean of x per crossed cell it is 1 / (1 - exp(-x)), while occupied cells
// hold x / (1 - exp(-x)) on average. The expression below is an upper bound; still sparser samples
// get larger leaves.
double crossed_cells_per_cell(double points_per_cell) {
  constexpr double kMost = 2.0;  // sparser samples get larger leaves
  return std::min(kMost, 1.0 + 0.45 / std::max(points_per_cell - 1.0, 1e-3));
}

// Largest number of cells in `count` consecutive slabs.
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
  const double points = static_cast<double>(std::min(load.points, PointOrder::kMaxPoints));
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
  const int most = resolve_threads(options.run.threads());
  const double fit = std::floor(half / std::max(batch_bytes(load), 1.0));
  return fit >= most ? most : std::max(1, static_cast<int>(fit));
}

double bytes_needed(const SampleStore& store, const CloudLoad& load, bool keeps_all, int threads) {
  const bool is_d4 = load.basis == WaveletBasis::kD4;
  const auto attributes = static_cast<double>(load.attributes);
  const double cells = static_cast<double>(std::max<std::size_t>(store.size(), 1));
  const double kept = is_d4 || keeps_all ? cells : cells_of_slabs(store, threads + 2 * kMargin);
  const double crossed = crossed_cells_per_cell(static_cast<double>(load.points) / cells);
  const double per_cell =
      (is_d4 ? kD4BytesPerCell + crossed * kD4BytesPerCrossedCell : kBytesPerCell) +
      kCellsPerFinestCell * kFloat * attributes;
  const double triangles = kTrianglesPerCrossedCell * crossed * cells_of_slabs(store, threads);
  const double per_triangle = kBytesPerTriangle + kVerticesPerTriangle * kFloat * attributes;
  double bytes = kept * per_cell + triangles * per_triangle;
  if (load.is_simplified) {
    const double most = kTrianglesPerCrossedCell * crossed * cells_of_slabs(store, 1);
    bytes += most * (kSimplifiedBytesPerTriangle + kVerticesPerTriangle * kFloat * attributes);
  }
  return kFixedBytes + std::max(batch_bytes(load), bytes);
}

MemoryPlan plan_memory(const SampleStore& store, const CloudLoad& load,
                       const ReconstructOptions& options) {
  const auto limit = static_cast<double>(options.memory_limit);
  const double held = static_cast<double>(store.held_bytes());
  // The D4 basis needs all slabs at once.
  const bool is_all = load.basis == WaveletBasis::kD4;
  const int most = resolve_threads(options.run.threads());
  for (const bool keeps_all : {true, false}) {
    // Cells in a file are not kept in memory.
    if (keeps_all && store.is_spilled() && !is_all) continue;
    for (int threads = most; threads > 0; --threads) {
      const double needed = bytes_needed(store, load, keeps_all || is_all, threads);
      // Slabs that are kept move their cells out of the store.
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
