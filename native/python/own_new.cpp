// SPDX-License-Identifier: GPL-3.0-or-later

// This module's own operators new and delete, hidden by -fvisibility-global-new-delete. Zig's
// linker cannot restrict the symbols that a module for macOS exports, so the operators of its C++
// library would be visible from outside.
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {
// Calls no new-handler, as nothing in the module sets one.
void* allocated(std::size_t size) noexcept { return std::malloc(std::max<std::size_t>(size, 1)); }

void* allocated(std::size_t size, std::align_val_t alignment) noexcept {
  void* place = nullptr;
  const std::size_t at = std::max(static_cast<std::size_t>(alignment), sizeof(void*));
  return ::posix_memalign(&place, at, std::max<std::size_t>(size, 1)) == 0 ? place : nullptr;
}

void* checked(void* place) {
  if (place == nullptr) throw std::bad_alloc();
  return place;
}
}  // namespace

void* operator new(std::size_t size) { return checked(allocated(size)); }
void* operator new[](std::size_t size) { return checked(allocated(size)); }
void* operator new(std::size_t size, std::align_val_t at) { return checked(allocated(size, at)); }
void* operator new[](std::size_t size, std::align_val_t at) { return checked(allocated(size, at)); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return allocated(size); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return allocated(size); }
void* operator new(std::size_t size, std::align_val_t at, const std::nothrow_t&) noexcept {
  return allocated(size, at);
}
void* operator new[](std::size_t size, std::align_val_t at, const std::nothrow_t&) noexcept {
  return allocated(size, at);
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete[](void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete[](void* place, std::align_val_t) noexcept { std::free(place); }
void operator delete(void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }
void operator delete[](void* place, std::size_t, std::align_val_t) noexcept { std::free(place); }
void operator delete(void* place, const std::nothrow_t&) noexcept { std::free(place); }
void operator delete[](void* place, const std::nothrow_t&) noexcept { std::free(place); }
void operator delete(void* place, std::align_val_t, const std::nothrow_t&) noexcept {
  std::free(place);
}
void operator delete[](void* place, std::align_val_t, const std::nothrow_t&) noexcept {
  std::free(place);
}
