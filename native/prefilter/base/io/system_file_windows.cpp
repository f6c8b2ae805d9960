// SPDX-License-Identifier: GPL-3.0-or-later

#define WIN32_LEAN_AND_MEAN
#define NOMINMAX
#include <windows.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <system_error>
#include <vector>

#include "prefilter/base/io/file.h"
#include "prefilter/base/io/path_text.h"
#include "prefilter/base/io/system_file.h"

namespace prefilter::system_file {
namespace {

// Allows others to read, write, rename and remove open files, as on other systems.
constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;
constexpr DWORD kReadWrite = GENERIC_READ | GENERIC_WRITE;

HANDLE handle_of(Handle file) { return reinterpret_cast<HANDLE>(file); }

Handle handle_from(HANDLE file) { return reinterpret_cast<Handle>(file); }

std::wstring wide(const std::string& text) { return to_path(text).wstring(); }

Handle open_with(const std::string& path, DWORD access, DWORD disposition, DWORD flags) {
  return handle_from(
      CreateFileW(wide(path).c_str(), access, kShared, nullptr, disposition, flags, nullptr));
}

// Sets whether the file is removed when closed.
bool set_removed(Handle file, bool is_removed) {
  FILE_DISPOSITION_INFO info{};
  info.DeleteFile = is_removed ? TRUE : FALSE;
  return SetFileInformationByHandle(handle_of(file), FileDispositionInfo, &info, sizeof info) != 0;
}

bool is_taken() { return GetLastError() == ERROR_FILE_EXISTS; }

bool rename_open(Handle file, const std::string& path, FILE_INFO_BY_HANDLE_CLASS kind,
                 DWORD flags) {
  const std::wstring name = wide(path);
  const std::size_t bytes = name.size() * sizeof(wchar_t);
  std::vector<std::byte> buffer(sizeof(FILE_RENAME_INFO) + bytes);
  FILE_RENAME_INFO info{};
  info.Flags = flags;
  info.FileNameLength = static_cast<DWORD>(bytes);
  std::memcpy(buffer.data(), &info, sizeof info);
  std::memcpy(buffer.data() + offsetof(FILE_RENAME_INFO, FileName), name.data(), bytes);
  return SetFileInformationByHandle(handle_of(file), kind, buffer.data(),
                                    static_cast<DWORD>(buffer.size())) != 0;
}

// Position for ReadFile and WriteFile.
OVERLAPPED at(std::uint64_t offset) {
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(offset & 0xFFFFFFFFU);
  place.OffsetHigh = static_cast<DWORD>(offset >> 32U);
  return place;
}

DWORD at_most(std::size_t bytes) {
  return static_cast<DWORD>(std::min<std::size_t>(bytes, std::size_t{1} << 30U));
}

bool is_read_only(const std::string& path) {
  const DWORD attributes = GetFileAttributesW(wide(path).c_str());
  return attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_READONLY) != 0;
}

// Renames a file over one that is open in a compatible sharing mode, by moving that away first.
bool rename_over_open(const std::string& from, const std::string& to) {
  if (is_read_only(to)) return false;
  const Handle replaced = open_with(to, DELETE, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL);
  if (replaced == kNone) return false;
  bool is_done =
      rename_open(replaced, random_path(to_text(to_path(to).parent_path())), FileRenameInfo, 0);
  if (is_done) {
    is_done = MoveFileExW(wide(from).c_str(), wide(to).c_str(), 0) != 0;
    if (is_done) {
      set_removed(replaced, true);
    } else {
      rename_open(replaced, to, FileRenameInfo, 0);
    }
  }
  close(replaced);
  return is_done;
}

// Replaces the last error by a sharing violation if the file is open elsewhere.
void report_if_open_elsewhere(const std::string& path) {
  const DWORD error = GetLastError();
  const Handle file = open_with(path, DELETE, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS);
  if (file != kNone) close(file);
  SetLastError(file == kNone && GetLastError() == ERROR_SHARING_VIOLATION ? ERROR_SHARING_VIOLATION
                                                                          : error);
}

// The errno of an error that other systems have too; 0 for others.
int common_error(DWORD error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_NETPATH:
    case ERROR_INVALID_DRIVE:
      return ENOENT;
    case ERROR_ACCESS_DENIED:
    case ERROR_WRITE_PROTECT:
      return EACCES;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      return EEXIST;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      return ENOSPC;
    case ERROR_FILE_TOO_LARGE:
      return EFBIG;
    case ERROR_TOO_MANY_OPEN_FILES:
      return EMFILE;
    case ERROR_FILENAME_EXCED_RANGE:
      return ENAMETOOLONG;
    default:
      return 0;
  }
}

}  // namespace

Handle open(const std::string& path) {
  // Also opens folders, to distinguish them from missing files.
  return open_with(path, GENERIC_READ, OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS);
}

Handle create(const std::string& path) {
  return open_with(path, kReadWrite, CREATE_NEW, FILE_ATTRIBUTE_NORMAL);
}

Handle create_temporary(const std::string& folder) {
  while (true) {
    const Handle file = open_with(random_path(folder), kReadWrite | DELETE, CREATE_NEW,
                                  FILE_ATTRIBUTE_TEMPORARY | FILE_FLAG_DELETE_ON_CLOSE);
    if (file != kNone || !is_taken()) return file;
  }
}

// Creates a file marked for removal, until link changes that: it has a name, but cannot be opened.
Handle create_linkable(const std::string& folder) {
  while (true) {
    const std::string path = random_path(folder);
    const Handle file = open_with(path, kReadWrite | DELETE, CREATE_NEW, FILE_ATTRIBUTE_NORMAL);
    if (file == kNone && is_taken()) continue;
    if (file == kNone || set_removed(file, true)) return file;
    close(file);
    remove(path);
    return kNone;
  }
}

bool link(Handle file, const std::string& path) {
  if (!set_removed(file, false)) return false;
  if (rename_open(file, path, FileRenameInfo, 0)) return true;
  const DWORD error = GetLastError();
  set_removed(file, true);
  SetLastError(error);
  return false;
}

bool close(Handle file) { return CloseHandle(handle_of(file)) != 0; }

std::optional<Kind> kind(Handle file) {
  if (GetFileType(handle_of(file)) != FILE_TYPE_DISK) return Kind::kOther;
  BY_HANDLE_FILE_INFORMATION info{};
  if (GetFileInformationByHandle(handle_of(file), &info) == 0) return std::nullopt;
  return (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0 ? Kind::kFolder : Kind::kRegular;
}

std::optional<std::uint64_t> size(Handle file) {
  LARGE_INTEGER size{};
  if (GetFileSizeEx(handle_of(file), &size) == 0) return std::nullopt;
  return static_cast<std::uint64_t>(size.QuadPart);
}

std::ptrdiff_t read(Handle file, std::uint64_t offset, std::span<std::byte> bytes) {
  OVERLAPPED place = at(offset);
  DWORD got = 0;
  if (ReadFile(handle_of(file), bytes.data(), at_most(bytes.size()), &got, &place) != 0) return got;
  return GetLastError() == ERROR_HANDLE_EOF ? 0 : -1;
}

std::ptrdiff_t write(Handle file, std::uint64_t offset, std::span<const std::byte> bytes) {
  OVERLAPPED place = at(offset);
  DWORD put = 0;
  if (WriteFile(handle_of(file), bytes.data(), at_most(bytes.size()), &put, &place) != 0) {
    return put;
  }
  return -1;
}

bool sync(Handle file) { return FlushFileBuffers(handle_of(file)) != 0; }

void sync_folder(const std::string&) {}

// Permissions of new files are inherited from the folder.
bool copy_permissions(const std::string&, Handle) { return true; }

bool rename(const std::string& from, const std::string& to) {
  const Handle file = open_with(from, DELETE, OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL);
  if (file == kNone) return false;
  // Atomic even if the other file is open and shared, but not supported by every file system.
  const bool is_done =
      rename_open(file, to, FileRenameInfoEx,
                  FILE_RENAME_FLAG_REPLACE_IF_EXISTS | FILE_RENAME_FLAG_POSIX_SEMANTICS);
  close(file);
  if (is_done) return true;
  if (MoveFileExW(wide(from).c_str(), wide(to).c_str(), MOVEFILE_REPLACE_EXISTING) != 0) {
    return true;
  }
  const DWORD error = GetLastError();
  if (error == ERROR_ACCESS_DENIED && rename_over_open(from, to)) return true;
  SetLastError(error);
  report_if_open_elsewhere(to);
  return false;
}

bool remove(const std::string& path) { return DeleteFileW(wide(path).c_str()) != 0; }

std::string last_error() {
  const DWORD error = GetLastError();
  if (error == ERROR_SHARING_VIOLATION || error == ERROR_LOCK_VIOLATION) {
    return "another program has it open";
  }
  if (const int common = common_error(error); common != 0) {
    return std::generic_category().message(common);
  }
  std::wstring text(1024, L'\0');
  text.resize(FormatMessageW(
      FORMAT_MESSAGE_FROM_SYSTEM | FORMAT_MESSAGE_IGNORE_INSERTS | FORMAT_MESSAGE_MAX_WIDTH_MASK,
      nullptr, error, 0, text.data(), static_cast<DWORD>(text.size()), nullptr));
  while (!text.empty() && (text.back() == L' ' || text.back() == L'.')) text.pop_back();
  return text.empty() ? "error " + std::to_string(error) : to_text(text);
}

std::string boot_name() { return ""; }

std::string host_name() {
  std::wstring name(MAX_COMPUTERNAME_LENGTH + 1, L'\0');
  DWORD length = static_cast<DWORD>(name.size());
  if (GetComputerNameW(name.data(), &length) == 0) return "";
  name.resize(length);
  return to_text(name);
}

}  // namespace prefilter::system_file

namespace prefilter {

std::filesystem::path to_path(const std::string& text) {
  const auto length = static_cast<int>(text.size());
  std::wstring path(text.size(), L'\0');
  path.resize(static_cast<std::size_t>(
      MultiByteToWideChar(CP_UTF8, 0, text.data(), length, path.data(), length)));
  return path;
}

std::string to_text(const std::filesystem::path& path) {
  const std::wstring& wide = path.native();
  const auto length = static_cast<int>(wide.size());
  std::string text(3 * wide.size(), '\0');
  text.resize(static_cast<std::size_t>(WideCharToMultiByte(
      CP_UTF8, 0, wide.data(), length, text.data(), 3 * length, nullptr, nullptr)));
  return text;
}

}  // namespace prefilter
