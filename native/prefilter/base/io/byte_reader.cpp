// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/byte_reader.h"

#include <algorithm>
#include <cstring>
#include <utility>

namespace prefilter {
namespace {
constexpr std::size_t kBufferSize = std::size_t{1} << 20;
}  // namespace

ByteReader::ByteReader(const std::string& path)
    : ByteReader(std::make_shared<const File>(File::open(path))) {}

ByteReader::ByteReader(std::shared_ptr<const File> file)
    : file_(std::move(file)), size_(file_->size()) {}

void ByteReader::seek(std::uint64_t offset) {
  if (offset >= buffer_offset_ && offset <= buffer_offset_ + end_) {
    begin_ = static_cast<std::size_t>(offset - buffer_offset_);
    return;
  }
  buffer_offset_ = offset;
  begin_ = end_ = 0;
}

std::span<const std::byte> ByteReader::peek(std::size_t least) {
  if (end_ - begin_ < least) {
    // Small files need no large buffer.
    const std::uint64_t useful = std::max<std::uint64_t>(remaining(), 1);
    const std::size_t wanted =
        std::max(least, static_cast<std::size_t>(std::min<std::uint64_t>(kBufferSize, useful)));
    if (wanted > buffer_.size()) buffer_.resize(wanted);
    if (begin_ > 0) std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    buffer_offset_ += begin_;
    end_ -= begin_;
    begin_ = 0;
    end_ += file_->read_at(buffer_offset_ + end_, std::span(buffer_).subspan(end_));
  }
  return {buffer_.data() + begin_, end_ - begin_};
}

}  // namespace prefilter
