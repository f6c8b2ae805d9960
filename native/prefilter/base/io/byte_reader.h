// SPDX-License-Identifier: GPL-3.0-or-later

// A file from its first byte to its last, through a buffer of bounded size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/io/file.h"

namespace prefilter {

/// All functions throw Error(kFile) where the system refuses.
class ByteReader {
 public:
  explicit ByteReader(const std::string& path);
  /// From the beginning of a file that nobody writes to any more.
  explicit ByteReader(std::shared_ptr<const File> file);

  /// As messages call the file.
  const std::string& name() const { return file_->name(); }
  /// Of the file, in bytes, when it was opened.
  std::uint64_t size() const { return size_; }
  /// Of the next byte.
  std::uint64_t offset() const { return buffer_offset_ + begin_; }
  std::uint64_t remaining() const { return size_ > offset() ? size_ - offset() : 0; }
  void seek(std::uint64_t offset);
  /// The next bytes: `least` of them or more; fewer only at the end of the file. They stay where
  /// they are until the next call.
  std::span<const std::byte> peek(std::size_t least);
  /// Passes bytes that peek has shown.
  void skip(std::size_t count) { begin_ += count; }

 private:
  std::shared_ptr<const File> file_;
  std::uint64_t size_;
  std::vector<std::byte> buffer_;
  std::uint64_t buffer_offset_ = 0;  // of the buffer's first byte in the file
  std::size_t begin_ = 0;            // what of the buffer is not read yet: [begin_, end_)
  std::size_t end_ = 0;
};

}  // namespace prefilter
