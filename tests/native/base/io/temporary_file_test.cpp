// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/temporary_file.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

#include "base/io/files.h"
#include "prefilter/base/error.h"

namespace prefilter {
namespace {

#ifdef _WIN32
constexpr std::size_t kNames = 1;
#else
constexpr std::size_t kNames = 0;
#endif

TEST(TemporaryFile, HoldsWhatIsWrittenAndLeavesNothing) {
  const TestFolder folder;
  std::vector<int> values(100000);
  std::iota(values.begin(), values.end(), 0);
  const auto bytes = std::as_bytes(std::span(values));
  {
    TemporaryFile file(folder.path());
    EXPECT_EQ(folder.file_count(), kNames);
    file.write(bytes.subspan(0, 12345));
    file.write({});
    file.write(bytes.subspan(12345));
    EXPECT_EQ(file.size(), bytes.size());
    EXPECT_EQ(folder.file_count(), kNames);
    std::vector<int> found(1000);
    file.read_at(4 * 70000, std::as_writable_bytes(std::span(found)));
    EXPECT_TRUE(std::equal(found.begin(), found.end(), values.begin() + 70000));
    EXPECT_THROW(file.read_at(4 * 99001, std::as_writable_bytes(std::span(found))), Error);
  }
  EXPECT_EQ(folder.file_count(), 0U);
}

TEST(TemporaryFile, IsInTheSystemsFolderWithoutAnyOther) {
  TemporaryFile file;
  const std::byte value{7};
  std::byte found{0};
  file.write({&value, 1});
  file.read_at(0, {&found, 1});
  EXPECT_EQ(found, value);
}

TEST(TemporaryFile, ReportsAMissingFolder) {
  const TestFolder folder;
  try {
    TemporaryFile file(folder.path("none"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kFile);
    EXPECT_EQ(std::string(error.what()), "temporary file in '" + folder.path("none") +
                                             "': cannot be created: No such file or directory");
  }
}

#ifndef _WIN32
TEST(TemporaryFile, ReportsAFullDiskAndCanContinue) {
  const TestFolder folder;
  TemporaryFile file(folder.path());
  const std::vector<std::byte> bytes(10000, std::byte{3});
  file.write(bytes);
  {
    const FileSizeLimit limit(15000);
    try {
      file.write(bytes);
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kFile);
      const std::string wanted =
          "temporary file in '" + folder.path() + "': cannot write 5000 bytes at byte 15000: ";
      EXPECT_EQ(std::string(error.what()).substr(0, wanted.size()), wanted);
    }
  }
  EXPECT_EQ(file.size(), 10000U);
  file.write(bytes);
  EXPECT_EQ(file.size(), 20000U);
}
#endif

}  // namespace
}  // namespace prefilter
