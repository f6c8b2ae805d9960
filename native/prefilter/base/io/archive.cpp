// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/archive.h"

#include <bit>
#include <cstring>
#include <string_view>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

// Also detects a different byte order.
constexpr std::uint64_t kMagic = 0x31504554'53464552;
constexpr std::size_t kMaxBufferedBytes = std::size_t{1} << 20U;
constexpr std::uint64_t kWord = sizeof(std::uint64_t);

// A checksum against disk and network errors, not against tampering.
std::uint64_t sum_of(std::span<const std::byte> bytes) {
  std::uint64_t sum = bytes.size();
  for (std::size_t i = 0; i < bytes.size(); i += kWord) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(kWord, bytes.size() - i));
    sum = (std::rotl(sum, 23) ^ word) * 0x9E3779B97F4A7C15U;
  }
  return sum ^ (sum >> 32U);
}

std::vector<std::uint8_t> bytes_of(std::string_view text) { return {text.begin(), text.end()}; }

}  // namespace

ArchiveWriter::ArchiveWriter(const std::string& target, const ArchiveMark& mark) : staged_(target) {
  append(std::as_bytes(std::span(&kMagic, 1)));
  put_all(bytes_of(mark.kind));
  put_all(bytes_of(mark.work));
}

void ArchiveWriter::put_bytes(std::span<const std::byte> bytes, std::size_t count) {
  const std::uint64_t length = count;
  const std::uint64_t sum = sum_of(bytes);
  append(std::as_bytes(std::span(&length, 1)));
  append(bytes);
  append(std::as_bytes(std::span(&sum, 1)));
}

void ArchiveWriter::append(std::span<const std::byte> bytes) {
  if (held_.size() + bytes.size() > kMaxBufferedBytes) flush();
  if (bytes.size() > kMaxBufferedBytes) {
    staged_.file().write_at(size_, bytes);
    size_ += bytes.size();
    return;
  }
  held_.insert(held_.end(), bytes.begin(), bytes.end());
}

void ArchiveWriter::flush() {
  staged_.file().write_at(size_, held_);
  size_ += held_.size();
  held_.clear();
}

void ArchiveWriter::commit() {
  flush();
  staged_.commit();
}

ArchiveReader::ArchiveReader(const std::string& path, const ArchiveMark& mark)
    : file_(File::open(path)), size_(file_.size()) {
  std::uint64_t magic = 0;
  const std::size_t read = file_.read_at(0, std::as_writable_bytes(std::span(&magic, 1)));
  if (read < kWord || magic != kMagic) refuse();
  place_ = kWord;
  if (get_all<std::uint8_t>() != bytes_of(mark.kind)) refuse();
  if (get_all<std::uint8_t>() != bytes_of(mark.work)) {
    throw_invalid(file_.name() + " is of other sources or settings");
  }
}

std::size_t ArchiveReader::count_at(std::uint64_t at, std::size_t size) const {
  std::uint64_t count = 0;
  if (at > size_ || size_ - at < 2 * kWord) refuse();
  if (file_.read_at(at, std::as_writable_bytes(std::span(&count, 1))) < kWord) refuse();
  if (count > (size_ - at - 2 * kWord) / size) refuse();
  return static_cast<std::size_t>(count);
}

void ArchiveReader::fill(std::uint64_t at, std::span<std::byte> bytes) const {
  std::uint64_t sum = 0;
  const std::size_t read = file_.read_at(at + kWord, bytes);
  const std::uint64_t end = at + kWord + bytes.size();
  const std::size_t more = file_.read_at(end, std::as_writable_bytes(std::span(&sum, 1)));
  if (read < bytes.size() || more < kWord || sum != sum_of(bytes)) refuse();
}

void ArchiveReader::end() const {
  if (place_ != size_) refuse();
}

void ArchiveReader::refuse() const {
  throw Error(ErrorCode::kFile, file_.name() + " is damaged, or no file of this step");
}

}  // namespace prefilter
