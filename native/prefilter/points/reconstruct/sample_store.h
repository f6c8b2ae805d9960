// SPDX-License-Identifier: GPL-3.0-or-later

// The cells of a cloud, slab by slab: in memory, or where that is not enough, in a temporary file.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "prefilter/base/io/archive.h"
#include "prefilter/base/io/temporary_file.h"
#include "prefilter/points/reconstruct/sample_cell.h"

namespace prefilter {

class SampleStore {
 public:
  /// Slabs are 2^slab_bits cells high, from 0 up to 2^depth. What is held is at most `memory_limit`
  /// bytes, but for what a single `add` brings; the rest goes to a file in a folder. Sums are the
  /// same, to the last bit, for any limit.
  SampleStore(int depth, int slab_bits, std::size_t attribute_count, std::uint64_t memory_limit,
              std::string folder);

  /// What `save` has written there. Nothing can be added.
  static std::unique_ptr<SampleStore> open(std::unique_ptr<ArchiveReader> file);

  /// A store of the same shape without cells; and whether one is of the same shape.
  std::unique_ptr<SampleStore> empty_copy(std::uint64_t memory_limit, std::string folder) const;
  bool is_like(const SampleStore& other) const;

  /// Cells in the order of their keys; some may be there already.
  void add(const SampleCells& run);
  /// The next cells are of another cloud. The sums of each are made before those of all.
  void end_cloud();
  /// Call once, after the last `add`.
  void finish(int threads);
  /// Writes all cells, after `finish`.
  void save(ArchiveWriter* file) const;

  int slab_count() const { return static_cast<int>(slabs_.size()); }
  bool is_spilled() const { return file_ != nullptr; }
  /// Cells of all slabs, and of one.
  std::size_t size() const;
  std::size_t size(int index) const;
  /// What is held in memory.
  std::size_t held_bytes() const { return held_ * bytes_per_cell(); }
  /// Writes all that is held to the file.
  void spill();
  /// The cells of a slab.
  SampleCells slab(int index) const;
  /// The same, for the last time.
  SampleCells take(int index);

 private:
  int depth() const;

  // Cells in memory, or in the file.
  struct Run {
    SampleCells cells;
    std::uint64_t offset = 0;
    std::size_t count = 0;
    bool is_in_file = false;
    std::uint64_t more = 0;  // where attributes are in a file that was opened
  };
  // Each run but the last is at least twice as long as the next, when an `add` ends.
  using Runs = std::vector<Run>;

  void merge_last(Runs* runs);
  void end_cloud(std::size_t slab);
  SampleCells read(const Run& run) const;
  std::size_t bytes_per_cell() const {
    return sizeof(SampleCell) + attribute_count_ * sizeof(float);
  }

  int slab_shift_;
  std::size_t attribute_count_;
  std::uint64_t memory_limit_;
  std::string folder_;
  std::vector<Runs> slabs_;
  std::vector<std::uint8_t> is_begun_;  // by earlier clouds, whose cells are the first run
  std::atomic<std::size_t> held_ = 0;   // cells in memory
  std::unique_ptr<TemporaryFile> file_;
  std::unique_ptr<const ArchiveReader> opened_;
};

}  // namespace prefilter
