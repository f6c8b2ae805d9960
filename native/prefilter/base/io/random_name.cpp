// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/random_name.h"

#include <cstdint>
#include <random>
#include <string_view>

#include "prefilter/base/io/system_file.h"

namespace prefilter {
namespace {

std::string hex(std::uint32_t number, std::size_t digits) {
  std::string text(digits, '0');
  for (std::size_t i = digits; i-- > 0; number /= 16U) text[i] = "0123456789abcdef"[number % 16U];
  return text;
}

// FNV-1a hash, folded to half of kMachineDigits.
std::string machine_digits(std::string_view text) {
  std::uint32_t number = 2166136261U;
  for (const char byte : text) number = (number ^ static_cast<unsigned char>(byte)) * 16777619U;
  return hex(number ^ (number >> 16U), kMachineDigits / 2);
}

}  // namespace

std::string random_name() {
  static const std::string machine =
      machine_digits(system_file::boot_name()) + machine_digits(system_file::host_name());
  std::random_device random;
  return ".prefilter-" + machine + hex(random(), 8);
}

}  // namespace prefilter
