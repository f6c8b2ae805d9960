// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/staged_file.h"

#include <system_error>

#include "prefilter/base/error.h"
#include "prefilter/base/io/path_text.h"

namespace prefilter {
namespace {

namespace fs = std::filesystem;

void check_target(const std::string& target) {
  std::error_code ignored;
  const fs::file_status status = fs::status(to_path(target), ignored);
  if (!fs::exists(status) || fs::is_regular_file(status)) return;
  throw Error(ErrorCode::kFile, "'" + target + "' is a " +
                                    (fs::is_directory(status) ? "folder" : "device or pipe") +
                                    "; a regular file, or a new one, is needed");
}

std::string without_links(const std::string& target) {
  std::error_code error;
  const fs::path path = fs::weakly_canonical(fs::absolute(to_path(target)), error);
  if (error) throw Error(ErrorCode::kFile, "'" + target + "': " + error.message());
  return to_text(path);
}

}  // namespace

StagedFile::StagedFile(const std::string& target)
    : target_(without_links(target)),
      folder_(to_text(to_path(target_).parent_path())),
      file_(create()) {}

File StagedFile::create() {
  check_target(target_);
  const std::string name = "'" + target_ + "'";
  if (std::optional<File> file = File::create_linkable(folder_, name)) return *std::move(file);
  path_ = random_path(folder_);
  return File::create(path_, name);
}

StagedFile::~StagedFile() {
  if (!path_.empty()) system_file::remove(path_);
}

void StagedFile::commit() {
  check_target(target_);
  std::error_code ignored;
  if (fs::exists(to_path(target_), ignored)) file_.copy_permissions(target_);
  if (path_.empty()) {
    const std::string path = random_path(folder_);
    file_.link(path);
    path_ = path;
  }
  file_.sync();
  // It stays locked while it has that name, so that no other process removes it as abandoned.
  if (!system_file::rename(path_, target_)) {
    throw_system_error("'" + target_ + "': cannot be replaced");
  }
  path_.clear();
  file_.close();
  system_file::sync_folder(folder_);
}

}  // namespace prefilter
