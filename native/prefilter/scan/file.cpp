// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/scan/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <random>
#include <system_error>
#include <utility>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

// As open() has it, what the user's umask takes away aside.
constexpr mode_t kNewFileMode = 0666;

int open_retried(const std::string& path, int flags) {
  while (true) {
    const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC, kNewFileMode);
    if (descriptor >= 0 || errno != EINTR) return descriptor;
  }
}

std::string own_link(int descriptor) { return "/proc/self/fd/" + std::to_string(descriptor); }

[[noreturn]] void throw_transfer_error(const std::string& name, const char* verb, std::size_t bytes,
                                       std::uint64_t offset) {
  throw_system_error(name + ": cannot " + verb + " " + std::to_string(bytes) + " bytes at byte " +
                     std::to_string(offset));
}

}  // namespace

std::string random_path(const std::string& folder) {
  std::random_device random;
  return folder + "/.prefilter-" + std::to_string(random());
}

void throw_system_error(const std::string& what) {
  const int error = errno;
  throw Error(ErrorCode::kFile, what + ": " + std::generic_category().message(error));
}

File File::open(const std::string& path) {
  std::string name = "'" + path + "'";
  // A pipe that nobody writes to would be waited for.
  const int descriptor = open_retried(path, O_RDONLY | O_NONBLOCK);
  if (descriptor < 0) throw_system_error(name + ": cannot be opened");
  File file(descriptor, std::move(name));
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) throw_system_error(file.name_ + ": cannot be opened");
  if (!S_ISREG(status.st_mode)) {
    throw Error(ErrorCode::kFile, file.name_ + " is a " +
                                      (S_ISDIR(status.st_mode) ? "folder" : "device or pipe") +
                                      "; a regular file is needed");
  }
  return file;
}

File File::create_unnamed(const std::string& folder, std::string name) {
  if (std::optional<File> file = open_without_name(folder, name)) return *std::move(file);
  // File systems that know no unnamed files have it named for a moment.
  while (true) {
    const std::string path = random_path(folder);
    const int descriptor = open_retried(path, O_RDWR | O_CREAT | O_EXCL);
    if (descriptor < 0 && errno == EEXIST) continue;
    if (descriptor < 0) throw_system_error(name + ": cannot be created");
    File file(descriptor, std::move(name));
    if (::unlink(path.c_str()) != 0) throw_system_error("'" + path + "': cannot be removed");
    return file;
  }
}

std::optional<File> File::create_linkable(const std::string& folder, std::string name) {
  std::optional<File> file = open_without_name(folder, std::move(name));
  // Without /proc there is no way to its name.
  if (file && ::access(own_link(file->descriptor_).c_str(), F_OK) != 0) file.reset();
  return file;
}

File File::create(const std::string& path, std::string name) {
  const int descriptor = open_retried(path, O_RDWR | O_CREAT | O_EXCL);
  if (descriptor < 0) throw_system_error(name + ": cannot be created");
  return File(descriptor, std::move(name));
}

std::optional<File> File::open_without_name([[maybe_unused]] const std::string& folder,
                                            [[maybe_unused]] std::string name) {
#ifdef O_TMPFILE
  const int descriptor = open_retried(folder, O_RDWR | O_TMPFILE);
  if (descriptor >= 0) return File(descriptor, std::move(name));
#endif
  return std::nullopt;
}

File::File(File&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), name_(std::move(other.name_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(name_, other.name_);
  return *this;
}

File::~File() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t File::size() const {
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) throw_system_error(name_ + ": its size is not known");
  return static_cast<std::uint64_t>(status.st_size);
}

std::size_t File::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::pread(descriptor_, bytes.data() + done, bytes.size() - done,
                                static_cast<off_t>(offset + done));
    if (got == 0) break;
    if (got > 0) {
      done += static_cast<std::size_t>(got);
    } else if (errno != EINTR) {
      throw_transfer_error(name_, "read", bytes.size() - done, offset + done);
    }
  }
  return done;
}

void File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put = ::pwrite(descriptor_, bytes.data() + done, bytes.size() - done,
                                 static_cast<off_t>(offset + done));
    if (put >= 0) {
      done += static_cast<std::size_t>(put);
    } else if (errno != EINTR) {
      throw_transfer_error(name_, "write", bytes.size() - done, offset + done);
    }
  }
}

void File::link(const std::string& path) const {
  if (::linkat(AT_FDCWD, own_link(descriptor_).c_str(), AT_FDCWD, path.c_str(),
               AT_SYMLINK_FOLLOW) != 0) {
    throw_system_error(name_ + ": cannot be named '" + path + "'");
  }
}

void File::set_mode(unsigned mode) const {
  if (::fchmod(descriptor_, static_cast<mode_t>(mode)) != 0) {
    throw_system_error(name_ + ": its permissions cannot be set");
  }
}

void File::close() {
  if (::close(std::exchange(descriptor_, -1)) != 0) throw_system_error(name_ + ": cannot write");
}

}  // namespace prefilter
