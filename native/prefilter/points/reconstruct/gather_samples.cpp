// SPDX-License-Identifier: GPL-3.0-or-later

// Two passes over the points: their extent, which determines the grid, and their sums per cell,
// from which Equation 4.2 is computed instead of from single points.
#include "prefilter/points/reconstruct/gather_samples.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/radix_sort.h"
#include "prefilter/points/reconstruct/normal_probe.h"
#include "prefilter/points/reconstruct/phantom_points.h"
#include "prefilter/points/reconstruct/point_batches.h"

namespace prefilter {
namespace {

// Weights up to this keep all sums finite.
constexpr float kLargestWeight = 1e30F;
// Scanners may write the largest single-precision number where they got no return.
constexpr double kHugeCoordinate = 1e30;
// Huge points are dropped only if at least 1 / 100 as many others are left.
constexpr std::size_t kHugePerOther = 100;

float float_weight(const PointBatch& batch, std::size_t i) {
  return batch.weights.empty() ? 1.0F : batch.weights[i];
}

bool has_position(const PointBatch& batch, std::size_t i) {
  const Vector3& p = batch.positions[i];
  return std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) <= kLargestCoordinate;
}

bool has_weight(const PointBatch& batch, std::size_t i) {
  const float weight = float_weight(batch, i);
  return weight > 0.0F && weight <= kLargestWeight;
}

// 1 / length of the point's normal; 0 for invalid points.
float normal_scale(const PointBatch& batch, std::size_t i) {
  if (!has_position(batch, i) || !has_weight(batch, i)) return 0.0F;
  const auto& [x, y, z] = batch.normals[i];
  const float squared = x * x + y * y + z * z;
  if (squared > 1e-30F && squared < 1e30F) return 1.0F / std::sqrt(squared);
  const double length =
      elementary::hypot(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  return length > 1e-37 && std::isfinite(length) ? static_cast<float>(1.0 / length) : 0.0F;
}

struct Scratch {
  SampleCells run;
  std::size_t cloud = 0;
  PointOrder order;
  std::vector<NormalProbe::NearPoint> near;
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

void CloudExtent::settle_huge() {
  if (part.points >= 3 && part.points >= huge.points / kHugePerOther) {
    dropped.huge += huge.points;
  } else {
    part.include(huge);
  }
  huge = CloudPart();
}

bool is_valid_point(const PointBatch& batch, std::size_t i) {
  return normal_scale(batch, i) > 0.0F;
}

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

namespace {

bool is_huge(const Vector3& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])}) >= kHugeCoordinate;
}

// Measurements of one batch.
struct MeasuredBatch {
  CloudExtent extent;
  std::size_t cloud = 0;
  std::vector<ThinnedPoints::Entry> entries;
  std::vector<ThinnedPoints::Entry> repeated;
};

void measure_point(const PointBatch& batch, std::size_t i, const ThinnedPoints* thinned,
                   MeasuredBatch* measured) {
  const Vector3& position = batch.positions[i];
  CloudExtent& extent = measured->extent;
  if (thinned != nullptr && is_valid_point(batch, i)) {
    const ThinnedPoints::Entry entry = ThinnedPoints::entry_of(position);
    if (thinned->keeps(entry)) measured->entries.push_back(entry);
  }
  if (!is_valid_point(batch, i)) {
    DroppedPoints& dropped = extent.dropped;
    ++(!has_position(batch, i) ? dropped.not_finite
       : is_huge(position)     ? dropped.huge
       : has_weight(batch, i)  ? dropped.normalless
                               : dropped.weightless);
    return;
  }
  if (is_huge(position)) {
    extent.huge.include(position, weight_of(batch, i));
    return;
  }
  extent.part.include(position, weight_of(batch, i));
  extent.steps.add(position);
}

}  // namespace

CloudExtent measure_cloud(PointSource* source, const Run& run, ThinnedPoints* thinned,
                          RepeatedPositions* repeated) {
  CloudExtent extent;
  CloudExtent own;  // of the cloud that is read
  std::size_t cloud = 0;
  const auto end_cloud = [&] {
    extent.part.include(std::exchange(own.part, CloudPart()));
    extent.huge.include(std::exchange(own.huge, CloudPart()));
  };
  for_batches<MeasuredBatch>(
      source, run,
      [&](const PointBatch& batch, MeasuredBatch* measured) {
        *measured = MeasuredBatch();
        measured->cloud = batch.cloud;
        measured->extent.points = batch.positions.size();
        for (std::size_t i = 0; i < batch.positions.size(); ++i) {
          measure_point(batch, i, thinned, measured);
        }
        if (repeated != nullptr) measured->repeated = RepeatedPositions::of_batch(batch);
      },
      [&](const MeasuredBatch& measured) {
        if (measured.cloud != cloud) end_cloud();
        cloud = measured.cloud;
        own.part.include(measured.extent.part);
        own.huge.include(measured.extent.huge);
        extent.steps.add(measured.extent.steps);
        extent.points += measured.extent.points;
        extent.dropped.add(measured.extent.dropped);
        if (thinned != nullptr) thinned->add(measured.entries);
        if (repeated != nullptr) repeated->add(measured.repeated, measured.extent.points);
      });
  end_cloud();
  if (thinned != nullptr) thinned->finish();
  return extent;
}

void gather_samples(PointSource* source, const SampleGrid& grid, const Run& run, SampleStore* store,
                    NormalProbe* probe) {
  const std::size_t attribute_count = source->attributes().size();
  std::size_t cloud = 0;
  for_batches<Scratch>(
      source, run,
      [&](const PointBatch& batch, Scratch* scratch) {
        make_run(batch, grid, attribute_count, scratch);
        scratch->cloud = batch.cloud;
        if (probe != nullptr) scratch->near = probe->find_near(batch);
      },
      [&](const Scratch& scratch) {
        if (scratch.cloud != cloud) store->end_cloud();
        cloud = scratch.cloud;
        store->add(scratch.run);
        if (probe != nullptr) probe->add(scratch.near);
      });
  store->finish(run.threads());
}

}  // namespace prefilter
