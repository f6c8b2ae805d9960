// SPDX-License-Identifier: GPL-3.0-or-later

// Stores a cloud's cells slab by slab, in memory or in a temporary file.
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
  /// Slabs are 2^slab_bits cells high, from 0 up to 2^depth. At most `memory_limit` bytes stay in
  /// memory, apart from the cells of one `add`; the others go to a file in `folder`. The limit does
  /// not affect the sums, not even by rounding.
  SampleStore(int depth, int slab_bits, std::size_t attribute_count, std::uint64_t memory_limit,
              std::string folder);

  /// Opens cells written by `save`, read-only.
  static std::unique_ptr<SampleStore> open(std::unique_ptr<ArchiveReader> file);

  /// A store of the same shape without cells.
  std::unique_ptr<SampleStore> empty_copy(std::uint64_t memory_limit, std::string folder) const;
  bool has_shape_of(const SampleStore& other) const;

  /// Adds cells in order of their keys; equal keys are summed.
  void add(const SampleCells& run);
  /// Ends a cloud. The sums of each cloud are computed before they are added together.
  void end_cloud();
  /// Call once, after the last `add`.
  void finish(int threads);
  /// Writes all cells; call after `finish`.
  void save(ArchiveWriter* file) const;

  int slab_count() const { return static_cast<int>(slabs_.size()); }
  bool is_spilled() const { return file_ != nullptr; }
  /// Number of cells in all slabs, and in one.
  std::size_t size() const;
  std::size_t size(int index) const;
  /// Bytes held in memory.
  std::size_t held_bytes() const { return held_ * bytes_per_cell(); }
  /// Writes all cells in memory to the file.
  void spill();
  /// The cells of a slab.
  SampleCells slab(int index) const;
  /// The cells of a slab, which are released where possible.
  SampleCells take(int index);

 private:
  int depth() const;

  // Cells in memory, or in the file.
  struct CellRun {
    SampleCells cells;
    std::uint64_t offset = 0;
    std::size_t count = 0;
    bool is_in_file = false;
    std::uint64_t attributes_offset = 0;  // offset of the attributes, in an opened file
  };
  // After an `add`, each run except the last is at least twice as long as the next.
  using CellRuns = std::vector<CellRun>;

  void merge_last(CellRuns* runs);
  void end_cloud(std::size_t slab);
  SampleCells read(const CellRun& run) const;
  std::size_t bytes_per_cell() const {
    return sizeof(SampleCell) + attribute_count_ * sizeof(float);
  }

  int slab_shift_;
  std::size_t attribute_count_;
  std::uint64_t memory_limit_;
  std::string folder_;
  std::vector<CellRuns> slabs_;
  std::vector<std::uint8_t> is_begun_;  // whether the first run holds the sums of earlier clouds
  std::atomic<std::size_t> held_ = 0;   // cells in memory
  std::unique_ptr<TemporaryFile> file_;
  std::unique_ptr<const ArchiveReader> opened_;
};

}  // namespace prefilter
