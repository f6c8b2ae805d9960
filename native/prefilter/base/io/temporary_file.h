// SPDX-License-Identifier: GPL-3.0-or-later

// Temporary files for data that exceeds the memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "prefilter/base/io/file.h"

namespace prefilter {

/// An unnamed file in a folder, or for "" in the system's folder for temporary files. `name` is its
/// name in messages, by default the folder. Throws Error(kFile).
File unnamed_file(std::string folder, std::string name);

/// A file that is written sequentially and read at random. It has no name in its folder, so nothing
/// is left behind, even after an exception or if the process is killed. Several threads may read
/// concurrently while none writes. All functions throw Error(kFile) on system errors, such as a
/// full disk; the message contains the folder and the bytes.
class TemporaryFile {
 public:
  /// In a folder, or for "" in the system's folder for temporary files.
  explicit TemporaryFile(const std::string& folder = "");

  void write(std::span<const std::byte> bytes);
  /// Fills all of `bytes`; the file must be long enough.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// Number of bytes written.
  std::uint64_t size() const { return size_; }

 private:
  File file_;
  std::uint64_t size_ = 0;
};

}  // namespace prefilter
