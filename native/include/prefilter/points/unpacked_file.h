// SPDX-License-Identifier: GPL-3.0-or-later

// Decompressed content of point files packed by programs such as gzip.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace prefilter {

class File;

/// A temporary file without a name that holds the decompressed content of a file. It exists until
/// this object and all its readers are gone. All functions throw Error(kFile) if the system fails,
/// for example on a full disk.
class UnpackedFile {
 public:
  /// Creates the file in the system's temporary folder. `packed` is the path of the compressed
  /// file, for messages.
  explicit UnpackedFile(const std::string& packed);

  void write(std::span<const std::byte> bytes);
  const std::shared_ptr<File>& file() const { return file_; }

 private:
  std::shared_ptr<File> file_;
  std::uint64_t size_ = 0;
};

}  // namespace prefilter
