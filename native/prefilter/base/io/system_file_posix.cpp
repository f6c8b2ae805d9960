// SPDX-License-Identifier: GPL-3.0-or-later

// Linux and macOS.
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <system_error>

#include "prefilter/base/io/file.h"
#include "prefilter/base/io/path_text.h"
#include "prefilter/base/io/system_file.h"

namespace prefilter::system_file {
namespace {

// The mode for open(), to which the umask applies.
constexpr mode_t kNewFileMode = 0666;

int descriptor_of(Handle file) { return static_cast<int>(file); }

Handle open_retried(const std::string& path, int flags) {
  while (true) {
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, kNewFileMode);
    if (descriptor >= 0 || errno != EINTR) return descriptor;
  }
}

std::string own_link(Handle file) { return "/proc/self/fd/" + std::to_string(file); }

// Waits for processes that found a new file before it was locked, and remove it.
void lock(Handle file) {
  while (::flock(descriptor_of(file), LOCK_EX) != 0 && errno == EINTR) {
  }
}

bool is_removed(Handle file) {
  struct stat status {};
  return ::fstat(descriptor_of(file), &status) == 0 && status.st_nlink == 0;
}

Handle create_unnamed([[maybe_unused]] const std::string& folder) {
#ifdef O_TMPFILE
  const Handle file = open_retried(folder, O_RDWR | O_TMPFILE);
  if (file != kNone) lock(file);
  return file;
#else
  return kNone;
#endif
}

}  // namespace

Handle open(const std::string& path) { return open_retried(path, O_RDONLY | O_NONBLOCK); }

Handle create(const std::string& path) {
  while (true) {
    const Handle file = open_retried(path, O_RDWR | O_CREAT | O_EXCL);
    if (file == kNone) return file;
    lock(file);
    if (!is_removed(file)) return file;
    close(file);
  }
}

Handle create_temporary(const std::string& folder) {
  if (const Handle file = create_unnamed(folder); file != kNone) return file;
  // On file systems without unnamed files, it has a name for a moment.
  while (true) {
    const std::string path = random_path(folder);
    const Handle file = create(path);
    if (file == kNone && errno == EEXIST) continue;
    if (file == kNone || ::unlink(path.c_str()) == 0) return file;
    const int error = errno;
    close(file);
    errno = error;
    return kNone;
  }
}

Handle create_linkable(const std::string& folder) {
  const Handle file = create_unnamed(folder);
  // Without /proc it cannot be linked.
  if (file == kNone || ::access(own_link(file).c_str(), F_OK) == 0) return file;
  close(file);
  return kNone;
}

bool link(Handle file, const std::string& path) {
  return ::linkat(AT_FDCWD, own_link(file).c_str(), AT_FDCWD, path.c_str(), AT_SYMLINK_FOLLOW) == 0;
}

bool close(Handle file) { return ::close(descriptor_of(file)) == 0; }

std::optional<Kind> kind(Handle file) {
  struct stat status {};
  if (::fstat(descriptor_of(file), &status) != 0) return std::nullopt;
  if (S_ISREG(status.st_mode)) return Kind::kRegular;
  return S_ISDIR(status.st_mode) ? Kind::kFolder : Kind::kOther;
}

std::optional<std::uint64_t> size(Handle file) {
  struct stat status {};
  if (::fstat(descriptor_of(file), &status) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(status.st_size);
}

std::ptrdiff_t read(Handle file, std::uint64_t offset, std::span<std::byte> bytes) {
  while (true) {
    const ssize_t got =
        ::pread(descriptor_of(file), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (got >= 0 || errno != EINTR) return got;
  }
}

std::ptrdiff_t write(Handle file, std::uint64_t offset, std::span<const std::byte> bytes) {
  while (true) {
    const ssize_t put =
        ::pwrite(descriptor_of(file), bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (put >= 0 || errno != EINTR) return put;
  }
}

bool sync(Handle file) { return ::fsync(descriptor_of(file)) == 0; }

void sync_folder(const std::string& folder) {
  const Handle file = open_retried(folder, O_RDONLY | O_DIRECTORY);
  if (file == kNone) return;
  ::fsync(descriptor_of(file));
  close(file);
}

bool copy_permissions(const std::string& from, Handle to) {
  struct stat status {};
  return ::stat(from.c_str(), &status) == 0 &&
         ::fchmod(descriptor_of(to), status.st_mode & 07777U) == 0;
}

bool rename(const std::string& from, const std::string& to) {
  return std::rename(from.c_str(), to.c_str()) == 0;
}

bool remove(const std::string& path) { return ::unlink(path.c_str()) == 0; }

std::string last_error() { return std::generic_category().message(errno); }

std::string boot_name() {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string name;
  std::getline(file, name);
  return name;
}

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return "";
  return name.data();
}

}  // namespace prefilter::system_file

namespace prefilter {

std::filesystem::path to_path(const std::string& text) { return text; }

std::string to_text(const std::filesystem::path& path) { return path.string(); }

}  // namespace prefilter
