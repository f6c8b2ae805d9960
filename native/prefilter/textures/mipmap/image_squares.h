// SPDX-License-Identifier: GPL-3.0-or-later

// Integrals over the surface of squared images, used to compute fitting errors.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/seam_search.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// Integral over a level 0 block of the block's image times another image of the same size, both
/// interpolated bilinearly.
template <int C>
ChannelSums integral_with(const MomentBlock<C>& block, const ImageView& image, WrapModes wrap);

/// The same for the means instead of the block's image.
template <int C>
ChannelSums integral_of_means_with(const MomentBlock<C>& block, const ImageView& image,
                                   WrapModes wrap);

/// Integral over a level 0 block of the square of an image that is decoded after the lookup.
template <int C>
ChannelSums integral_of_decoded_square(const MomentBlock<C>& block);

/// Sums over blocks that do not depend on the order of visits.
class BlockSums {
 public:
  BlockSums(int width, int height)
      : parts_(static_cast<std::size_t>(sweep_block_count(width, height))) {}
  /// Blocks may be added concurrently.
  void add(std::int64_t block, const ChannelSums& sums) { parts_[block] = sums; }
  ChannelSums total() const;

 private:
  std::vector<ChannelSums> parts_;
};

}  // namespace prefilter
