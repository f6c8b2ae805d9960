// SPDX-License-Identifier: GPL-3.0-or-later

// Processes a cloud's slabs stage by stage, and drops them where memory is scarce.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prefilter/points/reconstruct/assemble.h"
#include "prefilter/points/reconstruct/flux_tree.h"
#include "prefilter/points/reconstruct/leaf_band.h"
#include "prefilter/points/reconstruct/sample_slab.h"
#include "prefilter/points/reconstruct/sample_store.h"
#include "prefilter/points/reconstruct/support_field.h"

namespace prefilter {

/// Each stage requires the previous ones; some require those of the adjacent slabs too.
enum class SlabStage : std::uint8_t {
  kNone,
  kLevels,        // the samples at all depths
  kCrossedCells,  // the cells that the surface crosses
  kLeaves,        // leaves and areas of samples
  kCoefficients,  // the slab's part of the tree
  kValues,
  kSolved,
};

/// The slabs of a cloud, from bottom to top. A slab's data is kept until dropped, and recomputed
/// with identical results on demand.
class Slabs {
 public:
  /// With `keeps_all`, slabs are only dropped after their last use.
  Slabs(SampleStore* store, int depth, int top, std::size_t attribute_count, bool keeps_all,
        int threads);

  int count() const { return static_cast<int>(slots_.size()); }
  int depth() const { return depth_; }
  /// The depth at which cells are as high as a slab.
  int top() const { return top_; }
  int height() const { return 1 << (depth_ - top_); }

  /// Advances slabs from `begin` up to `end`, clamped to those that exist, to a stage.
  void advance_to(int begin, int end, SlabStage stage);
  /// Drops the slabs below `end`, unless all are kept; with `for_good`, even then.
  void drop_below(int end, bool for_good);

  /// Number of times that a slab was advanced by one stage.
  std::size_t steps() const { return steps_; }

  /// Null for slabs that do not exist.
  const SampleSlab* samples(int s) const;
  const FluxTree* tree(int s) const;
  /// Sets values computed elsewhere, and advances the slab to kValues.
  void set_values(int s, FluxTree tree);

  /// The weight of outliers in a slab.
  double left_out(int s) const { return slots_[static_cast<std::size_t>(s)].left_out; }

  /// Leaves of about a slab's height may be needed from slabs that are no longer in memory. They
  /// are few, so each slab's are stored from stage kLeaves on.
  bool is_sparse(int k) const { return k >= top_ && k <= std::min(top_ + 1, depth_); }
  const std::vector<SupportCell>& sparse(int s, int k) const {
    return sparse_[static_cast<std::size_t>(s)][static_cast<std::size_t>(k - top_)];
  }

  /// Input of kLeaves: the levels of all slabs together down to `top`, and the offset of each
  /// slab's cells in the last of them. Input of kValues: the coarse tree.
  SampleSlab whole;
  std::vector<std::size_t> offsets;
  double mean_weight = 1.0;
  int least_leaf = 0;
  CoarseTree coarse;
  /// Input of kSolved: the value wanted at samples; 0: no solve.
  float target = 0.0F;
  /// Mean of the wavelets' function over the box around the points, before the solve.
  double unsolved_mean = 0.0;
  /// Volume of the box around the points, as a share of the root's.
  double box_share = 1.0;

 private:
  struct Slot {
    SlabStage stage = SlabStage::kNone;
    SampleSlab samples;
    FluxTree tree;
    double left_out = 0.0;
    SplitCells splits;
  };

  void advance(int s, SlabStage stage);
  void find_leaves_of(int s);
  void analyze(int s);
  void synthesize_slab(int s);
  void solve(int s);
  void drop_used(int s, SlabStage stage);

  SampleStore* store_;
  int depth_;
  int top_;
  std::size_t attribute_count_;
  bool keeps_all_;
  int threads_;
  int dropped_ = 0;  // slabs below this are dropped
  std::atomic<std::size_t> steps_ = 0;
  std::vector<Slot> slots_;
  std::vector<std::array<std::vector<SupportCell>, 2>> sparse_;
};

}  // namespace prefilter
