// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/gather_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/parallel.h"
#include "prefilter/base/radix_sort.h"

namespace prefilter {
namespace {

// Of which sums are finite.
constexpr float kLargestWeight = 1e30F;

float weight_of(const PointBatch& batch, std::size_t i) {
  return batch.weights.empty() ? 1.0F : batch.weights[i];
}

// One over the length of the point's normal; 0 where the point does not count.
float normal_scale(const PointBatch& batch, std::size_t i) {
  const Vector3& p = batch.positions[i];
  const float weight = weight_of(batch, i);
  const auto& [x, y, z] = batch.normals[i];
  const float squared = x * x + y * y + z * z;
  const double sum = std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]);
  if (!(sum <= kLargestCoordinate) || !(weight > 0.0F) || !(weight <= kLargestWeight)) {
    return 0.0F;
  }
  if (squared > 1e-30F && squared < 1e30F) return 1.0F / std::sqrt(squared);
  const double length =
      elementary::hypot(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  return length > 1e-37 && std::isfinite(length) ? static_cast<float>(1.0 / length) : 0.0F;
}

// Reads batches, hands some at a time to threads, and joins what these make of them in order.
template <typename Part, typename Make, typename Join>
void for_batches(PointSource* source, const Progress& progress, int threads, const Make& make,
                 const Join& join) {
  const auto width = static_cast<std::size_t>(resolve_threads(threads));
  std::vector<PointBatch> batches(width);
  std::vector<Part> parts(width);
  const double count = static_cast<double>(source->count().value_or(0));
  std::size_t done = 0;
  source->rewind();
  for (bool is_more = true; is_more;) {
    std::size_t filled = 0;
    while (filled < width) {
      is_more = source->read(PointOrder::kMostPoints, &batches[filled]);
      if (!is_more) break;
      done += batches[filled].positions.size();
      ++filled;
    }
    parallel_for(static_cast<std::int64_t>(filled), threads, Progress(), [&](std::int64_t i) {
      make(batches[static_cast<std::size_t>(i)], &parts[static_cast<std::size_t>(i)]);
    });
    for (std::size_t i = 0; i < filled; ++i) join(parts[i]);
    progress.report(count > 0.0 ? std::min(1.0, static_cast<double>(done) / count) : 0.0);
  }
}

struct Scratch {
  SampleCells run;
  PointOrder order;
};

void add_point(const PointBatch& batch, std::size_t i, const SampleGrid& grid,
               std::size_t attribute_count, SampleCells* run) {
  SampleCell& cell = run->cells.back();
  const CellPosition at = cell_position(cell.key);
  const Vector3 p = grid.in_cells(batch.positions[i]);
  const float scale = normal_scale(batch, i);
  const float weight = weight_of(batch, i);
  const std::array<float, 3> n = grid.turned(batch.normals[i]);
  cell.weight += weight;
  for (std::size_t a = 0; a < 3; ++a) {
    const float along = weight * scale * n[a];
    const auto within = static_cast<float>(p[a] - at[a]);
    cell.normal[a] += along;
    cell.position[a] += weight * within;
    cell.flux[a] += along * within;
  }
  float* const sums = run->attributes.data() + run->attributes.size() - attribute_count;
  for (std::size_t k = 0; k < attribute_count; ++k) {
    sums[k] += weight * batch.attributes[i * attribute_count + k];
  }
}

void make_run(const PointBatch& batch, const SampleGrid& grid, std::size_t attribute_count,
              Scratch* scratch) {
  SampleCells& run = scratch->run;
  run.cells.clear();
  run.attributes.clear();
  for (const std::uint64_t entry : scratch->order.sort(batch, grid)) {
    const CellKey key = PointOrder::key(entry);
    if (run.cells.empty() || run.cells.back().key != key) {
      run.cells.emplace_back();
      run.cells.back().key = key;
      run.attributes.resize(run.attributes.size() + attribute_count);
    }
    add_point(batch, PointOrder::index(entry), grid, attribute_count, &run);
  }
}

}  // namespace

const std::vector<std::uint64_t>& PointOrder::sort(const PointBatch& batch,
                                                   const SampleGrid& grid) {
  order_.clear();
  const double last = std::ldexp(1.0, grid.depth) - 1.0;
  for (std::size_t i = 0; i < batch.positions.size(); ++i) {
    if (!(normal_scale(batch, i) > 0.0F)) continue;
    const Vector3 p = grid.in_cells(batch.positions[i]);
    CellPosition at;
    for (std::size_t a = 0; a < 3; ++a) {
      at[a] = static_cast<std::int32_t>(std::clamp(std::floor(p[a]), 0.0, last));
    }
    order_.push_back(cell_key(at) << kBatchBits | i);
  }
  radix_sort(&order_, kBatchBits, kBatchBits + kKeyBits, &other_);
  return order_;
}

std::array<float, 3> weighted_normal(const PointBatch& batch, std::size_t i) {
  const float scale = weight_of(batch, i) * normal_scale(batch, i);
  const auto& [x, y, z] = batch.normals[i];
  return scale > 0.0F ? std::array{scale * x, scale * y, scale * z} : std::array<float, 3>{};
}

CloudExtent measure_cloud(PointSource* source, const Progress& progress, int threads) {
  CloudExtent extent;
  for_batches<CloudExtent>(
      source, progress, threads,
      [](const PointBatch& batch, CloudExtent* part) {
        *part = CloudExtent();
        part->points = batch.positions.size();
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
          if (normal_scale(batch, i) > 0.0F) {
            part->box.include(batch.positions[i]);
            part->weight += static_cast<double>(weight_of(batch, i));
          } else {
            ++part->dropped;
          }
        }
      },
      [&](const CloudExtent& part) {
        extent.box.include(part.box);
        extent.points += part.points;
        extent.dropped += part.dropped;
        extent.weight += part.weight;
      });
  return extent;
}

void gather_samples(PointSource* source, const SampleGrid& grid, const Progress& progress,
                    int threads, SampleStore* store) {
  const std::size_t attribute_count = source->attributes().size();
  for_batches<Scratch>(
      source, progress, threads,
      [&](const PointBatch& batch, Scratch* scratch) {
        make_run(batch, grid, attribute_count, scratch);
      },
      [&](const Scratch& scratch) { store->add(scratch.run); });
  store->finish(threads);
}

}  // namespace prefilter
