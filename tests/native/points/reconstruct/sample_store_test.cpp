// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/sample_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <string>

#include "base/io/files.h"

namespace prefilter {
namespace {

constexpr int kDepth = 5;
constexpr int kSlabBits = 3;
constexpr std::size_t kAttributes = 2;
constexpr std::uint64_t kNoLimit = std::numeric_limits<std::uint64_t>::max();

// Runs of random cells; with whole numbers, sums are exact in any order.
std::vector<SampleCells> random_runs(int count, bool are_whole) {
  std::mt19937 random(3);
  std::uniform_int_distribution<std::int32_t> place(0, (1 << kDepth) - 1);
  std::uniform_int_distribution<int> length(1, 400);
  std::uniform_int_distribution<int> number(-9, 9);
  std::uniform_real_distribution<float> real(-1.0F, 1.0F);
  const auto value = [&] { return are_whole ? static_cast<float>(number(random)) : real(random); };
  std::vector<SampleCells> runs;
  for (int r = 0; r < count; ++r) {
    std::map<CellKey, SampleCell> cells;
    for (int i = length(random); i > 0; --i) {
      // The middle slabs stay empty.
      std::int32_t z = place(random);
      if (z >> kSlabBits == 1) z = 0;
      SampleCell cell;
      cell.key = cell_key({place(random), place(random), z});
      cell.weight = value();
      for (std::size_t a = 0; a < 3; ++a) {
        cell.normal[a] = value();
        cell.position[a] = value();
        cell.flux[a] = value();
      }
      cells[cell.key] = cell;
    }
    SampleCells& run = runs.emplace_back();
    for (const auto& [key, cell] : cells) {
      run.cells.push_back(cell);
      for (std::size_t k = 0; k < kAttributes; ++k) run.attributes.push_back(value());
    }
  }
  return runs;
}

void fill(const std::vector<SampleCells>& runs, int threads, SampleStore* store) {
  for (const SampleCells& run : runs) store->add(run);
  store->finish(threads);
}

std::vector<float> numbers_of(const SampleCell& cell) {
  std::vector<float> numbers = {cell.weight};
  for (const auto* sums : {&cell.normal, &cell.position, &cell.flux}) {
    numbers.insert(numbers.end(), sums->begin(), sums->end());
  }
  return numbers;
}

TEST(SampleStore, SumsEqualThoseOfAMap) {
  const std::vector<SampleCells> runs = random_runs(40, true);
  std::map<CellKey, std::vector<float>> wanted;
  for (const SampleCells& run : runs) {
    for (std::size_t i = 0; i < run.size(); ++i) {
      std::vector<float> numbers = numbers_of(run.cells[i]);
      for (std::size_t k = 0; k < kAttributes; ++k) {
        numbers.push_back(run.attributes[i * kAttributes + k]);
      }
      std::vector<float>& sums = wanted[run.cells[i].key];
      sums.resize(numbers.size());
      for (std::size_t k = 0; k < numbers.size(); ++k) sums[k] += numbers[k];
    }
  }
  for (const std::uint64_t limit : {kNoLimit, std::uint64_t{0}, std::uint64_t{20000}}) {
    SampleStore store(kDepth, kSlabBits, kAttributes, limit, "");
    fill(runs, 2, &store);
    EXPECT_EQ(store.is_spilled(), limit != kNoLimit);
    EXPECT_EQ(store.slab_count(), 1 << (kDepth - kSlabBits));
    EXPECT_EQ(store.size(), wanted.size());
    auto next = wanted.begin();
    for (int s = 0; s < store.slab_count(); ++s) {
      const SampleCells cells = store.slab(s);
      ASSERT_EQ(cells.attributes.size(), kAttributes * cells.size());
      EXPECT_EQ(cells.size() == 0, s == 1);
      for (std::size_t i = 0; i < cells.size(); ++i, ++next) {
        ASSERT_EQ(cells.cells[i].key, next->first);
        EXPECT_EQ(cell_position(cells.cells[i].key)[2] >> kSlabBits, s);
        std::vector<float> numbers = numbers_of(cells.cells[i]);
        for (std::size_t k = 0; k < kAttributes; ++k) {
          numbers.push_back(cells.attributes[i * kAttributes + k]);
        }
        ASSERT_EQ(numbers, next->second);
      }
    }
    EXPECT_TRUE(next == wanted.end());
  }
}

TEST(SampleStore, MemoryAndThreadsChangeNoBit) {
  const std::vector<SampleCells> runs = random_runs(40, false);
  SampleStore expected(kDepth, kSlabBits, kAttributes, kNoLimit, "");
  fill(runs, 1, &expected);
  for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{20000}, kNoLimit}) {
    SampleStore store(kDepth, kSlabBits, kAttributes, limit, "");
    fill(runs, 3, &store);
    for (int s = 0; s < store.slab_count(); ++s) {
      const SampleCells wanted = expected.slab(s);
      const SampleCells found = store.take(s);
      ASSERT_EQ(found.size(), wanted.size());
      EXPECT_EQ(found.attributes, wanted.attributes);
      for (std::size_t i = 0; i < found.size(); ++i) {
        ASSERT_EQ(found.cells[i].key, wanted.cells[i].key);
        ASSERT_EQ(numbers_of(found.cells[i]), numbers_of(wanted.cells[i]));
      }
    }
  }
}

TEST(SampleStore, MayHaveEmptySlabs) {
  SampleStore store(kDepth, kSlabBits, 0, 0, "");
  store.add({});
  store.finish(1);
  EXPECT_FALSE(store.is_spilled());
  EXPECT_EQ(store.size(), 0U);
  EXPECT_EQ(store.slab(2).size(), 0U);
  EXPECT_EQ(store.take(3).size(), 0U);
}

// Runs of three clouds, the second of which reaches only a few slabs.
std::vector<std::vector<SampleCells>> random_clouds() {
  const std::vector<SampleCells> runs = random_runs(30, false);
  std::vector<std::vector<SampleCells>> clouds(3);
  for (std::size_t r = 0; r < runs.size(); ++r)
    clouds[r < 11 ? 0 : r < 13 ? 1 : 2].push_back(runs[r]);
  return clouds;
}

TEST(SampleStore, SeparatelyGatheredCloudsHaveTheSameSums) {
  const std::vector<std::vector<SampleCells>> clouds = random_clouds();
  const TestFolder folder;
  const ArchiveMark mark = {"counts", "test"};
  const auto opened = [&](std::size_t k) {
    return SampleStore::open(std::make_unique<ArchiveReader>(folder.path(std::to_string(k)), mark));
  };
  for (const std::uint64_t limit : {kNoLimit, std::uint64_t{0}, std::uint64_t{20000}}) {
    SampleStore expected(kDepth, kSlabBits, kAttributes, limit, "");
    for (std::size_t k = 0; k < clouds.size(); ++k) {
      if (k > 0) expected.end_cloud();
      for (const SampleCells& run : clouds[k]) expected.add(run);
      SampleStore own(kDepth, kSlabBits, kAttributes, kNoLimit - limit, "");
      fill(clouds[k], 2, &own);
      ArchiveWriter file(folder.path(std::to_string(k)), mark);
      own.save(&file);
      file.commit();
    }
    expected.finish(2);
    const std::unique_ptr<SampleStore> merged = opened(0)->empty_copy(kNoLimit - limit, "");
    for (std::size_t k = 0; k < clouds.size(); ++k) {
      const std::unique_ptr<SampleStore> own = opened(k);
      ASSERT_TRUE(own->has_shape_of(*merged));
      for (int s = 0; s < own->slab_count(); ++s) merged->add(own->slab(s));
      merged->end_cloud();
    }
    merged->finish(1);
    ASSERT_EQ(merged->size(), expected.size());
    for (int s = 0; s < expected.slab_count(); ++s) {
      const SampleCells one = expected.slab(s);
      const SampleCells other = merged->slab(s);
      ASSERT_EQ(one.size(), other.size());
      EXPECT_EQ(one.attributes, other.attributes);
      for (std::size_t i = 0; i < one.size(); ++i) {
        ASSERT_EQ(one.cells[i].key, other.cells[i].key);
        ASSERT_EQ(numbers_of(one.cells[i]), numbers_of(other.cells[i]));
      }
    }
  }
}

}  // namespace
}  // namespace prefilter
