// SPDX-License-Identifier: GPL-3.0-or-later

// The measured rasterizers behind one interface: ours and others', one file each.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/shapes/patterns.h"

namespace prefilter::bench {

/// A pattern in a rasterizer's own form, and an image to draw it into. One thread.
class Drawing {
 public:
  virtual ~Drawing() = default;

  /// Converts the current pattern to the rasterizer's own path, which replaces the earlier one.
  virtual void build() = 0;
  /// Clears the image; not timed.
  virtual void clear() = 0;
  /// Draws the path over the image's content.
  virtual void draw() = 0;
  /// The image's coverage of each pixel, 0 to 1, rows from y = 0 on.
  virtual std::vector<float> coverage() const = 0;
};

struct Rasterizer {
  std::string name;
  /// Whether curves can be told how near to follow.
  bool has_tolerance;
  /// Makes a drawing, with its path. `fineness` divides the rasterizer's own tolerance of curves.
  /// Empty where it cannot draw the pattern.
  std::function<std::unique_ptr<Drawing>(const Pattern&, double fineness)> open;
};

/// Prefilter with the box filter: into bytes, with overlaps looked for before, and into floats.
std::vector<Rasterizer> our_boxes();
/// Prefilter into floats with each of its filters, by their names, and with its other method.
std::vector<Rasterizer> our_filters();
/// Coverage of a pattern's contours, each a shape of its own, added by Prefilter.
std::vector<float> our_sum(const Pattern& pattern);

Rasterizer agg_rasterizer();
Rasterizer packed_agg_rasterizer();
Rasterizer cairo_rasterizer();
Rasterizer freetype_rasterizer();
Rasterizer blend2d_rasterizer();
Rasterizer skia_rasterizer();
Rasterizer vello_cpu_rasterizer();
Rasterizer tiny_skia_rasterizer();

/// 8-bit coverage as `Drawing` has it.
std::vector<float> from_bytes(const std::vector<std::uint8_t>& bytes);

}  // namespace prefilter::bench
