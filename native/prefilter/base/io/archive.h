// SPDX-License-Identifier: GPL-3.0-or-later

// Arrays in a file of our own, one after the other: what a step of long work leaves to the next.
//
// Each array is written with its length before it and a sum of its bytes after it, so that files
// that are damaged are refused before anything is made of them.
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

/// What a file is: its kind, and of which work. Files of another one are refused.
struct ArchiveMark {
  std::string kind;
  std::string work;
};

/// Written beside its target, and put in place when it is whole. All functions throw Error(kFile)
/// where the system refuses.
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
  /// Of a struct without gaps between its members.
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

/// Several threads may read at places of their own. Throws Error(kFile) where a file is damaged, or
/// is none that a writer with this mark has made.
class ArchiveReader {
 public:
  ArchiveReader(const std::string& path, const ArchiveMark& mark);

  /// The next array.
  template <typename T>
  std::vector<T> get_all() {
    const std::uint64_t at = place_;
    skip_all<T>();
    return all_at<T>(at);
  }
  /// Passes the next array by; returns its length.
  template <typename T>
  std::size_t skip_all() {
    const std::size_t count = count_at(place_, sizeof(T));
    place_ += 2 * sizeof(std::uint64_t) + count * sizeof(T);
    return count;
  }
  /// Where the next array is, and the one that is there.
  std::uint64_t place() const { return place_; }
  template <typename T>
  std::vector<T> all_at(std::uint64_t at) const {
    static_assert(std::is_trivially_copyable_v<T>);
    std::vector<T> values(count_at(at, sizeof(T)));
    fill(at, std::as_writable_bytes(std::span(values)));
    return values;
  }
  /// Refuses a file that goes on.
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
