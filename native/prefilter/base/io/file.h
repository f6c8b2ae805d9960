// SPDX-License-Identifier: GPL-3.0-or-later

// Open files with positioned reads and writes, and error messages with file and offset.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "prefilter/base/io/system_file.h"

namespace prefilter {

/// An open regular file, closed on destruction. Several threads may read concurrently. All
/// functions throw Error(kFile) on system errors; the message contains the file and the bytes.
class File {
 public:
  /// Opens a file for reading. Throws if it does not exist, or is not a regular file.
  static File open(const std::string& path);
  /// Creates an unnamed file for reading and writing, which disappears when closed, even if the
  /// process is killed. `name` is its name in messages.
  static File create_temporary(const std::string& folder, std::string name);
  /// The same, but `link` can give it a name; nothing if the system does not support that.
  static std::optional<File> create_linkable(const std::string& folder, std::string name);
  /// Creates a file for reading and writing. Throws if it exists.
  static File create(const std::string& path, std::string name);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  /// The name in messages.
  const std::string& name() const { return name_; }
  std::uint64_t size() const;
  /// Returns the number of bytes read, fewer than requested only at the end of the file.
  std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Gives a linkable file a name. Throws if a file with that name exists.
  void link(const std::string& path);
  /// Copies the permissions of another file, on systems where new files have default permissions.
  void copy_permissions(const std::string& from);
  /// Flushes all writes to the disk.
  void sync();
  /// Closes the file; unlike the destructor, throws for errors that the system has deferred.
  void close();

 private:
  File(system_file::Handle handle, std::string name) : handle_(handle), name_(std::move(name)) {}

  system_file::Handle handle_ = system_file::kNone;
  std::string name_;
};

/// A path in a folder with a unique random name.
std::string random_path(const std::string& folder);

/// Throws Error(kFile) with a message of `what` and the system's last error.
[[noreturn]] void throw_system_error(const std::string& what);

}  // namespace prefilter
