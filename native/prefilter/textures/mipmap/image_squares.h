// SPDX-License-Identifier: GPL-3.0-or-later

// Integrals over the surface of an image squared, which errors are measured from.
#pragma once

#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/wrap.h"
#include "prefilter/textures/mipmap/seam_search.h"
#include "prefilter/textures/texels/moment_sweep.h"

namespace prefilter {

/// The integral over a block of level 0 of the block's image times another of the same size, both
/// looked up bilinearly.
template <int C>
ChannelSums integral_with(const MomentBlock<C>& block, const ImageView& image, WrapModes wrap);

/// The same of the means in place of the block's image.
template <int C>
ChannelSums integral_of_means_with(const MomentBlock<C>& block, const ImageView& image,
                                   WrapModes wrap);

/// The integral over a block of level 0 of the square of an image that is decoded after the lookup.
template <int C>
ChannelSums integral_of_decoded_square(const MomentBlock<C>& block);

/// Sums over blocks, the same in whatever order blocks are visited.
class BlockSums {
 public:
  BlockSums(int width, int height)
      : parts_(static_cast<std::size_t>(sweep_block_count(width, height))) {}
  /// Blocks may be added at the same time.
  void add(std::int64_t block, const ChannelSums& sums) { parts_[block] = sums; }
  ChannelSums total() const;

 private:
  std::vector<ChannelSums> parts_;
};

}  // namespace prefilter
