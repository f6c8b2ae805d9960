// SPDX-License-Identifier: GPL-3.0-or-later

// Files with a sequence of arrays, which pass results from one stage of long work to the next.
//
// Each array is preceded by its length and followed by a checksum, so that damaged files are
// rejected before use.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "prefilter/base/io/file.h"
#include "prefilter/base/io/staged_file.h"

namespace prefilter {

/// Identifies the kind of a file, and the work that it belongs to. Other files are rejected.
struct ArchiveMark {
  std::string kind;
  std::string work;
};

/// Writes next to the target, and replaces it on commit. All functions throw Error(kFile) on system
/// errors.
class ArchiveWriter {
 public:
  ArchiveWriter(const std::string& target, const ArchiveMark& mark);

  template <typename T>
  void put_all(std::span<const T> values) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    put_bytes(std::as_bytes(values), values.size());
  }
  template <typename T>
  void put_all(const std::vector<T>& values) {
    put_all(std::span<const T>(values));
  }
  /// For structs without padding.
  template <typename T>
  void put_structs(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_bytes(std::as_bytes(std::span(values)), values.size());
  }
  void commit();

 private:
  void put_bytes(std::span<const std::byte> bytes, std::size_t count);
  void append(std::span<const std::byte> bytes);
  void flush();

  StagedFile staged_;
  std::vector<std::byte> held_;
  std::uint64_t size_ = 0;
};

/// Several threads may read at positions of their own. Throws Error(kFile) for a damaged file, or
/// one not written with this mark.
class ArchiveReader {
 public:
  ArchiveReader(const std::string& path, const ArchiveMark& mark);

  /// Reads the next array.
  template <typename T>
  std::vector<T> get_all() {
    const std::uint64_t at = place_;
    skip_all<T>();
    return all_at<T>(at);
  }
  /// Skips the next array; returns its length.
  template <typename T>
  std::size_t skip_all() {
    const std::size_t count = count_at(place_, sizeof(T));
    place_ += 2 * sizeof(std::uint64_t) + count * sizeof(T);
    return count;
  }
  /// Position of the next array, and the array at a position.
  std::uint64_t place() const { return place_; }
  template <typename T>
  std::vector<T> all_at(std::uint64_t at) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count_at(at, sizeof(T)));
    fill(at, std::as_writable_bytes(std::span(values)));
    return values;
  }
  /// Rejects a file with data after the last array.
  void end() const;

  [[noreturn]] void refuse() const;

 private:
  std::size_t count_at(std::uint64_t at, std::size_t size) const;
  void fill(std::uint64_t at, std::span<std::byte> bytes) const;

  File file_;
  std::uint64_t size_;
  std::uint64_t place_ = 0;
};

}  // namespace prefilter
