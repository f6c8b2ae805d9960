// SPDX-License-Identifier: GPL-3.0-or-later

// A stream is a sequence of runs. A control byte c below 32 is followed by c + 1 bytes to copy.
// Else c >> 5 is a length, where 7 has a byte more to add to it, and the other five bits, before
// those of the next byte, tell how far back from here length + 2 bytes repeat, less one.
#include "prefilter/points/scan/lzf.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr std::size_t kFarthest = 1 << 13;
constexpr std::size_t kBlockSize = std::size_t{1} << 20;
// A control byte with all that may follow it.
constexpr std::size_t kLongestRun = 33;
// What one of these can give.
constexpr std::size_t kLongestCopy = 264;

class Decoder {
 public:
  Decoder(ByteReader* from, std::uint64_t compressed, std::uint64_t plain, TemporaryFile* to)
      : from_(from), left_(compressed), plain_(plain), to_(to) {}

  void run() {
    while (left_ > 0) {
      const auto bytes = from_->peek(kLongestRun);
      const auto there = std::min<std::uint64_t>(bytes.size(), left_);
      const auto length = decode(bytes.first(static_cast<std::size_t>(there)));
      from_->skip(length);
      left_ -= length;
      if (end_ >= kBlockSize) write(kFarthest);
    }
    write(0);
    if (written_ != plain_) throw_damaged();
  }

 private:
  // Decodes the first run; returns of how many bytes it is.
  std::size_t decode(std::span<const std::byte> bytes) {
    const auto at = [&](std::size_t place) {
      if (place >= bytes.size()) throw_damaged();
      return std::to_integer<std::size_t>(bytes[place]);
    };
    const std::size_t control = at(0);
    if (control < 32) {
      const std::size_t count = control + 1;
      at(count);
      std::memcpy(block_.data() + end_, bytes.data() + 1, count);
      end_ += count;
      return 1 + count;
    }
    std::size_t next = 1;
    std::size_t count = (control >> 5) + 2;
    if (control >> 5 == 7) count += at(next++);
    const std::size_t back = ((control & 31) << 8) + at(next++) + 1;
    if (back > end_) throw_damaged();
    // The bytes that repeat may be among those that this makes.
    for (std::size_t k = 0; k < count; ++k, ++end_) block_[end_] = block_[end_ - back];
    return next;
  }

  // Writes what has been decoded, and keeps the last of it.
  void write(std::size_t kept) {
    const auto fresh = std::span(block_).subspan(begin_, end_ - begin_);
    written_ += fresh.size();
    if (written_ > plain_) throw_damaged();
    to_->write(fresh);
    kept = std::min(kept, end_);
    std::memmove(block_.data(), block_.data() + end_ - kept, kept);
    begin_ = end_ = kept;
  }

  [[noreturn]] void throw_damaged() const {
    throw_invalid(from_->name() + ": the compressed points are damaged at byte " +
                  std::to_string(from_->offset()));
  }

  ByteReader* from_;
  std::uint64_t left_;
  std::uint64_t plain_;
  TemporaryFile* to_;
  std::uint64_t written_ = 0;
  // What was decoded last: [0, begin_) is written, [begin_, end_) not yet.
  std::vector<std::byte> block_ = std::vector<std::byte>(kBlockSize + kLongestCopy);
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace

void decode_lzf(ByteReader* from, std::uint64_t compressed, std::uint64_t plain,
                TemporaryFile* to) {
  Decoder(from, compressed, plain, to).run();
}

}  // namespace prefilter
