// SPDX-License-Identifier: GPL-3.0-or-later

// A file for what does not fit into memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "prefilter/base/io/file.h"

namespace prefilter {

/// A file that has no name in a folder, or for "" in the system's folder for temporary files.
/// `name` is what messages call it; for "" they name the folder. Throws Error(kFile).
File unnamed_file(std::string folder, std::string name);

/// Written to at its end, read anywhere. It has no name in its folder, so nothing is left of it
/// when it goes, an exception passes or the process is killed. Several threads may read at once,
/// while none writes. All functions throw Error(kFile) where the system refuses, as a full disk
/// does; the message names the folder and the bytes.
class TemporaryFile {
 public:
  /// In a folder, or for "" in the system's folder for temporary files.
  explicit TemporaryFile(const std::string& folder = "");

  void write(std::span<const std::byte> bytes);
  /// Fills all of `bytes`, which the file must hold.
  void read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  /// How many bytes were written.
  std::uint64_t size() const { return size_; }

 private:
  File file_;
  std::uint64_t size_ = 0;
};

}  // namespace prefilter
