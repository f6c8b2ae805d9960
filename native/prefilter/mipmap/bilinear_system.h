// The least-squares problem of one level: which texels, looked up bilinearly, come closest to the
// image over the surface (section 7.3 with the bilinear basis).
#pragma once

#include <array>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/progress.h"
#include "prefilter/base/wrap.h"
#include "prefilter/mipmap/moment_sweep.h"

namespace prefilter {

/// Lowest and highest value a channel may take.
struct ValueRange {
  float low;
  float high;
};

/// Minimises, over the texels t of a level and for each channel,
///   integral over the surface of (sum_j b_j t_j - I)^2  +  kPull * m * sum_j (t_j - p_j)^2
/// where b_j are the bilinear basis functions, m is the mean of the integrals of b_j^2 over the
/// texels in use, and p_j is the mean of the image under b_j. The second term decides for texels
/// that hardly any of the surface reads, and leaves the others alone.
template <int C>
class BilinearSystem {
 public:
  static constexpr double kPull = 1e-3;

  BilinearSystem(int width, int height, WrapModes wrap);

  /// Adds the integrals over the cells of one block of this level. Blocks that share texels must
  /// not be added at the same time.
  void add(const MomentBlock<C>& block);

  struct SolveOptions {
    std::array<ValueRange, C> ranges;
    // Whether the ranges of the first three channels are multiplied by a texel's fourth, its alpha.
    bool ranges_times_alpha = false;
    // Stops when no texel moves by more than this, against its own value or a typical one of its
    // channel, whichever is larger.
    double tolerance = 1e-5;
    int max_sweeps = 300;
    int threads = 0;
  };

  struct Solution {
    Image image;                      // texels that nothing reads are 0
    std::vector<unsigned char> used;  // 1 for each texel that the surface reads
    int sweeps = 0;
  };

  /// Solves for all channels, within their ranges: projected Gauss-Seidel, by rows of alternating
  /// colour, so the result is the same for any number of threads. Where the problem is all but
  /// singular, as under charts that shrink to points, texels may stop some way from the minimum:
  /// moving them on would change the error by next to nothing. Can be called once.
  Solution solve(const SolveOptions& options, const Progress& progress);

 private:
  // Integrals of b_j^2, and of b_j times the basis functions east, north, north-east and north-west
  // of j.
  struct Stencil {
    float centre = 0.0F;
    float east = 0.0F;
    float north = 0.0F;
    float north_east = 0.0F;
    float north_west = 0.0F;
  };

  void add_dual_cell(const CellMoments<C>& moments, int column, int row);
  void add_pair(int x, int y, int dx, int dy, float value);
  std::ptrdiff_t at(int x, int y) const { return static_cast<std::ptrdiff_t>(y) * stride_ + x; }
  void pull_to_means();
  // The row below (step -1) or above (1), or the row of zeros where there is none.
  int row_beside(int y, int step) const;
  // One step of every texel of a row; true where a channel moved by more than the tolerance.
  bool relax_row(int y, const SolveOptions& options, Lanes typical);
  // A typical value of each channel: the median over rows of the mean magnitude of the texels in
  // use.
  Lanes typical_values() const;

  int width_;
  int height_;
  WrapModes wrap_;
  // Rows are one texel longer than the level, and there is one more of them: entries of zero, which
  // are what texels at the edge of a clamped or bordered level have as neighbours.
  int stride_;
  std::vector<Stencil> stencils_;
  std::vector<LaneValues> right_side_;
  std::vector<float> weights_;  // integrals of b_j
  std::vector<float> inverse_;  // of the diagonal; 0 where a texel is not read
  std::vector<LaneValues> texels_;
};

}  // namespace prefilter
