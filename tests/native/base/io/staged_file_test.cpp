// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/staged_file.h"

#include <gtest/gtest.h>
#ifdef _WIN32
#include <windows.h>
#endif

#include <string>

#include "base/io/files.h"
#include "prefilter/base/error.h"

namespace prefilter {
namespace {

// Umlauts, Chinese, and a character beyond 16 bits.
const char* const kName =
    "Gr\xC3\xB6\xC3\x9F"
    "e \xE5\xA4\xA7\xE5\xB0\x8F \xF0\x9F\x93\x90.bin";

void write(const std::string& path, const std::string& text) {
  StagedFile staged(path);
  staged.file().write_at(0, std::as_bytes(std::span(text)));
  staged.commit();
}

std::string contents(const File& file) {
  std::string text(file.size(), ' ');
  EXPECT_EQ(file.read_at(0, std::as_writable_bytes(std::span(text))), text.size());
  return text;
}

TEST(StagedFile, HasItsNameInAnyLanguage) {
  const TestFolder folder;
  const std::string path = folder.path(kName);
  write(path, "before");
  write(path, "after");
  EXPECT_EQ(contents(File::open(path)), "after");
  ASSERT_EQ(folder.file_count(), 1U);
  const std::filesystem::path found = *std::filesystem::directory_iterator(to_path(folder.path()));
  EXPECT_EQ(to_text(found.filename()), kName);
}

TEST(StagedFile, HasTheModeOfTheFileThatItReplaces) {
  namespace fs = std::filesystem;
  const TestFolder folder;
  const std::string path = folder.path("file");
  write(path, "before");
#ifndef _WIN32
  const fs::perms mode = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_write;
  fs::permissions(to_path(path), mode);
  write(path, "after");
  EXPECT_EQ(fs::status(to_path(path)).permissions(), mode);
#endif
}

TEST(StagedFile, ReplacesAnOpenFile) {
  const TestFolder folder;
  const std::string path = folder.path("file");
  write(path, "before");
  const File before = File::open(path);
  write(path, "later");
  EXPECT_EQ(contents(before), "before");
  EXPECT_EQ(contents(File::open(path)), "later");
}

TEST(StagedFile, LeavesTheTargetWithoutCommit) {
  const TestFolder folder;
  const std::string path = folder.path("file");
  write(path, "before");
  {
    StagedFile staged(path);
    staged.file().write_at(0, std::as_bytes(std::span("never")));
  }
  EXPECT_EQ(contents(File::open(path)), "before");
  EXPECT_EQ(folder.file_count(), 1U);
}

#ifdef _WIN32
TEST(StagedFile, ReportsATargetThatIsOpenElsewhere) {
  const TestFolder folder;
  const std::string path = folder.path("file");
  write(path, "before");
  const HANDLE held = CreateFileW(to_path(path).c_str(), GENERIC_READ, FILE_SHARE_READ, nullptr,
                                  OPEN_EXISTING, 0, nullptr);
  ASSERT_NE(held, INVALID_HANDLE_VALUE);
  try {
    write(path, "after");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "'" + path + "': cannot be replaced: another program has it open");
  }
  CloseHandle(held);
  EXPECT_EQ(contents(File::open(path)), "before");
  EXPECT_EQ(folder.file_count(), 1U);
}
#endif

}  // namespace
}  // namespace prefilter
