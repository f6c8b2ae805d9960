// SPDX-License-Identifier: GPL-3.0-or-later

// Open files, read and written at places that the caller names; errors say which file, and where.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "prefilter/base/io/system_file.h"

namespace prefilter {

/// An open regular file; closed when this goes. Several threads may read at once. All functions
/// throw Error(kFile) where the system refuses; the message names the file and the bytes.
class File {
 public:
  /// For reading. Throws where it does not exist, or is a folder, a device or the like.
  static File open(const std::string& path);
  /// A new file for reading and writing: it is gone when it is closed, also by a kill. `name` is
  /// what messages call it.
  static File create_temporary(const std::string& folder, std::string name);
  /// The same, but one that link makes last; none where the system cannot do that.
  static std::optional<File> create_linkable(const std::string& folder, std::string name);
  /// A new file for reading and writing. Throws where there is one.
  static File create(const std::string& path, std::string name);

  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  /// As messages call it.
  const std::string& name() const { return name_; }
  std::uint64_t size() const;
  /// Returns how many bytes were read: fewer than were asked for only at the end of the file.
  std::size_t read_at(std::uint64_t offset, std::span<std::byte> bytes) const;
  void write_at(std::uint64_t offset, std::span<const std::byte> bytes);
  /// Gives a linkable file a name. Throws where there is a file of that name.
  void link(const std::string& path);
  /// Gives it the permissions of another file, where the system gives new files permissions of
  /// their own.
  void copy_permissions(const std::string& from);
  /// Has the disk hold all that was written.
  void sync();
  /// Closes it; unlike the destructor, throws where the system had put off an error until now.
  void close();

 private:
  File(system_file::Handle handle, std::string name) : handle_(handle), name_(std::move(name)) {}

  system_file::Handle handle_ = system_file::kNone;
  std::string name_;
};

/// A path in a folder that nobody else thinks of.
std::string random_path(const std::string& folder);

/// Throws Error(kFile) with a message made of `what` and the system's last error.
[[noreturn]] void throw_system_error(const std::string& what);

}  // namespace prefilter
