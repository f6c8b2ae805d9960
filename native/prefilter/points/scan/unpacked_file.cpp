// SPDX-License-Identifier: GPL-3.0-or-later

// A temporary file without a name.
#include "prefilter/points/unpacked_file.h"

#include "prefilter/base/io/temporary_file.h"

namespace prefilter {

UnpackedFile::UnpackedFile(const std::string& packed)
    : file_(std::make_shared<File>(unnamed_file("", "'" + packed + "'"))) {}

void UnpackedFile::write(std::span<const std::byte> bytes) {
  file_->write_at(size_, bytes);
  size_ += bytes.size();
}

}  // namespace prefilter
