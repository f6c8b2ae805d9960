// SPDX-License-Identifier: GPL-3.0-or-later

// The operating system functions that file.h and staged_file.h are built on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace prefilter::system_file {

/// A native file handle.
using Handle = std::intptr_t;
constexpr Handle kNone = -1;

enum class Kind { kRegular, kFolder, kOther };

// New files are locked until closed, if the file system supports it. Cleanup of files left behind
// by dead processes skips locked ones. Windows leaves no such files.
//
// Functions report failure by their result, and last_error() returns the reason. Paths are UTF-8 on
// Windows, native bytes elsewhere.

/// Opens for reading, without blocking on pipes; kNone on failure.
Handle open(const std::string& path);
/// Creates a file for reading and writing; kNone on failure, or if it exists.
Handle create(const std::string& path);
/// Creates a file that disappears when closed, even if the process is killed; kNone on failure.
Handle create_temporary(const std::string& folder);
/// The same, but `link` can give it a name; kNone if unsupported.
Handle create_linkable(const std::string& folder);
/// Gives a linkable file a name, unless a file with that name exists.
bool link(Handle file, const std::string& path);
bool close(Handle file);

std::optional<Kind> kind(Handle file);
std::optional<std::uint64_t> size(Handle file);
/// Number of bytes read or written, possibly fewer than requested, 0 at the end of the file; -1 on
/// failure.
std::ptrdiff_t read(Handle file, std::uint64_t offset, std::span<std::byte> bytes);
std::ptrdiff_t write(Handle file, std::uint64_t offset, std::span<const std::byte> bytes);

/// Flushes a file's contents, or a folder's entries, to the disk; not every system can sync
/// folders.
bool sync(Handle file);
void sync_folder(const std::string& folder);

/// Copies permissions, on systems where a renamed file keeps its own.
bool copy_permissions(const std::string& from, Handle to);
/// Renames a file, replacing an existing one.
bool rename(const std::string& from, const std::string& to);
bool remove(const std::string& path);

/// The reason for the last failure in this thread.
std::string last_error();

/// An identifier of this start of the system, if available, and the machine's name.
std::string boot_name();
std::string host_name();

}  // namespace prefilter::system_file
