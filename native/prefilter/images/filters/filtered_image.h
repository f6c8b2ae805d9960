// SPDX-License-Identifier: GPL-3.0-or-later

// Prepares an image for filters: checks that it is finite, and multiplies it by alpha if necessary.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/run.h"
#include "prefilter/base/value_range.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// Refers to the source if it needs no change, else holds a copy. The source must outlive it.
class FilteredImage {
 public:
  /// 1 for each texel that the filter reads, else 0.
  using FindRead = std::function<std::vector<unsigned char>()>;

  struct Options {
    // The coverage channel, the last of two to four, by which the others are not yet multiplied;
    // none to filter every channel independently.
    std::optional<int> alpha;
    // Whether results are opaque where the image is; false if a transparent border takes part.
    // Colors are only multiplied by alpha, and divided, if it can be below 1.
    bool stays_opaque = true;
    // Whether bytes must be converted to floats even if alpha plays no part.
    bool needs_floats = true;
    // Whether bytes are never converted as a whole, because the caller uses `read`.
    bool is_read_by_rows = false;
    const char* name = "image";  // in error messages
    Run run;
  };

  /// `find_read` is only called if some texels are not finite or not opaque. Throws Error if a
  /// texel that is read is not finite or beyond 1e30; other such texels become 0.
  FilteredImage(const TexelSource& source, const FindRead& find_read, const Options& options);

  /// The texels to filter: unmodified bytes, or floats.
  TexelSource texels() const { return floats_.data == nullptr ? source_ : TexelSource(floats_); }
  /// The texels to filter as floats; without data if they are unmodified bytes.
  const ImageView& floats() const { return floats_; }

  /// Converts texels [begin, end) of a row of bytes to values, multiplied by alpha if
  /// `is_multiplied`. Only valid without `floats`.
  void read(int y, int begin, int end, float* values) const;

  int width() const { return source_.width; }
  int height() const { return source_.height; }
  int channels() const { return source_.channels; }

  /// Whether colors were multiplied by alpha, because it is not 1 everywhere or will not stay so.
  bool is_multiplied() const { return is_multiplied_; }

  /// The range of a channel for a solver, from the range `bounds` of the final result. If colors
  /// are multiplied by alpha, a visible color must also stay within the image's own range. It is a
  /// quotient of two solutions, and at low coverage small errors of either would make it arbitrary.
  ValueRange solved_range(int channel, ValueRange bounds) const;

  /// Divides the colors of a level by its alpha if they were multiplied. Colors with hardly any
  /// alpha are filled from their surroundings.
  void divide_by_alpha(WrapModes wrap, const Run& run, Image* level) const;

 private:
  void check(const FindRead& find_read, const Options& options);
  void multiply_by_alpha(const FindRead& find_read, const Options& options);
  Image& own_copy();
  // Finds the ranges of the colors of non-transparent byte texels.
  void find_byte_colors(const Options& options);
  // Whether bytes are multiples of 1/255, which needs no table.
  bool bytes_are_shares() const;

  const TexelSource& source_;
  ImageView floats_;
  int alpha_;  // the channel, if any
  Image copy_;
  bool is_multiplied_ = false;
  bool has_shares_ = false;
  std::array<ValueRange, 3> colors_{};  // of non-transparent texels, before multiplication by alpha
};

}  // namespace prefilter
