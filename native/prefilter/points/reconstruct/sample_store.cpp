// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/sample_store.h"

#include <algorithm>
#include <bit>
#include <span>
#include <utility>

#include "prefilter/base/parallel.h"
#include "prefilter/base/run.h"

namespace prefilter {
namespace {

void append(const SampleCells& from, std::size_t begin, std::size_t end,
            std::size_t attribute_count, SampleCells* to) {
  const auto at = [](auto& values, std::size_t i) {
    return values.begin() + static_cast<std::ptrdiff_t>(i);
  };
  to->cells.insert(to->cells.end(), at(from.cells, begin), at(from.cells, end));
  to->attributes.insert(to->attributes.end(), at(from.attributes, begin * attribute_count),
                        at(from.attributes, end * attribute_count));
}

// Number of different keys in two sorted lists.
std::size_t union_size(const std::vector<SampleCell>& a, const std::vector<SampleCell>& b) {
  std::size_t count = 0;
  std::size_t i = 0;
  std::size_t j = 0;
  for (; i < a.size() && j < b.size(); ++count) {
    const CellKey x = a[i].key;
    const CellKey y = b[j].key;
    i += x <= y ? 1 : 0;
    j += y <= x ? 1 : 0;
  }
  return count + (a.size() - i) + (b.size() - j);
}

SampleCells merged(const SampleCells& a, const SampleCells& b, std::size_t attribute_count) {
  SampleCells result;
  const std::size_t count = union_size(a.cells, b.cells);
  result.cells.reserve(count);
  result.attributes.reserve(count * attribute_count);
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (a.cells[i].key < b.cells[j].key) {
      append(a, i, i + 1, attribute_count, &result);
      ++i;
    } else if (b.cells[j].key < a.cells[i].key) {
      append(b, j, j + 1, attribute_count, &result);
      ++j;
    } else {
      append(a, i, i + 1, attribute_count, &result);
      result.cells.back().add(b.cells[j]);
      float* const sums = result.attributes.data() + result.attributes.size() - attribute_count;
      for (std::size_t k = 0; k < attribute_count; ++k) {
        sums[k] += b.attributes[j * attribute_count + k];
      }
      ++i;
      ++j;
    }
  }
  append(a, i, a.size(), attribute_count, &result);
  append(b, j, b.size(), attribute_count, &result);
  return result;
}

}  // namespace

SampleStore::SampleStore(int depth, int slab_bits, std::size_t attribute_count,
                         std::uint64_t memory_limit, std::string folder)
    : slab_shift_(slab_bits),
      attribute_count_(attribute_count),
      memory_limit_(memory_limit),
      folder_(std::move(folder)),
      slabs_(std::size_t{1} << (depth - slab_bits)),
      is_begun_(slabs_.size()) {}

std::unique_ptr<SampleStore> SampleStore::open(std::unique_ptr<ArchiveReader> file) {
  const std::vector<std::uint32_t> shape = file->get_all<std::uint32_t>();
  if (shape.size() != 3 || shape[0] > kRowShift || shape[1] > shape[0]) file->refuse();
  const auto depth = static_cast<int>(shape[0]);
  auto store = std::make_unique<SampleStore>(depth, static_cast<int>(shape[1]), shape[2], 0, "");
  for (CellRuns& runs : store->slabs_) {
    CellRun run;
    run.is_in_file = true;
    run.offset = file->place();
    run.count = file->skip_all<SampleCell>();
    run.attributes_offset = file->place();
    if (file->skip_all<float>() != run.count * store->attribute_count_) file->refuse();
    if (run.count > 0) runs.push_back(std::move(run));
  }
  file->end();
  store->opened_ = std::move(file);
  return store;
}

int SampleStore::depth() const {
  return slab_shift_ + static_cast<int>(std::bit_width(slabs_.size())) - 1;
}

std::unique_ptr<SampleStore> SampleStore::empty_copy(std::uint64_t memory_limit,
                                                     std::string folder) const {
  return std::make_unique<SampleStore>(depth(), slab_shift_, attribute_count_, memory_limit,
                                       std::move(folder));
}

bool SampleStore::has_shape_of(const SampleStore& other) const {
  return depth() == other.depth() && slab_shift_ == other.slab_shift_ &&
         attribute_count_ == other.attribute_count_;
}

void SampleStore::add(const SampleCells& run) {
  for (std::size_t begin = 0; begin < run.size();) {
    const int slab = cell_position(run.cells[begin].key)[2] >> slab_shift_;
    const CellKey limit = cell_key({-1, -1, (slab + 1) << slab_shift_});
    const auto end = static_cast<std::size_t>(
        std::lower_bound(run.cells.begin() + static_cast<std::ptrdiff_t>(begin), run.cells.end(),
                         limit, [](const SampleCell& c, CellKey key) { return c.key < key; }) -
        run.cells.begin());
    CellRuns& runs = slabs_[static_cast<std::size_t>(slab)];
    runs.emplace_back();
    append(run, begin, end, attribute_count_, &runs.back().cells);
    runs.back().count = end - begin;
    held_ += end - begin;
    const std::size_t begun = is_begun_[static_cast<std::size_t>(slab)];
    while (runs.size() > 1 + begun && runs[runs.size() - 2].count < 2 * runs.back().count) {
      merge_last(&runs);
    }
    begin = end;
  }
  if (held_ * bytes_per_cell() > memory_limit_) spill();
}

void SampleStore::merge_last(CellRuns* runs) {
  CellRun last = std::move(runs->back());
  runs->pop_back();
  CellRun& first = runs->back();
  for (const CellRun* run : {&first, &last}) held_ -= run->is_in_file ? 0 : run->count;
  if (first.is_in_file) first.cells = read(first);
  if (last.is_in_file) last.cells = read(last);
  first.cells = merged(first.cells, last.cells, attribute_count_);
  first.is_in_file = false;
  first.count = first.cells.size();
  held_ += first.count;
}

void SampleStore::spill() {
  if (!file_) file_ = std::make_unique<TemporaryFile>(folder_);
  for (CellRuns& runs : slabs_) {
    for (CellRun& run : runs) {
      if (run.is_in_file) continue;
      run.offset = file_->size();
      run.is_in_file = true;
      file_->write(std::as_bytes(std::span(run.cells.cells)));
      file_->write(std::as_bytes(std::span(run.cells.attributes)));
      run.cells = SampleCells();
    }
  }
  held_ = 0;
}

void SampleStore::end_cloud(std::size_t slab) {
  CellRuns& runs = slabs_[slab];
  while (runs.size() > 1U + is_begun_[slab]) merge_last(&runs);
  if (runs.size() > 1) merge_last(&runs);
  is_begun_[slab] = runs.empty() ? 0 : 1;
}

void SampleStore::end_cloud() {
  for (std::size_t slab = 0; slab < slabs_.size(); ++slab) {
    end_cloud(slab);
    if (held_ * bytes_per_cell() > memory_limit_) spill();
  }
}

void SampleStore::save(ArchiveWriter* file) const {
  file->put_all(std::vector<std::uint32_t>{static_cast<std::uint32_t>(depth()),
                                           static_cast<std::uint32_t>(slab_shift_),
                                           static_cast<std::uint32_t>(attribute_count_)});
  for (int i = 0; i < slab_count(); ++i) {
    const SampleCells cells = slab(i);
    file->put_structs(cells.cells);
    file->put_all(cells.attributes);
  }
}

void SampleStore::finish(int threads) {
  // When spilling to a file, slabs take turns so that one at a time is in memory.
  const int width = file_ ? 1 : threads;
  parallel_for(slab_count(), Run(width), [&](std::int64_t i) {
    end_cloud(static_cast<std::size_t>(i));
    CellRuns& runs = slabs_[static_cast<std::size_t>(i)];
    for (CellRun& run : runs) {
      run.cells.cells.shrink_to_fit();
      run.cells.attributes.shrink_to_fit();
    }
    if (file_ && held_ * bytes_per_cell() > memory_limit_) spill();
  });
}

std::size_t SampleStore::size() const {
  std::size_t cells = 0;
  for (int i = 0; i < slab_count(); ++i) cells += size(i);
  return cells;
}

std::size_t SampleStore::size(int index) const {
  std::size_t cells = 0;
  for (const CellRun& run : slabs_[static_cast<std::size_t>(index)]) cells += run.count;
  return cells;
}

SampleCells SampleStore::read(const CellRun& run) const {
  if (!run.is_in_file) return run.cells;
  SampleCells cells;
  if (opened_) {
    cells.cells = opened_->all_at<SampleCell>(run.offset);
    cells.attributes = opened_->all_at<float>(run.attributes_offset);
    return cells;
  }
  cells.cells.resize(run.count);
  cells.attributes.resize(run.count * attribute_count_);
  file_->read_at(run.offset, std::as_writable_bytes(std::span(cells.cells)));
  file_->read_at(run.offset + run.count * sizeof(SampleCell),
                 std::as_writable_bytes(std::span(cells.attributes)));
  return cells;
}

SampleCells SampleStore::slab(int index) const {
  const CellRuns& runs = slabs_[static_cast<std::size_t>(index)];
  return runs.empty() ? SampleCells() : read(runs.front());
}

SampleCells SampleStore::take(int index) {
  CellRuns& runs = slabs_[static_cast<std::size_t>(index)];
  if (runs.empty() || runs.front().is_in_file) return slab(index);
  return std::move(std::exchange(runs, {}).front().cells);
}

}  // namespace prefilter
