// SPDX-License-Identifier: GPL-3.0-or-later

// BC7F and what calls it as one unit: see native/basisu/in_one.cpp.
#include <ctype.h>
#include <fenv.h>
#include <inttypes.h>
#include <limits.h>
#include <memory.h>
#ifdef __linux__
#include <malloc.h>
#endif

#include <algorithm>
#include <array>
#include <cassert>
#include <cfloat>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <functional>
#include <iterator>
#include <limits>
#include <memory>
#include <mutex>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "prefilter/textures/blocks/encoders.h"

// clang-format off: behind all headers that are not the library's.
#include <in_place_of_std.h>
// clang-format on

namespace linked {
namespace {
// The library adds to it.
namespace std {
using namespace ::std;
using ::std::swap;
}  // namespace std
#include <basisu_transcoder.cpp>
}  // namespace
}  // namespace linked
namespace basist = linked::basist;

#include <names_of_std.h>

#include "prefilter/textures/blocks/bc7f_encoder.cpp"
