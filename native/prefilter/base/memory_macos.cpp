// SPDX-License-Identifier: GPL-3.0-or-later

#include <mach/mach.h>

#include <limits>

#include "prefilter/base/memory.h"

namespace prefilter {

std::uint64_t available_memory() {
  // mach_host_self returns a port that must be released.
  const host_t host = mach_host_self();
  vm_size_t page_size = 0;
  vm_statistics64_data_t pages{};
  mach_msg_type_number_t count = HOST_VM_INFO64_COUNT;
  const bool is_known =
      host_page_size(host, &page_size) == KERN_SUCCESS &&
      host_statistics64(host, HOST_VM_INFO64, reinterpret_cast<host_info64_t>(&pages), &count) ==
          KERN_SUCCESS;
  mach_port_deallocate(mach_task_self(), host);
  if (!is_known) return std::numeric_limits<std::uint64_t>::max();
  // Inactive pages are reclaimed on demand.
  const std::uint64_t available = std::uint64_t{pages.free_count} + pages.inactive_count;
  return available * page_size;
}

}  // namespace prefilter
