// SPDX-License-Identifier: GPL-3.0-or-later

// A file that is put in place when it is whole.
#pragma once

#include <string>

#include "prefilter/base/io/file.h"

namespace prefilter {

/// Written beside its target, and renamed: where anything fails, the target is left as it was, and
/// nothing is left beside it. Where the system has files without names, that holds for a kill too.
/// All functions throw Error(kFile) where the system refuses.
class StagedFile {
 public:
  /// The target may be there, or not; symbolic links are followed. Throws where it is a folder, a
  /// device or the like, or where its folder is not there or cannot be written to.
  explicit StagedFile(const std::string& target);
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;
  ~StagedFile();

  /// What is written; messages call it by the name of the target.
  File& file() { return file_; }
  /// In which the target is.
  const std::string& folder() const { return folder_; }
  /// Puts the file in place of the target; no more can be written.
  void commit();

 private:
  File create();

  std::string target_;
  std::string folder_;
  std::string path_;  // the name that the file has until then, if any
  File file_;
};

}  // namespace prefilter
