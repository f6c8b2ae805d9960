// SPDX-License-Identifier: GPL-3.0-or-later

// Shapes to images, filtered in closed form: chapter 2.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/names.h"
#include "prefilter/base/outline.h"
#include "prefilter/base/progress.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// What an outline encloses, painted. Coordinates are pixels; pixel (i, j) is [i, i + 1) x
/// [j, j + 1), and row 0 is the lowest.
struct Shape {
  Outline outline;
  FillRule fill_rule = FillRule::kNonzero;
  Paint paint;
  /// The caller knows that contours wind once, counter-clockwise, round what they fill. A point
  /// then counts as often as they wind round it, and no overlaps are looked for.
  bool winds_once = false;
};

enum class RasterMethod : std::uint8_t {
  kScanline,  // section 2.2
  /// Chapter 3: Haar coefficients. For the box filter and constant colors. Open contours are left
  /// so; a shape that has one is the sum of its winding numbers, whatever its fill rule.
  kWavelet,
};

inline constexpr Named<RasterMethod> kRasterMethods[] = {{"scanline", RasterMethod::kScanline},
                                                         {"wavelet", RasterMethod::kWavelet}};

/// What becomes of several shapes at one place.
enum class Overlap : std::uint8_t {
  kAdd,    // their values are added
  kCover,  // a later one covers those before it, as far as it is opaque
};

inline constexpr Named<Overlap> kOverlaps[] = {{"add", Overlap::kAdd}, {"cover", Overlap::kCover}};

/// The names of all filters of shapes.
std::span<const std::string_view> raster_filters();

struct RasterOptions {
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::string filter = "box";
  RasterMethod method = RasterMethod::kScanline;
  /// Of kWavelet: the synthesis ends at cells of which so many, doubled, make the side of the
  /// square of the smallest power of two that holds the image; -1: at pixels.
  int depth = -1;
  Overlap overlap = Overlap::kCover;
  /// What shows where no shape is; none for 0.
  std::vector<float> background;
  int threads = 0;
  Progress progress;
};

/// The image of all shapes, each pixel the filter's mean around its center. Throws Error for shapes
/// of different numbers of channels, points that are not finite, a filter there is not, a size of
/// 0 or one that memory does not hold, and for what the method does not have.
Image rasterize(std::span<const Shape> shapes, const RasterOptions& options);

/// Interleaved bytes, in the layout of Image.
struct ByteImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::uint8_t> data;
};

/// The same, with the floats from 0 to 1 as 0 to 255: rounded to the nearest, halves to even, and
/// cut off outside.
ByteImage rasterize_bytes(std::span<const Shape> shapes, const RasterOptions& options);

}  // namespace prefilter
