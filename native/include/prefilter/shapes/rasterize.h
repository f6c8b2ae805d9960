// SPDX-License-Identifier: GPL-3.0-or-later

// Rasterization of shapes, filtered in closed form: chapter 2.
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
#include "prefilter/base/run.h"
#include "prefilter/shapes/paint.h"

namespace prefilter {

/// A painted outline. Coordinates are in pixels; pixel (i, j) is [i, i + 1) x [j, j + 1), and row 0
/// is the lowest.
struct Shape {
  Outline outline;
  FillRule fill_rule = FillRule::kNonzero;
  Paint paint;
  /// The caller guarantees that contours wind once, counter-clockwise, around the filled part.
  /// Overlaps are then not resolved: a point counts as often as the contours wind around it.
  bool winds_once = false;
};

enum class RasterMethod : std::uint8_t {
  kScanline,  // section 2.2
  /// Chapter 3: Haar coefficients, for the box filter and constant colors. Open contours are not
  /// closed; a shape that has one is the sum of its winding numbers, whatever its fill rule.
  kWavelet,
};

inline constexpr Named<RasterMethod> kRasterMethods[] = {{"scanline", RasterMethod::kScanline},
                                                         {"wavelet", RasterMethod::kWavelet}};

/// How overlapping shapes are combined.
enum class Overlap : std::uint8_t {
  kAdd,    // values are added
  kCover,  // later shapes cover earlier ones, as far as they are opaque
};

inline constexpr Named<Overlap> kOverlaps[] = {{"add", Overlap::kAdd}, {"cover", Overlap::kCover}};

/// The names of all filters for shapes.
std::span<const std::string_view> raster_filters();

struct RasterOptions {
  int width = 0;   // pixels
  int height = 0;  // pixels
  std::string filter = "box";
  RasterMethod method = RasterMethod::kScanline;
  /// For kWavelet: the depth at which synthesis ends, in halvings of the smallest square that holds
  /// the image and whose side is a power of two; -1 stands for the depth of pixels.
  int depth = -1;
  Overlap overlap = Overlap::kCover;
  /// Values where no shape is; empty for 0.
  std::vector<float> background;
  Run run;
};

/// Renders shapes; each pixel is the filtered mean around its center. Throws Error for shapes with
/// different numbers of channels, points that are not finite, an unknown filter, a size of 0 or
/// beyond the available memory, and features that the method does not support.
Image rasterize(std::span<const Shape> shapes, const RasterOptions& options);

/// Interleaved bytes, in the layout of Image.
struct ByteImage {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<std::uint8_t> data;
};

/// Renders as `rasterize`, with [0, 1] mapped to 0 to 255: rounded to the nearest, halves to even,
/// and clamped.
ByteImage rasterize_bytes(std::span<const Shape> shapes, const RasterOptions& options);

}  // namespace prefilter
