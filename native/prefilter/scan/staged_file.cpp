// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/scan/staged_file.h"

#include <filesystem>
#include <system_error>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

namespace fs = std::filesystem;

void check_target(const std::string& target) {
  std::error_code ignored;
  const fs::file_status status = fs::status(target, ignored);
  if (!fs::exists(status) || fs::is_regular_file(status)) return;
  throw Error(ErrorCode::kFile, "'" + target + "' is a " +
                                    (fs::is_directory(status) ? "folder" : "device or pipe") +
                                    "; a regular file, or a new one, is needed");
}

std::string without_links(const std::string& target) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(fs::absolute(target), error);
  if (error) throw Error(ErrorCode::kFile, "'" + target + "': " + error.message());
  return path.string();
}

}  // namespace

StagedFile::StagedFile(const std::string& target)
    : target_(without_links(target)),
      folder_(fs::path(target_).parent_path().string()),
      file_(create()) {}

File StagedFile::create() {
  check_target(target_);
  const std::string name = "'" + target_ + "'";
  if (std::optional<File> file = File::create_linkable(folder_, name)) return *std::move(file);
  path_ = random_path(folder_);
  return File::create(path_, name);
}

StagedFile::~StagedFile() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove(path_, ignored);
}

void StagedFile::commit() {
  check_target(target_);
  std::error_code error;
  const fs::file_status replaced = fs::status(target_, error);
  if (fs::exists(replaced)) file_.set_mode(static_cast<unsigned>(replaced.permissions()));
  if (path_.empty()) {
    const std::string path = random_path(folder_);
    file_.link(path);
    path_ = path;
  }
  file_.close();
  fs::rename(path_, target_, error);
  if (error) {
    throw Error(ErrorCode::kFile, "'" + target_ + "': cannot be replaced: " + error.message());
  }
  path_.clear();
}

}  // namespace prefilter
