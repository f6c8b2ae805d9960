// SPDX-License-Identifier: GPL-3.0-or-later

// What files need of the operating system: file.h and staged_file.h are made of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace prefilter::system_file {

/// An open file, as the system calls it.
using Handle = std::intptr_t;
constexpr Handle kNone = -1;

enum class Kind { kRegular, kFolder, kOther };

// New files are locked until they are closed, as far as the file system can do that: who looks for
// what dead processes have left knows by it that they are in use. On Windows none are left.
//
// All that can fail says so by what it returns, and last_error() says why. Paths are UTF-8 on
// Windows, and elsewhere the bytes that the system has.

/// For reading, without waiting for the other end of a pipe; kNone where that fails.
Handle open(const std::string& path);
/// A new file for reading and writing; kNone where that fails, as where there is one.
Handle create(const std::string& path);
/// A new file that is gone when it is closed, also by a kill; kNone where that fails.
Handle create_temporary(const std::string& folder);
/// The same, but one that link makes last; kNone where the system cannot do that.
Handle create_linkable(const std::string& folder);
/// Gives a linkable file a name, where there is no file of that name yet.
bool link(Handle file, const std::string& path);
bool close(Handle file);

std::optional<Kind> kind(Handle file);
std::optional<std::uint64_t> size(Handle file);
/// How many bytes were read or written, which may be fewer than were asked for, and 0 at the end of
/// the file; -1 where that fails.
std::ptrdiff_t read(Handle file, std::uint64_t offset, std::span<std::byte> bytes);
std::ptrdiff_t write(Handle file, std::uint64_t offset, std::span<const std::byte> bytes);

/// Has the disk hold what was written, or what the folder lists; not every system syncs folders.
bool sync(Handle file);
void sync_folder(const std::string& folder);

/// Gives a file the permissions of another, where a file that is renamed keeps its own.
bool copy_permissions(const std::string& from, Handle to);
/// Renames a file, in place of another one where there is one.
bool rename(const std::string& from, const std::string& to);
bool remove(const std::string& path);

/// Why the last call of this thread failed.
std::string last_error();

/// What tells a start of the system from others, if it says so, and what the machine is called.
std::string boot_name();
std::string host_name();

}  // namespace prefilter::system_file
