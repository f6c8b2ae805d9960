// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/archive.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/io/files.h"
#include "prefilter/base/error.h"

namespace prefilter {
namespace {

using Triple = std::array<std::int32_t, 3>;

const ArchiveMark kMark = {"parts", "of a work"};
const std::vector<double> kNumbers = {1.5, -0.0, 1e300};
const std::vector<std::uint8_t> kBytes(3 << 20, 7);  // more than the buffer holds
const std::vector<Triple> kTriples = {{1, 2, 3}, {-4, 5, 6}};

void write(const std::string& path) {
  ArchiveWriter file(path, kMark);
  file.put_all(kNumbers);
  file.put_all(kBytes);
  file.put_all(std::vector<float>());
  file.put_structs(kTriples);
  file.commit();
}

std::vector<std::byte> contents(const std::string& path) {
  const File file = File::open(path);
  std::vector<std::byte> bytes(file.size());
  EXPECT_EQ(file.read_at(0, bytes), bytes.size());
  return bytes;
}

void replace(const std::string& path, const std::vector<std::byte>& bytes) {
  StagedFile staged(path);
  staged.file().write_at(0, bytes);
  staged.commit();
}

void read_all(const std::string& path) {
  ArchiveReader file(path, kMark);
  file.get_all<double>();
  file.get_all<std::uint8_t>();
  file.get_all<float>();
  file.get_all<Triple>();
  file.end();
}

TEST(Archive, RoundTripsArrays) {
  const TestFolder folder;
  const std::string path = folder.path("archive");
  write(path);
  ArchiveReader file(path, kMark);
  EXPECT_EQ(file.get_all<double>(), kNumbers);
  const std::uint64_t place = file.place();
  EXPECT_EQ(file.skip_all<std::uint8_t>(), kBytes.size());
  EXPECT_TRUE(file.get_all<float>().empty());
  EXPECT_THROW(file.end(), Error);
  EXPECT_EQ(file.get_all<Triple>(), kTriples);
  file.end();
  EXPECT_EQ(file.all_at<std::uint8_t>(place), kBytes);
}

TEST(Archive, RefusesOtherKindsAndWorks) {
  const TestFolder folder;
  const std::string path = folder.path("archive");
  write(path);
  EXPECT_THROW(ArchiveReader(path, {"cells", kMark.work}), Error);
  EXPECT_THROW(ArchiveReader(path, {kMark.kind, "another"}), Error);
  EXPECT_THROW(ArchiveReader(folder.path("none"), kMark), Error);
}

TEST(Archive, RefusesDamagedFiles) {
  const TestFolder folder;
  const std::string path = folder.path("archive");
  write(path);
  const std::vector<std::byte> whole = contents(path);
  for (const std::size_t at : {std::size_t{0}, std::size_t{9}, std::size_t{60}, std::size_t{90},
                               whole.size() / 2, whole.size() - 30, whole.size() - 1}) {
    std::vector<std::byte> damaged = whole;
    damaged[at] ^= std::byte{4};
    replace(path, damaged);
    EXPECT_THROW(read_all(path), Error) << at;
    damaged = whole;
    damaged.resize(at);
    replace(path, damaged);
    EXPECT_THROW(read_all(path), Error) << at;
  }
  std::vector<std::byte> longer = whole;
  longer.push_back(std::byte{0});
  replace(path, longer);
  EXPECT_THROW(read_all(path), Error);
  // An impossible length is rejected before memory is allocated.
  std::vector<std::byte> huge = whole;
  const std::size_t length_at = whole.size() - (2 * sizeof(Triple)) - 2 * sizeof(std::uint64_t);
  for (std::size_t i = 0; i < sizeof(std::uint64_t); ++i) huge[length_at + i] = std::byte{0xff};
  replace(path, huge);
  EXPECT_THROW(read_all(path), Error);
}

}  // namespace
}  // namespace prefilter
