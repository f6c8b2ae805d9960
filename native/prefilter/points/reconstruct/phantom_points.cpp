// SPDX-License-Identifier: GPL-3.0-or-later

// Finds phantoms in two passes. A position that holds a given share of all points holds that share
// of some batch, so the second pass counts only the most frequent positions of each batch.
#include "prefilter/points/reconstruct/phantom_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/reconstruct/point_batches.h"

namespace prefilter {
namespace {

// A position is frequent in a batch if it holds both this many of its points and one in
// kPointsPerRepeat.
constexpr std::size_t kMinRepeats = 4;
constexpr std::size_t kPointsPerRepeat = 4096;
// Upper limit on the positions counted; where there are more, coordinates are rounded.
constexpr std::size_t kMaxRepeatedPositions = std::size_t{1} << 16;

constexpr std::size_t kBuckets = std::size_t{1} << 16;
constexpr std::size_t kMaxSampledPositions = std::size_t{1} << 15;

// Neighboring positions whose points are counted, and the ratio of a phantom's points to their
// median. A smaller ratio suffices for an isolated phantom, farther from its neighbors than
// kIsolatedSpacings of their own spacings.
constexpr std::size_t kPhantomNeighbors = 64;
constexpr std::size_t kMinPhantomNeighbors = 8;
constexpr std::size_t kCrowdedRatio = 16;
constexpr std::size_t kIsolatedRatio = 4;
constexpr double kIsolatedSpacings = 4.0;
// If more than one position in so many is crowded, the scan repeats points; these are phantoms only
// where they are isolated.
constexpr std::size_t kPositionsPerCrowded = 10'000;

bool is_finite(const Vector3& p) {
  return std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) <= kLargestCoordinate;
}

std::size_t bucket_of(std::uint64_t hash) { return hash % kBuckets; }

std::size_t min_repeats(std::size_t points) {
  return std::max(kMinRepeats, points / kPointsPerRepeat);
}

// Counts the points at positions: at the repeated ones, and at a sample of all others that is
// chosen by coordinates alone.
class CountedPositions {
 public:
  struct Count {
    Vector3 position{};
    std::size_t points = 0;
    bool is_repeated = false;
  };

  explicit CountedPositions(const RepeatedPositions& repeated) : is_repeated_bucket_(kBuckets) {
    for (const auto& [hash, position] : repeated.entries()) {
      is_repeated_bucket_[bucket_of(hash)] = true;
      counts_[hash] = {position, 0, true};
    }
  }

  bool may_count(const ThinnedPoints::Entry& entry) const {
    return entry.hash <= largest_ || is_repeated_bucket_[bucket_of(entry.hash)];
  }

  void add(const ThinnedPoints::Entry& entry) {
    const auto it = counts_.find(entry.hash);
    if (it != counts_.end()) {
      ++it->second.points;
    } else if (entry.hash <= largest_) {
      counts_[entry.hash] = {entry.position, 1, false};
      if (++sampled_ > kMaxSampledPositions) thin();
    }
  }

  // Counts in order of their coordinates.
  std::vector<Count> counts() const {
    std::vector<Count> result;
    for (const auto& [hash, count] : counts_) result.push_back(count);
    std::sort(result.begin(), result.end(),
              [](const Count& a, const Count& b) { return a.position < b.position; });
    return result;
  }

 private:
  void thin() {
    largest_ /= 2;
    std::erase_if(counts_, [&](const auto& each) {
      return !each.second.is_repeated && each.first > largest_;
    });
    sampled_ = static_cast<std::size_t>(std::count_if(
        counts_.begin(), counts_.end(), [](const auto& each) { return !each.second.is_repeated; }));
  }

  std::vector<bool> is_repeated_bucket_;
  std::unordered_map<std::uint64_t, Count> counts_;
  std::uint64_t largest_ = std::numeric_limits<std::uint64_t>::max();
  std::size_t sampled_ = 0;
};

std::vector<CountedPositions::Count> count_positions(const RepeatedPositions& repeated,
                                                     PointSource* source, const Run& run) {
  CountedPositions counted(repeated);
  using Entries = std::vector<ThinnedPoints::Entry>;
  for_batches<Entries>(
      source, run,
      [&](const PointBatch& batch, Entries* entries) {
        entries->clear();
        for (const Vector3& position : batch.positions) {
          if (!is_finite(position)) continue;
          const ThinnedPoints::Entry entry = ThinnedPoints::entry_of(position);
          if (counted.may_count(entry)) entries->push_back(entry);
        }
      },
      [&](const Entries& entries) {
        for (const ThinnedPoints::Entry& entry : entries) counted.add(entry);
      });
  return counted.counts();
}

// Scales the positions into a box of side 1, so that squared distances are finite.
std::vector<Vector3> scaled_positions(const std::vector<CountedPositions::Count>& counts) {
  Box box = kEmptyBox;
  for (const auto& count : counts) box.include(count.position);
  const double longest = std::max({box.size(0), box.size(1), box.size(2)});
  std::vector<Vector3> result;
  result.reserve(counts.size());
  for (const auto& count : counts) {
    Vector3 scaled{};
    for (std::size_t a = 0; a < 3 && longest > 0.0; ++a) {
      scaled[a] = (count.position[a] - box.low[a]) / longest;
    }
    result.push_back(scaled);
  }
  return result;
}

// Classifies positions by their neighbors.
class PhantomClassifier {
 public:
  PhantomClassifier(const std::vector<CountedPositions::Count>& counts, const Run& run)
      : counts_(counts),
        positions_(scaled_positions(counts)),
        search_(positions_, run),
        points_(search_.positions().size()) {
    for (std::size_t i = 0; i < counts.size(); ++i)
      points_[search_.places()[i]] += counts[i].points;
  }

  // How a position differs from its neighbors.
  enum class Kind { kOrdinary, kCrowded, kIsolated };

  Kind kind_of(std::size_t i) {
    const std::uint32_t place = search_.places()[i];
    search_.find(place, kPhantomNeighbors + 1, &near_);
    const auto around = near_.places().subspan(1);
    if (around.size() < kMinPhantomNeighbors) return Kind::kOrdinary;
    const double squared = near_.squares()[1];
    std::vector<std::size_t> points;
    for (const std::uint32_t each : around) points.push_back(points_[each]);
    const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    std::nth_element(points.begin(), middle, points.end());
    const std::size_t usual = *middle;
    if (counts_[i].points < kIsolatedRatio * usual) return Kind::kOrdinary;
    const std::uint32_t nearest = around.front();
    search_.find(nearest, kMinPhantomNeighbors + 1, &near_);
    if (squared > kIsolatedSpacings * kIsolatedSpacings * near_.squares().back()) {
      return Kind::kIsolated;
    }
    return counts_[i].points > kCrowdedRatio * usual ? Kind::kCrowded : Kind::kOrdinary;
  }

 private:
  const std::vector<CountedPositions::Count>& counts_;
  std::vector<Vector3> positions_;
  NeighborSearch search_;
  std::vector<std::size_t> points_;  // by index in search_
  Neighbors near_;
};

}  // namespace

std::vector<ThinnedPoints::Entry> RepeatedPositions::of_batch(const PointBatch& batch) {
  const std::size_t least = min_repeats(batch.positions.size());
  std::vector<ThinnedPoints::Entry> entries;
  entries.reserve(batch.positions.size());
  std::vector<std::uint32_t> buckets(kBuckets);
  for (const Vector3& position : batch.positions) {
    if (!is_finite(position)) continue;
    entries.push_back(ThinnedPoints::entry_of(position));
    ++buckets[bucket_of(entries.back().hash)];
  }
  std::erase_if(entries, [&](const ThinnedPoints::Entry& entry) {
    return buckets[bucket_of(entry.hash)] < least;
  });
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.hash < b.hash; });
  std::vector<ThinnedPoints::Entry> result;
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].hash == entries[begin].hash) ++end;
    if (end - begin >= least) result.push_back(entries[begin]);
  }
  return result;
}

void RepeatedPositions::add(const std::vector<ThinnedPoints::Entry>& entries, std::size_t points) {
  least_ += min_repeats(points);
  for (const ThinnedPoints::Entry& entry : entries) {
    if (entries_.size() < kMaxRepeatedPositions) entries_[entry.hash] = entry.position;
  }
}

std::vector<PhantomPlace> find_phantoms(const RepeatedPositions& repeated, PointSource* source,
                                        const Run& run) {
  std::vector<PhantomPlace> phantoms;
  if (repeated.is_empty()) return phantoms;
  const Stages stages(run, {9, 1});
  const auto counts = count_positions(repeated, source, stages[0]);
  PhantomClassifier surroundings(counts, stages[1]);
  using Kind = PhantomClassifier::Kind;
  std::vector<Kind> kinds(counts.size(), Kind::kOrdinary);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (!counts[i].is_repeated || counts[i].points < repeated.least()) continue;
    kinds[i] = surroundings.kind_of(i);
  }
  const auto crowded =
      static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), Kind::kCrowded));
  const bool are_few = crowded <= std::max<std::size_t>(1, counts.size() / kPositionsPerCrowded);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (kinds[i] == Kind::kIsolated || (kinds[i] == Kind::kCrowded && are_few)) {
      phantoms.push_back({counts[i].position, counts[i].points});
    }
  }
  return phantoms;
}

std::vector<PhantomPlace> find_phantoms(PointSource* source, const Run& run) {
  struct PositionCounts {
    std::vector<ThinnedPoints::Entry> entries;
    std::size_t points = 0;
  };
  RepeatedPositions repeated;
  const Stages stages(run, {1, 1});
  for_batches<PositionCounts>(
      source, stages[0],
      [](const PointBatch& batch, PositionCounts* batch_counts) {
        *batch_counts = {RepeatedPositions::of_batch(batch), batch.positions.size()};
      },
      [&](const PositionCounts& batch_counts) {
        repeated.add(batch_counts.entries, batch_counts.points);
      });
  return find_phantoms(repeated, source, stages[1]);
}

PointsWithout::PointsWithout(PointSource* source, const std::vector<PhantomPlace>& places)
    : ChangedPoints(source) {
  for (const PhantomPlace& place : places) {
    left_out_[ThinnedPoints::entry_of(place.position).hash] = place.position;
  }
}

bool PointsWithout::read(std::size_t most, PointBatch* batch) {
  if (!source_->read(most, batch)) return false;
  const std::size_t width = source_->attributes().size();
  std::vector<bool> is_kept(batch->positions.size());
  for (std::size_t i = 0; i < is_kept.size(); ++i) {
    is_kept[i] = !left_out_.contains(ThinnedPoints::entry_of(batch->positions[i]).hash);
  }
  keep_points(is_kept, width, batch);
  return true;
}

}  // namespace prefilter
