// SPDX-License-Identifier: GPL-3.0-or-later

// What libFuzzer calls. PREFILTER_FUZZ in the environment is the name of a target.

#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "fuzz/targets.h"

namespace {

const prefilter::FuzzTarget& chosen_target() {
  const char* name = std::getenv("PREFILTER_FUZZ");
  for (const prefilter::FuzzTarget& target : prefilter::fuzz_targets()) {
    if (name != nullptr && target.name == name) return target;
  }
  std::fputs("PREFILTER_FUZZ: allowed are", stderr);
  for (const prefilter::FuzzTarget& target : prefilter::fuzz_targets()) {
    std::fprintf(stderr, " %.*s", static_cast<int>(target.name.size()), target.name.data());
  }
  std::fputs("\n", stderr);
  std::exit(2);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const prefilter::FuzzTarget& target = chosen_target();
  target.read({data, size});
  return 0;
}
