// SPDX-License-Identifier: GPL-3.0-or-later

// A stream is a sequence of runs. A control byte c below 32 is followed by c + 1 literal bytes.
// Otherwise, c >> 5 is a length, to which the next byte is added if it is 7. The low five bits of c
// and the next byte are a distance minus one, from which length + 2 bytes are copied.
#include "prefilter/points/scan/lzf.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr std::size_t kWindowSize = 1 << 13;
constexpr std::size_t kLzfBlockSize = std::size_t{1} << 20;
// Largest encoded run, with its control byte.
constexpr std::size_t kMaxEncodedRun = 33;
// Largest number of bytes that a run yields.
constexpr std::size_t kMaxDecodedRun = 264;

class LzfDecoder {
 public:
  LzfDecoder(ByteReader* from, std::uint64_t compressed, std::uint64_t plain, TemporaryFile* to)
      : from_(from), left_(compressed), plain_(plain), to_(to) {}

  void run() {
    while (left_ > 0) {
      const auto bytes = from_->peek(kMaxEncodedRun);
      const auto there = std::min<std::uint64_t>(bytes.size(), left_);
      const auto length = decode(bytes.first(static_cast<std::size_t>(there)));
      from_->skip(length);
      left_ -= length;
      if (end_ >= kLzfBlockSize) write(kWindowSize);
    }
    write(0);
    if (written_ != plain_) throw_damaged();
  }

 private:
  // Decodes the first run; returns its encoded length.
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
    // Source and target of the copy may overlap.
    for (std::size_t k = 0; k < count; ++k, ++end_) block_[end_] = block_[end_ - back];
    return next;
  }

  // Writes the decoded bytes, and retains the last of them as the window.
  void write(std::size_t retained) {
    const auto fresh = std::span(block_).subspan(begin_, end_ - begin_);
    written_ += fresh.size();
    if (written_ > plain_) throw_damaged();
    to_->write(fresh);
    retained = std::min(retained, end_);
    std::memmove(block_.data(), block_.data() + end_ - retained, retained);
    begin_ = end_ = retained;
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
  // The window and pending bytes: [0, begin_) is written, [begin_, end_) is not.
  std::vector<std::byte> block_ = std::vector<std::byte>(kLzfBlockSize + kMaxDecodedRun);
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
};

}  // namespace

void decode_lzf(ByteReader* from, std::uint64_t compressed, std::uint64_t plain,
                TemporaryFile* to) {
  LzfDecoder(from, compressed, plain, to).run();
}

}  // namespace prefilter
