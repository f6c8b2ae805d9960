// SPDX-License-Identifier: GPL-3.0-or-later

// Folders and full disks for tests of files.
#pragma once

#ifndef _WIN32
#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <csignal>
#include <filesystem>
#include <random>
#include <string>

#include "prefilter/base/io/path_text.h"

namespace prefilter {

/// A new folder, removed with its contents.
class TestFolder {
 public:
  TestFolder() {
    std::random_device random;
    path_ = std::filesystem::canonical(std::filesystem::temp_directory_path()) /
            ("prefilter-test-" + std::to_string(random()) + "-" + std::to_string(random()));
    std::filesystem::create_directory(path_);
  }
  ~TestFolder() { std::filesystem::remove_all(path_); }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;

  std::string path() const { return to_text(path_); }
  std::string path(const std::string& name) const {
    return to_text((path_ / to_path(name)).make_preferred());
  }
  /// Whether its file system supports unnamed files; older overlays, as in containers, do not.
  bool has_unnamed_files() const {
#ifdef O_TMPFILE
    const int descriptor = ::open(path().c_str(), O_RDWR | O_TMPFILE, 0600);
    if (descriptor >= 0) ::close(descriptor);
    return descriptor >= 0;
#else
    return false;
#endif
  }
  /// The number of named files while a mesh is written.
  std::size_t names_while_written() const {
#ifdef _WIN32
    return 2;
#else
    return has_unnamed_files() ? 0 : 1;
#endif
  }
  std::size_t file_count() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_),
                                                  std::filesystem::directory_iterator()));
  }

 private:
  std::filesystem::path path_;
};

#ifndef _WIN32
/// During its lifetime files cannot grow beyond a limit, like on a full disk, for any user.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int);
};
#endif

}  // namespace prefilter
