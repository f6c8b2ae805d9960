// SPDX-License-Identifier: GPL-3.0-or-later

// Kills a program at the Nth of its calls that change names in a folder, or wait for the disk
// there: loaded before the C library (LD_PRELOAD), it stands in front of these functions. N and the
// folder are in PREFILTER_KILL_AT and PREFILTER_KILL_IN.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdarg>
#include <cstdlib>
#include <string>

namespace {

std::atomic<int> count = 0;

std::string variable(const char* name) {
  const char* const value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::string target_of(const std::string& link) {
  std::array<char, 4096> path{};
  const ssize_t length = ::readlink(link.c_str(), path.data(), path.size());
  return length < 0 ? "" : std::string(path.data(), static_cast<std::size_t>(length));
}

std::string open_path(int file) {
  return target_of(file == AT_FDCWD ? "/proc/self/cwd" : "/proc/self/fd/" + std::to_string(file));
}

void count_path(const std::string& path) {
  static const std::string folder = variable("PREFILTER_KILL_IN");
  static const int number = std::atoi(variable("PREFILTER_KILL_AT").c_str());
  if (number == 0 || path.find(folder) == std::string::npos) return;
  if (++count == number) ::kill(::getpid(), SIGKILL);
}

void count_name(int folder, const char* name) {
  count_path(*name == '/' ? std::string(name) : open_path(folder) + "/" + name);
}

template <typename Function>
Function* original(Function* /*own*/, const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

#define PREFILTER_CALL(function, ...)                       \
  static auto* const next = original(&function, #function); \
  return next(__VA_ARGS__)

extern "C" {

int rename(const char* from, const char* to) noexcept {
  count_name(AT_FDCWD, to);
  PREFILTER_CALL(rename, from, to);
}

int renameat(int from_folder, const char* from, int folder, const char* to) noexcept {
  count_name(folder, to);
  PREFILTER_CALL(renameat, from_folder, from, folder, to);
}

int link(const char* from, const char* to) noexcept {
  count_name(AT_FDCWD, to);
  PREFILTER_CALL(link, from, to);
}

int linkat(int from_folder, const char* from, int folder, const char* to, int flags) noexcept {
  count_name(folder, to);
  PREFILTER_CALL(linkat, from_folder, from, folder, to, flags);
}

int unlink(const char* path) noexcept {
  count_name(AT_FDCWD, path);
  PREFILTER_CALL(unlink, path);
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  count_name(folder, path);
  PREFILTER_CALL(unlinkat, folder, path, flags);
}

int remove(const char* path) noexcept {
  count_name(AT_FDCWD, path);
  PREFILTER_CALL(remove, path);
}

int mkdir(const char* path, mode_t mode) noexcept {
  count_name(AT_FDCWD, path);
  PREFILTER_CALL(mkdir, path, mode);
}

int rmdir(const char* path) noexcept {
  count_name(AT_FDCWD, path);
  PREFILTER_CALL(rmdir, path);
}

int fsync(int file) {
  count_path(open_path(file));
  PREFILTER_CALL(fsync, file);
}

int ftruncate(int file, off_t size) noexcept {
  count_path(open_path(file));
  PREFILTER_CALL(ftruncate, file, size);
}

int ftruncate64(int file, off64_t size) noexcept {
  count_path(open_path(file));
  PREFILTER_CALL(ftruncate64, file, size);
}

int open(const char* path, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if ((flags & O_CREAT) != 0) count_name(AT_FDCWD, path);
  PREFILTER_CALL(open, path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if ((flags & O_CREAT) != 0) count_name(AT_FDCWD, path);
  PREFILTER_CALL(open64, path, flags, mode);
}
}
