// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/temporary_file.h"

#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/io/path_text.h"

namespace prefilter {

File unnamed_file(std::string folder, std::string name) {
  if (folder.empty()) {
    std::error_code error;
    folder = to_text(std::filesystem::temp_directory_path(error));
    if (error) {
      throw Error(ErrorCode::kFile, "there is no folder for temporary files: " + error.message());
    }
  }
  if (name.empty()) name = "temporary file in '" + folder + "'";
  return File::create_temporary(folder, std::move(name));
}

TemporaryFile::TemporaryFile(const std::string& folder) : file_(unnamed_file(folder, "")) {}

void TemporaryFile::write(std::span<const std::byte> bytes) {
  file_.write_at(size_, bytes);
  size_ += bytes.size();
}

void TemporaryFile::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  if (file_.read_at(offset, bytes) == bytes.size()) return;
  throw Error(ErrorCode::kFile, file_.name() + ": found " + std::to_string(file_.size()) +
                                    " bytes; bytes " + std::to_string(offset) + " to " +
                                    std::to_string(offset + bytes.size()) + " are needed");
}

}  // namespace prefilter
