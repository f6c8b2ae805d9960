// SPDX-License-Identifier: GPL-3.0-or-later

// The encoders of Basis Universal and what calls them as one unit. The library is in a nameless
// namespace, so that the compiler drops what nothing calls of it before it works on it: that is
// most of the library. Headers of the system's and our own are read before, outside of that
// namespace.
#include <ctype.h>
#include <inttypes.h>
#include <limits.h>
#include <memory.h>
#include <time.h>
#ifdef _WIN32
#include <windows.h>
#else
#include <sys/time.h>
#endif
#ifdef __linux__
#include <malloc.h>
#include <sys/timex.h>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cfloat>
#include <condition_variable>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <ostream>
#include <queue>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/textures/blocks/decoders.h"
#include "prefilter/textures/blocks/encoders.h"
#include "prefilter/textures/compress_etc1s.h"

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
#include <encoder/basisu_backend.cpp>
#include <encoder/basisu_bc7enc.cpp>
#include <encoder/basisu_enc.cpp>
#include <encoder/basisu_etc.cpp>
#include <encoder/basisu_frontend.cpp>
#include <encoder/basisu_gpu_texture.cpp>
#include <encoder/basisu_opencl.cpp>
#include <encoder/basisu_uastc_enc.cpp>
#include <transcoder/basisu_transcoder.cpp>

#include "left_out.cpp"
}  // namespace
}  // namespace linked
namespace basist = linked::basist;
namespace basisu = linked::basisu;

#include <names_of_std.h>

#include "prefilter/textures/blocks/basis_decoder.cpp"
#include "prefilter/textures/blocks/etc1s_encoder.cpp"
#include "prefilter/textures/blocks/uastc_encoder.cpp"
