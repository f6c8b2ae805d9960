// SPDX-License-Identifier: GPL-3.0-or-later

// Sparse linear systems for the texels of one level, which couple each texel with its eight
// neighbors, and their solution within ranges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/run.h"
#include "prefilter/base/solve/link_form.h"
#include "prefilter/base/value_range.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// A range for each texel, in the order of NinePointSystem::at; limits must be finite floats.
struct TexelRanges {
  std::vector<LaneValues> low;
  std::vector<LaneValues> high;
};

struct SolveOptions {
  std::array<ValueRange, kMaxChannels> ranges{};
  // Ranges of individual texels, which replace those above.
  const TexelRanges* texel_ranges = nullptr;
  // Whether the ranges of the first three channels are multiplied by the texel's fourth, alpha.
  bool ranges_times_alpha = false;
  // Stops when no texel moves by more than this, relative to the larger of its own value and a
  // typical one of its channel.
  double tolerance = 1e-5;
  int max_sweeps = 300;
};

/// A symmetric system for up to four channels at once. The type of its entries is float if the
/// channels share them, and LaneValues if each has its own.
template <typename Entry>
class NinePointSystem {
 public:
  NinePointSystem(int width, int height, WrapModes wrap);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Integrals of the products of the four tents over a cell between texel centers: for low x low,
  /// low x high and high x high along x and the same along y, at [3 * y + x].
  using TentProducts = std::array<Entry, 9>;
  /// Integrals of the target times the tents: low and high along x, at [2 * y + x].
  using TentIntegrals = std::array<LaneValues, 4>;

  /// Adds the integrals over the cell between texels (column, row) and (column + 1, row + 1). Cells
  /// that share texels must not be added concurrently.
  void add_cell(int column, int row, const TentProducts& products, const TentIntegrals& right);

  std::ptrdiff_t at(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * stride_ + x; }
  std::size_t size() const { return stencils_.size(); }
  Entry& diagonal(std::ptrdiff_t at) { return stencils_[at].center; }
  LaneValues& right_side(std::ptrdiff_t at) { return right_side_[at]; }
  LaneValues& texel(std::ptrdiff_t at) { return texels_[at]; }
  const LaneValues& texel(std::ptrdiff_t at) const { return texels_[at]; }
  /// Removes all cells and links; texels remain.
  void clear();

  const LaneValues& right_side(std::ptrdiff_t at) const { return right_side_[at]; }

  /// The matrix times the texels, in the order of `at`; 0 next to texels with a diagonal of 0. To
  /// be called before invert_diagonal.
  std::vector<LaneValues> product() const;

  /// Prepares for `solve`: from here on `diagonal` contains the inverse, or 0 for texels that are
  /// not part of the system (with a diagonal of 0), which do not change.
  void invert_diagonal();
  bool is_part(std::ptrdiff_t at) const;

  /// Adds the squares of links, between texels that are part of the system, with a weight per
  /// channel. If channels share entries, the first weight applies to all. A null pointer or weights
  /// of 0 remove links. To be called after invert_diagonal; the links must outlive their use in the
  /// system.
  void weigh_links(const LinkForm* links, Lanes weights);

  void swap_right_side(std::vector<LaneValues>* right) { right_side_.swap(*right); }

  /// Allocates the texels, all 0.
  void make_texels() { texels_.assign(stencils_.size(), LaneValues{}); }

  /// Moves the texels from their current values to the solution within the ranges, by projected
  /// Gauss-Seidel over rows of alternating color; the result is the same for any number of threads.
  /// If the system is nearly singular, as under charts that shrink to points, texels may stop some
  /// distance from the solution, where the objective hardly changes. Returns the number of sweeps.
  int solve(const SolveOptions& options, const Run& run);

  /// t' A t - 2 b' t for each channel, with the texels t and the matrix A without links, reduced by
  /// `less` on its diagonal. To be called after invert_diagonal.
  std::array<double, kMaxChannels> form(const std::vector<LaneValues>& b, float less,
                                        int threads) const;

  /// Returns the texels as an image, and destroys the system.
  Image take_image(int channels);

 private:
  // Entries of a texel with itself and with its neighbors east, north, north-east and north-west.
  struct Stencil {
    Entry center{};
    Entry east{};
    Entry north{};
    Entry north_east{};
    Entry north_west{};
  };

  class Row;

  void add_pair(int x, int y, int dx, int dy, Entry value);
  // The row below (step -1) or above (1), or the row of zeros if there is none.
  int row_beside(int y, int step) const;
  // Relaxes every texel of a row; true if a channel moved by more than the tolerance.
  bool relax_row(int y, const SolveOptions& options, Lanes typical);
  // The first linked texel in a row, or after it.
  std::vector<LinkForm::Texel>::const_iterator first_linked(int y) const;
  // Relaxes every linked texel, sequentially because links may connect distant texels. Marks the
  // rows of texels that moved.
  void relax_linked(const SolveOptions& options, Lanes typical, std::vector<unsigned char>* moves,
                    const std::function<bool()>& goes_on);
  // A typical value of each channel: the median over rows of the mean magnitude of texels in use.
  Lanes typical_values() const;

  int width_;
  int height_;
  WrapModes wrap_;
  // Rows have one additional texel, and there is one additional row, with entries of zero: the
  // neighbors of texels at the edge of a clamped or bordered level.
  int stride_;
  std::vector<Stencil> stencils_;
  std::vector<LaneValues> right_side_;
  std::vector<LaneValues> texels_;

  const LinkForm* links_ = nullptr;
  Lanes link_weights_{};
  std::vector<Entry> alone_;  // the diagonals of linked texels without their links
};

}  // namespace prefilter
