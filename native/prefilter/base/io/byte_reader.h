// SPDX-License-Identifier: GPL-3.0-or-later

// Reads a file sequentially through a buffer of bounded size.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/io/file.h"

namespace prefilter {

/// All functions throw Error(kFile) on system errors.
class ByteReader {
 public:
  explicit ByteReader(const std::string& path);
  /// Reads from the beginning of a file that is no longer written to.
  explicit ByteReader(std::shared_ptr<const File> file);

  /// The name of the file in messages.
  const std::string& name() const { return file_->name(); }
  /// Size of the file in bytes when it was opened.
  std::uint64_t size() const { return size_; }
  /// Offset of the next byte.
  std::uint64_t offset() const { return buffer_offset_ + begin_; }
  std::uint64_t remaining() const { return size_ > offset() ? size_ - offset() : 0; }
  void seek(std::uint64_t offset);
  /// The next bytes, at least `least` of them, fewer only at the end of the file. Valid until the
  /// next call.
  std::span<const std::byte> peek(std::size_t least);
  /// Skips bytes returned by peek.
  void skip(std::size_t count) { begin_ += count; }

 private:
  std::shared_ptr<const File> file_;
  std::uint64_t size_;
  std::vector<std::byte> buffer_;
  std::uint64_t buffer_offset_ = 0;  // of the buffer's first byte in the file
  std::size_t begin_ = 0;            // the unread part of the buffer is [begin_, end_)
  std::size_t end_ = 0;
};

}  // namespace prefilter
