// SPDX-License-Identifier: GPL-3.0-or-later

// Files of points that are packed by a program such as gzip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace prefilter {

class File;

/// What was in a packed file, as whoever unpacks it writes it here: a temporary file without a
/// name, gone with this and all that reads it. All functions throw Error(kFile) where the system
/// refuses, as a full disk does.
class UnpackedFile {
 public:
  /// In the system's folder for temporary files. `packed` is the path of the packed file, by which
  /// messages call this.
  explicit UnpackedFile(const std::string& packed);

  void write(std::span<const std::byte> bytes);
  const std::shared_ptr<File>& file() const { return file_; }

 private:
  std::shared_ptr<File> file_;
  std::uint64_t size_ = 0;
};

}  // namespace prefilter
