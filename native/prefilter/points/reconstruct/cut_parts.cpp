// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/reconstruct/cut_parts.h"

#include <algorithm>
#include <span>
#include <utility>

namespace prefilter {
namespace {

// Calls visit(array, i) for each array of a part.
template <typename Part, typename Visit>
void for_arrays(Part* part, const Visit& visit) {
  visit(&part->positions, 0);
  visit(&part->attributes, 1);
  visit(&part->ids, 2);
  visit(&part->components, 3);
  visit(&part->triangles, 4);
  visit(&part->fans, 5);
  visit(&part->shared_ids, 6);
}

}  // namespace

void CutParts::add(CutPart part) {
  Entry entry;
  std::uint64_t bytes = 0;
  for_arrays(&part, [&](auto* array, std::size_t i) {
    entry.sizes[i] = array->size();
    bytes += std::as_bytes(std::span(*array)).size();
  });
  if (bytes > memory_limit_ - std::min(held_, memory_limit_)) {
    if (file_ == nullptr) file_ = std::make_unique<TemporaryFile>(folder_);
    entry.is_in_file = true;
    entry.offset = file_->size();
    for_arrays(&part,
               [&](auto* array, std::size_t) { file_->write(std::as_bytes(std::span(*array))); });
  } else {
    held_ += bytes;
    for_arrays(&part, [](auto* array, std::size_t) { array->shrink_to_fit(); });
    entry.part = std::move(part);
  }
  parts_.push_back(std::move(entry));
}

CutPart CutParts::take(std::size_t index) {
  Entry& entry = parts_[index];
  if (!entry.is_in_file) return std::exchange(entry.part, CutPart());
  CutPart part;
  std::uint64_t offset = entry.offset;
  for_arrays(&part, [&](auto* array, std::size_t i) {
    array->resize(entry.sizes[i]);
    const auto bytes = std::as_writable_bytes(std::span(*array));
    if (!bytes.empty()) file_->read_at(offset, bytes);
    offset += bytes.size();
  });
  return part;
}

}  // namespace prefilter
