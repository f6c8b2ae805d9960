// SPDX-License-Identifier: GPL-3.0-or-later

// Linear systems between the texels of one level in which each texel meets its eight neighbors,
// and their solution within ranges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/solve/link_form.h"
#include "prefilter/base/value_range.h"
#include "prefilter/base/wrap.h"

namespace prefilter {

/// A range for each texel, in the order of NinePointSystem::at, as wide as floats go at the most.
struct TexelRanges {
  std::vector<LaneValues> low;
  std::vector<LaneValues> high;
};

struct SolveOptions {
  std::array<ValueRange, kMaxChannels> ranges{};
  // Instead of those, where texels have ranges of their own.
  const TexelRanges* texel_ranges = nullptr;
  // Whether the ranges of the first three channels are multiplied by a texel's fourth, its alpha.
  bool ranges_times_alpha = false;
  // Stops when no texel moves by more than this, against its own value or a typical one of its
  // channel, whichever is larger.
  double tolerance = 1e-5;
  int max_sweeps = 300;
  int threads = 0;
};

/// A symmetric system for up to four channels at once. Its entries are float where the channels
/// share them, and LaneValues where each has its own.
template <typename Entry>
class NinePointSystem {
 public:
  NinePointSystem(int width, int height, WrapModes wrap);

  int width() const { return width_; }
  int height() const { return height_; }

  /// Integrals, over a cell between four texel centers, of the products of the tents there: those
  /// along x of low x low, low x high and high x high, for the same along y, at [3 * y + x].
  using TentProducts = std::array<Entry, 9>;
  /// Integrals of what stands on the right, times the tents: low and high along x, at [2 * y + x].
  using TentIntegrals = std::array<LaneValues, 4>;

  /// Adds the integrals over the cell between texels (column, row) and (column + 1, row + 1). Cells
  /// that share texels must not be added at the same time.
  void add_cell(int column, int row, const TentProducts& products, const TentIntegrals& right);

  std::ptrdiff_t at(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * stride_ + x; }
  std::size_t size() const { return stencils_.size(); }
  Entry& diagonal(std::ptrdiff_t at) { return stencils_[at].center; }
  LaneValues& right_side(std::ptrdiff_t at) { return right_side_[at]; }
  LaneValues& texel(std::ptrdiff_t at) { return texels_[at]; }
  const LaneValues& texel(std::ptrdiff_t at) const { return texels_[at]; }
  /// What add_cell and add_links put together is forgotten; texels stay.
  void clear();

  const LaneValues& right_side(std::ptrdiff_t at) const { return right_side_[at]; }

  /// The system times its texels, in the order of `at`; 0 beside texels with a diagonal of 0. To be
  /// called before invert_diagonal.
  std::vector<LaneValues> product() const;

  /// Makes the system ready for `solve`: from here on `diagonal` holds the inverse, or 0 for texels
  /// that are not part of it (a diagonal of 0), which stay as they are.
  void invert_diagonal();
  bool is_part(std::ptrdiff_t at) const;

  /// Has links count, which are those of texels that are part of the system: the squares of each
  /// channel times its weight; where channels share entries the weight of the first is for all.
  /// None for a null pointer or weights of 0. To be called after invert_diagonal; links must
  /// outlive what is done with the system then.
  void weigh_links(const LinkForm* links, Lanes weights);

  void swap_right_side(std::vector<LaneValues>* right) { right_side_.swap(*right); }

  /// Allocates the texels, all 0.
  void make_texels() { texels_.assign(stencils_.size(), LaneValues{}); }

  /// Moves the texels to the solution within the ranges, from where they are: projected
  /// Gauss-Seidel, by rows of alternating color, so the result is the same for any number of
  /// threads. Where the system is all but singular, as under charts that shrink to points, texels
  /// may stop some way from it: moving them on would change the minimized form by next to nothing.
  /// Returns the number of sweeps.
  int solve(const SolveOptions& options, const Progress& progress);

  /// t' A t - 2 b' t of each channel, for the texels t and the matrix A without links, from whose
  /// diagonal `less` is taken. To be called after invert_diagonal.
  std::array<double, kMaxChannels> form(const std::vector<LaneValues>& b, float less,
                                        int threads) const;

  /// The texels as an image; the system is gone then.
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
  // The row below (step -1) or above (1), or the row of zeros where there is none.
  int row_beside(int y, int step) const;
  // One step of every texel of a row; true where a channel moved by more than the tolerance.
  bool relax_row(int y, const SolveOptions& options, Lanes typical);
  // The first of the texels that links meet in a row, or after it.
  std::vector<LinkForm::Texel>::const_iterator first_linked(int y) const;
  // One step of every texel that links meet, in order: they can be anywhere, so they move by
  // themselves. Marks the rows of those that moved.
  void relax_linked(const SolveOptions& options, Lanes typical, std::vector<unsigned char>* moves,
                    const std::function<bool()>& goes_on);
  // A typical value of each channel: the median over rows of the mean magnitude of the texels in
  // use.
  Lanes typical_values() const;

  int width_;
  int height_;
  WrapModes wrap_;
  // Rows are one texel longer than the level, and there is one more of them: entries of zero, which
  // are what texels at the edge of a clamped or bordered level have as neighbors.
  int stride_;
  std::vector<Stencil> stencils_;
  std::vector<LaneValues> right_side_;
  std::vector<LaneValues> texels_;

  const LinkForm* links_ = nullptr;  // of those that count
  Lanes link_weights_{};
  std::vector<Entry> alone_;  // the diagonals without links of the texels that they meet
};

}  // namespace prefilter
