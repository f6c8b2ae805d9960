// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/reconstruct/gather_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/radix_sort.h"
#include "prefilter/reconstruct/point_batches.h"

namespace prefilter {
namespace {

// Of which sums are finite.
constexpr float kLargestWeight = 1e30F;

float float_weight(const PointBatch& batch, std::size_t i) {
  return batch.weights.empty() ? 1.0F : batch.weights[i];
}

// One over the length of the point's normal; 0 where the point does not count.
float normal_scale(const PointBatch& batch, std::size_t i) {
  const Vector3& p = batch.positions[i];
  const float weight = float_weight(batch, i);
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

struct Scratch {
  SampleCells run;
  std::size_t cloud = 0;
  PointOrder order;
};

void add_point(const PointBatch& batch, std::size_t i, const SampleGrid& grid,
               std::size_t attribute_count, SampleCells* run) {
  SampleCell& cell = run->cells.back();
  const CellPosition at = cell_position(cell.key);
  const Vector3 p = grid.in_cells(batch.positions[i]);
  const float scale = normal_scale(batch, i);
  const float weight = float_weight(batch, i);
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
  const float scale = float_weight(batch, i) * normal_scale(batch, i);
  const auto& [x, y, z] = batch.normals[i];
  return scale > 0.0F ? std::array{scale * x, scale * y, scale * z} : std::array<float, 3>{};
}

bool does_count(const PointBatch& batch, std::size_t i) { return normal_scale(batch, i) > 0.0F; }

double weight_of(const PointBatch& batch, std::size_t i) {
  return static_cast<double>(float_weight(batch, i));
}

void CloudPart::include(const Vector3& point, double point_weight) {
  box.include(point);
  weight += point_weight;
  const double share = 1.0 / static_cast<double>(++points);
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = point[a] - mean[a];
    mean[a] += share * off;
    squares[a] += off * (point[a] - mean[a]);
  }
}

void CloudPart::include(const CloudPart& other) {
  if (other.points == 0) return;
  if (points == 0) {
    *this = other;
    return;
  }
  const auto own = static_cast<double>(points);
  const auto more = static_cast<double>(other.points);
  box.include(other.box);
  points += other.points;
  weight += other.weight;
  const double share = more / (own + more);
  for (std::size_t a = 0; a < 3; ++a) {
    const double off = other.mean[a] - mean[a];
    mean[a] += share * off;
    squares[a] += other.squares[a] + own * share * off * off;
  }
}

CloudExtent measure_cloud(PointSource* source, const Progress& progress, int threads,
                          ThinnedPoints* some) {
  struct Found {
    CloudExtent extent;
    std::size_t cloud = 0;
    std::vector<ThinnedPoints::Entry> entries;
  };
  CloudExtent extent;
  CloudPart own;  // of the cloud that is read
  std::size_t cloud = 0;
  for_batches<Found>(
      source, progress, threads,
      [some](const PointBatch& batch, Found* found) {
        found->extent = CloudExtent();
        found->cloud = batch.cloud;
        found->entries.clear();
        found->extent.points = batch.positions.size();
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
          if (!does_count(batch, i)) {
            ++found->extent.dropped;
            continue;
          }
          found->extent.part.include(batch.positions[i], weight_of(batch, i));
          found->extent.steps.add(batch.positions[i]);
          if (some == nullptr) continue;
          const ThinnedPoints::Entry entry = ThinnedPoints::entry_of(batch.positions[i]);
          if (some->keeps(entry)) found->entries.push_back(entry);
        }
      },
      [&](const Found& found) {
        if (found.cloud != cloud) extent.part.include(std::exchange(own, CloudPart()));
        cloud = found.cloud;
        own.include(found.extent.part);
        extent.steps.add(found.extent.steps);
        extent.points += found.extent.points;
        extent.dropped += found.extent.dropped;
        if (some != nullptr) some->add(found.entries);
      });
  extent.part.include(own);
  if (some != nullptr) some->finish();
  return extent;
}

void gather_samples(PointSource* source, const SampleGrid& grid, const Progress& progress,
                    int threads, SampleStore* store) {
  const std::size_t attribute_count = source->attributes().size();
  std::size_t cloud = 0;
  for_batches<Scratch>(
      source, progress, threads,
      [&](const PointBatch& batch, Scratch* scratch) {
        make_run(batch, grid, attribute_count, scratch);
        scratch->cloud = batch.cloud;
      },
      [&](const Scratch& scratch) {
        if (scratch.cloud != cloud) store->end_cloud();
        cloud = scratch.cloud;
        store->add(scratch.run);
      });
  store->finish(threads);
}

}  // namespace prefilter
