// SPDX-License-Identifier: GPL-3.0-or-later

// An image as the filters read it: finite, and multiplied by its alpha where that counts.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/value_range.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// The image itself where it can be read as it is, else a copy. The source must outlive it.
class FilteredImage {
 public:
  /// 1 for each texel that the filter reads, else 0.
  using FindRead = std::function<std::vector<unsigned char>()>;

  struct Options {
    // The channel, the last of two to four, that is coverage and which the others are not
    // multiplied by yet; none where every channel is filtered as it stands.
    std::optional<int> alpha;
    // Whether what is filtered is opaque where the image is: not where a border of nothing counts.
    // Colors are multiplied by alpha, and divided, only where it may be less than 1.
    bool stays_opaque = true;
    // Whether bytes have to be floats, also where alpha plays no part.
    bool needs_floats = true;
    // Whether bytes stay bytes whatever alpha does, because `read` is asked for what they are.
    bool is_read_by_rows = false;
    const char* name = "image";  // what errors call it
    int threads = 0;
    Progress progress;
  };

  /// `find_read` is called where not all texels are finite, or opaque. Throws Error where a texel
  /// that is read is not finite or beyond 1e30; others that are not become 0.
  FilteredImage(const TexelSource& source, const FindRead& find_read, const Options& options);

  /// What is read: bytes as they are, or floats.
  TexelSource texels() const { return floats_.data == nullptr ? source_ : TexelSource(floats_); }
  /// The same; no data where bytes are read as they are.
  const ImageView& floats() const { return floats_; }

  /// The values of bytes, multiplied by alpha where `is_multiplied`: of texels from `begin` to
  /// before `end` of a row. To be called where there are no `floats`.
  void read(int y, int begin, int end, float* values) const;

  int width() const { return source_.width; }
  int height() const { return source_.height; }
  int channels() const { return source_.channels; }

  /// Whether colors were multiplied by an alpha that is not 1 everywhere, or does not stay so.
  bool is_multiplied() const { return is_multiplied_; }

  /// What a channel may be while it is solved for, `bounds` being what it may be in the end. Where
  /// colors were multiplied by alpha, a color that is seen lies within the bounds and within the
  /// image's own range: it is the quotient of two solutions, and where little is covered a small
  /// error of either would make it anything.
  ValueRange solved_range(int channel, ValueRange bounds) const;

  /// Divides the colors of a level by its alpha where those of the image were multiplied by it.
  /// Those of texels with hardly any alpha come from around them.
  void divide_by_alpha(WrapModes wrap, const Progress& progress, int threads, Image* level) const;

 private:
  void check(const FindRead& find_read, const Options& options);
  void multiply_by_alpha(const FindRead& find_read, const Options& options);
  Image& own_copy();
  // The ranges of the colors of bytes that are not transparent.
  void find_byte_colors(const Options& options);
  // Where bytes stand for a 255th each, which takes no table.
  bool bytes_are_shares() const;

  const TexelSource& source_;
  ImageView floats_;
  int alpha_;  // the channel, where there is one
  Image copy_;
  bool is_multiplied_ = false;
  bool has_shares_ = false;
  std::array<ValueRange, 3> colors_{};  // of texels with alpha, before they are multiplied by it
};

}  // namespace prefilter
