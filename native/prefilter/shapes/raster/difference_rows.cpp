// SPDX-License-Identifier: GPL-3.0-or-later

// Memory is reused between bands, and stays 0 between them.
#include "prefilter/shapes/raster/difference_rows.h"

namespace prefilter {

void DifferenceRows::begin(int width, int first_row, int end_row) {
  const int behind = (width + kMargin + kBlock - 1) / kBlock * kBlock;
  const int blocks = (behind / kBlock + 1 + 7) / 8 * 8;
  const std::size_t rows = static_cast<std::size_t>(end_row - first_row) + kRowsBehind;
  // All values are 0, so rows of another length only need enough memory.
  if (steps_.size() < rows * (kBlock + behind)) steps_.resize(rows * (kBlock + behind));
  if (is_marked_.size() < rows * blocks) is_marked_.resize(rows * blocks);
  if (left_.size() < rows) left_.resize(rows);
  width_ = width;
  first_row_ = first_row;
  end_row_ = end_row;
  stride_ = kBlock + behind;
  blocks_ = blocks;
}

}  // namespace prefilter
