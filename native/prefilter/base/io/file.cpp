// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/file.h"

#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/random_name.h"

namespace prefilter {
namespace {

using system_file::Kind;

[[noreturn]] void throw_transfer_error(const std::string& name, const char* verb, std::size_t bytes,
                                       std::uint64_t offset) {
  throw_system_error(name + ": cannot " + verb + " " + std::to_string(bytes) + " bytes at byte " +
                     std::to_string(offset));
}

}  // namespace

std::string random_path(const std::string& folder) { return folder + "/" + random_name(); }

void throw_system_error(const std::string& what) {
  const std::string why = system_file::last_error();
  throw Error(ErrorCode::kFile, what + ": " + why);
}

File File::open(const std::string& path) {
  File file(system_file::open(path), "'" + path + "'");
  const std::optional<Kind> kind =
      file.handle_ == system_file::kNone ? std::nullopt : system_file::kind(file.handle_);
  if (!kind) throw_system_error(file.name_ + ": cannot be opened");
  if (*kind != Kind::kRegular) {
    throw Error(ErrorCode::kFile, file.name_ + " is a " +
                                      (*kind == Kind::kFolder ? "folder" : "device or pipe") +
                                      "; a regular file is needed");
  }
  return file;
}

File File::create_temporary(const std::string& folder, std::string name) {
  const system_file::Handle handle = system_file::create_temporary(folder);
  if (handle == system_file::kNone) throw_system_error(name + ": cannot be created");
  return File(handle, std::move(name));
}

std::optional<File> File::create_linkable(const std::string& folder, std::string name) {
  const system_file::Handle handle = system_file::create_linkable(folder);
  if (handle == system_file::kNone) return std::nullopt;
  return File(handle, std::move(name));
}

File File::create(const std::string& path, std::string name) {
  const system_file::Handle handle = system_file::create(path);
  if (handle == system_file::kNone) throw_system_error(name + ": cannot be created");
  return File(handle, std::move(name));
}

File::File(File&& other) noexcept
    : handle_(std::exchange(other.handle_, system_file::kNone)), name_(std::move(other.name_)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(handle_, other.handle_);
  std::swap(name_, other.name_);
  return *this;
}

File::~File() {
  if (handle_ != system_file::kNone) system_file::close(handle_);
}

std::uint64_t File::size() const {
  const std::optional<std::uint64_t> size = system_file::size(handle_);
  if (!size) throw_system_error(name_ + ": its size is not known");
  return *size;
}

std::size_t File::read_at(std::uint64_t offset, std::span<std::byte> bytes) const {
  std::size_t transferred = 0;
  while (transferred < bytes.size()) {
    const std::ptrdiff_t got =
        system_file::read(handle_, offset + transferred, bytes.subspan(transferred));
    if (got < 0)
      throw_transfer_error(name_, "read", bytes.size() - transferred, offset + transferred);
    if (got == 0) break;
    transferred += static_cast<std::size_t>(got);
  }
  return transferred;
}

void File::write_at(std::uint64_t offset, std::span<const std::byte> bytes) {
  std::size_t transferred = 0;
  while (transferred < bytes.size()) {
    const std::ptrdiff_t put =
        system_file::write(handle_, offset + transferred, bytes.subspan(transferred));
    if (put < 0)
      throw_transfer_error(name_, "write", bytes.size() - transferred, offset + transferred);
    transferred += static_cast<std::size_t>(put);
  }
}

void File::link(const std::string& path) {
  if (!system_file::link(handle_, path)) {
    throw_system_error(name_ + ": cannot be put into its folder");
  }
}

void File::sync() {
  if (!system_file::sync(handle_)) throw_system_error(name_ + ": cannot write");
}

void File::copy_permissions(const std::string& from) {
  if (!system_file::copy_permissions(from, handle_)) {
    throw_system_error(name_ + ": its permissions cannot be set");
  }
}

void File::close() {
  if (!system_file::close(std::exchange(handle_, system_file::kNone))) {
    throw_system_error(name_ + ": cannot write");
  }
}

}  // namespace prefilter
