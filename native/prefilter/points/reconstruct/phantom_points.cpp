// SPDX-License-Identifier: GPL-3.0-or-later

// A position that holds a share of all points holds that share of a batch at least once, so only
// the most frequent positions of each batch have to be counted in the whole source.
#include "prefilter/points/reconstruct/phantom_points.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "prefilter/geometry/spatial/nearest_neighbors.h"
#include "prefilter/points/reconstruct/point_batches.h"

namespace prefilter {
namespace {

// A position counts in a batch if it holds this many of its points, or one of kPointsPerRepeat.
constexpr std::size_t kLeastRepeats = 4;
constexpr std::size_t kPointsPerRepeat = 4096;
// Positions that are counted at the most: where there are more, coordinates are rounded.
constexpr std::size_t kMostRepeated = std::size_t{1} << 16;

constexpr std::size_t kBuckets = std::size_t{1} << 16;
constexpr std::size_t kMostSampled = std::size_t{1} << 15;

// Positions around a phantom whose points are counted, and how many times as many it holds as most
// of them; fewer do where it is farther from them than they are from each other.
constexpr std::size_t kAround = 64;
constexpr std::size_t kLeastAround = 8;
constexpr std::size_t kTimesAsMany = 16;
constexpr std::size_t kTimesAsManyIsolated = 4;
constexpr double kIsolatedSpacings = 4.0;
// Copies of many positions are a matter of the scan: phantoms are fewer, unless they are isolated.
constexpr std::size_t kPositionsPerCrowded = 10'000;

bool is_finite(const Vector3& p) {
  return std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) <= kLargestCoordinate;
}

std::size_t bucket_of(std::uint64_t number) { return number % kBuckets; }

std::size_t least_repeats(std::size_t points) {
  return std::max(kLeastRepeats, points / kPointsPerRepeat);
}

// How many points some positions hold: those that are repeated, and a sample of all others that is
// chosen by coordinates alone.
class CountedPositions {
 public:
  struct Count {
    Vector3 position{};
    std::size_t points = 0;
    bool is_repeated = false;
  };

  explicit CountedPositions(const RepeatedPositions& repeated) : is_bucket_(kBuckets) {
    for (const auto& [number, position] : repeated.entries()) {
      is_bucket_[bucket_of(number)] = true;
      counts_[number] = {position, 0, true};
    }
  }

  bool may_count(const ThinnedPoints::Entry& entry) const {
    return entry.number <= largest_ || is_bucket_[bucket_of(entry.number)];
  }

  void add(const ThinnedPoints::Entry& entry) {
    const auto found = counts_.find(entry.number);
    if (found != counts_.end()) {
      ++found->second.points;
    } else if (entry.number <= largest_) {
      counts_[entry.number] = {entry.position, 1, false};
      if (++sampled_ > kMostSampled) thin();
    }
  }

  // In the order of their coordinates.
  std::vector<Count> counts() const {
    std::vector<Count> result;
    for (const auto& [number, count] : counts_) result.push_back(count);
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

  std::vector<bool> is_bucket_;
  std::unordered_map<std::uint64_t, Count> counts_;
  std::uint64_t largest_ = std::numeric_limits<std::uint64_t>::max();
  std::size_t sampled_ = 0;
};

std::vector<CountedPositions::Count> count_positions(const RepeatedPositions& repeated,
                                                     PointSource* source, const Progress& progress,
                                                     int threads) {
  CountedPositions counted(repeated);
  using Entries = std::vector<ThinnedPoints::Entry>;
  for_batches<Entries>(
      source, progress, threads,
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

// In a box of side 1, so that squares of distances are finite.
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

// Looks at what is around positions.
class Surroundings {
 public:
  Surroundings(const std::vector<CountedPositions::Count>& counts, const Progress& progress,
               int threads)
      : counts_(counts),
        positions_(scaled_positions(counts)),
        search_(positions_, progress, threads),
        points_(search_.positions().size()) {
    for (std::size_t i = 0; i < counts.size(); ++i)
      points_[search_.places()[i]] += counts[i].points;
  }

  // How a position differs from those around it.
  enum class Kind { kOrdinary, kCrowded, kIsolated };

  Kind kind_of(std::size_t i) {
    const std::uint32_t place = search_.places()[i];
    search_.find(place, kAround + 1, &near_);
    const auto around = near_.places().subspan(1);
    if (around.size() < kLeastAround) return Kind::kOrdinary;
    const double squared = near_.squares()[1];
    std::vector<std::size_t> points;
    for (const std::uint32_t each : around) points.push_back(points_[each]);
    const auto middle = points.begin() + static_cast<std::ptrdiff_t>(points.size() / 2);
    std::nth_element(points.begin(), middle, points.end());
    const std::size_t usual = *middle;
    if (counts_[i].points < kTimesAsManyIsolated * usual) return Kind::kOrdinary;
    const std::uint32_t nearest = around.front();
    search_.find(nearest, kLeastAround + 1, &near_);
    if (squared > kIsolatedSpacings * kIsolatedSpacings * near_.squares().back()) {
      return Kind::kIsolated;
    }
    return counts_[i].points > kTimesAsMany * usual ? Kind::kCrowded : Kind::kOrdinary;
  }

 private:
  const std::vector<CountedPositions::Count>& counts_;
  std::vector<Vector3> positions_;
  NeighborSearch search_;
  std::vector<std::size_t> points_;  // by place
  Neighbors near_;
};

}  // namespace

std::vector<ThinnedPoints::Entry> RepeatedPositions::of_batch(const PointBatch& batch) {
  const std::size_t least = least_repeats(batch.positions.size());
  std::vector<ThinnedPoints::Entry> entries;
  entries.reserve(batch.positions.size());
  std::vector<std::uint32_t> buckets(kBuckets);
  for (const Vector3& position : batch.positions) {
    if (!is_finite(position)) continue;
    entries.push_back(ThinnedPoints::entry_of(position));
    ++buckets[bucket_of(entries.back().number)];
  }
  std::erase_if(entries, [&](const ThinnedPoints::Entry& entry) {
    return buckets[bucket_of(entry.number)] < least;
  });
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.number < b.number; });
  std::vector<ThinnedPoints::Entry> result;
  for (std::size_t begin = 0, end = 0; begin < entries.size(); begin = end) {
    while (end < entries.size() && entries[end].number == entries[begin].number) ++end;
    if (end - begin >= least) result.push_back(entries[begin]);
  }
  return result;
}

void RepeatedPositions::add(const std::vector<ThinnedPoints::Entry>& entries, std::size_t points) {
  least_ += least_repeats(points);
  for (const ThinnedPoints::Entry& entry : entries) {
    if (entries_.size() < kMostRepeated) entries_[entry.number] = entry.position;
  }
}

std::vector<PhantomPlace> find_phantoms(const RepeatedPositions& repeated, PointSource* source,
                                        const Progress& progress, int threads) {
  std::vector<PhantomPlace> found;
  if (repeated.is_empty()) return found;
  const auto counts = count_positions(repeated, source, progress.part(0.0, 0.9), threads);
  Surroundings surroundings(counts, progress.part(0.9, 1.0), threads);
  using Kind = Surroundings::Kind;
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
      found.push_back({counts[i].position, counts[i].points});
    }
  }
  return found;
}

std::vector<PhantomPlace> find_phantoms(PointSource* source, const Progress& progress,
                                        int threads) {
  struct Found {
    std::vector<ThinnedPoints::Entry> entries;
    std::size_t points = 0;
  };
  RepeatedPositions repeated;
  for_batches<Found>(
      source, progress.part(0.0, 0.5), threads,
      [](const PointBatch& batch, Found* found) {
        *found = {RepeatedPositions::of_batch(batch), batch.positions.size()};
      },
      [&](const Found& found) { repeated.add(found.entries, found.points); });
  return find_phantoms(repeated, source, progress.part(0.5, 1.0), threads);
}

PointsWithout::PointsWithout(PointSource* source, const std::vector<PhantomPlace>& places)
    : ChangedPoints(source) {
  for (const PhantomPlace& place : places) {
    left_out_[ThinnedPoints::entry_of(place.position).number] = place.position;
  }
}

bool PointsWithout::read(std::size_t most, PointBatch* batch) {
  if (!source_->read(most, batch)) return false;
  const std::size_t width = source_->attributes().size();
  std::vector<bool> is_kept(batch->positions.size());
  for (std::size_t i = 0; i < is_kept.size(); ++i) {
    is_kept[i] = !left_out_.contains(ThinnedPoints::entry_of(batch->positions[i]).number);
  }
  keep_points(is_kept, width, batch);
  return true;
}

}  // namespace prefilter
