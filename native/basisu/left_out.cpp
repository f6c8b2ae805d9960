// SPDX-License-Identifier: GPL-3.0-or-later

// What Basis Universal calls for other work than encoding blocks, in sources that are not built; a
// part of in_one.cpp.
#include <cstdlib>

#include "encoder/basisu_enc.h"
#include "encoder/basisu_pvrtc1_4.h"
#include "encoder/basisu_resampler.h"
#include "encoder/jpgd.h"
#include "encoder/pvpngreader.h"
#define MINIZ_HEADER_FILE_ONLY
#define MINIZ_NO_ZLIB_COMPATIBLE_NAMES
#include "encoder/basisu_miniz.h"

namespace basisu {
void detect_sse41() { std::abort(); }
std::uint32_t pvrtc4_swizzle_uv(std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t) {
  std::abort();
}
color_rgba pvrtc4_image::get_pixel(std::uint32_t, std::uint32_t, std::uint32_t) const {
  std::abort();
}
Resampler::Resampler(int, int, int, int, Boundary_Op, Resample_Real, Resample_Real, const char*,
                     Contrib_List*, Contrib_List*, Resample_Real, Resample_Real, Resample_Real,
                     Resample_Real) {
  std::abort();
}
Resampler::~Resampler() { std::abort(); }
bool Resampler::put_line(const Sample*) { std::abort(); }
const Resampler::Sample* Resampler::get_line() { std::abort(); }
}  // namespace basisu

namespace buminiz {
void* tdefl_write_image_to_png_file_in_memory_ex(const void*, int, int, int, std::size_t*, mz_uint,
                                                 mz_bool) {
  std::abort();
}
}  // namespace buminiz

namespace jpgd {
unsigned char* decompress_jpeg_image_from_file(const char*, int*, int*, int*, int, std::uint32_t) {
  std::abort();
}
}  // namespace jpgd

namespace pv_png {
void* load_png(const void*, std::size_t, std::uint32_t, std::uint32_t&, std::uint32_t&,
               std::uint32_t&) {
  std::abort();
}
}  // namespace pv_png
