// SPDX-License-Identifier: GPL-3.0-or-later

// Files that replace their target only when complete.
#pragma once

#include <string>

#include "prefilter/base/io/file.h"

namespace prefilter {

/// Written next to its target and then renamed. On any failure the target is unchanged and nothing
/// is left behind; on systems with unnamed files even if the process is killed. All functions throw
/// Error(kFile) on system errors.
class StagedFile {
 public:
  /// The target may exist; symbolic links are followed. Throws if it is not a regular file, or if
  /// its folder does not exist or is not writable.
  explicit StagedFile(const std::string& target);
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;
  ~StagedFile();

  /// The file to write to; its name in messages is the target's.
  File& file() { return file_; }
  /// The folder of the target.
  const std::string& folder() const { return folder_; }
  /// Replaces the target; no more can be written.
  void commit();

 private:
  File create();

  std::string target_;
  std::string folder_;
  std::string path_;  // temporary name, if any
  File file_;
};

}  // namespace prefilter
