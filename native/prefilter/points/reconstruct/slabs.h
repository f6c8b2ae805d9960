// SPDX-License-Identifier: GPL-3.0-or-later

// What is made of a cloud's slabs, stage by stage, and forgotten where memory is scarce.
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

/// Each needs those before it; some need a neighboring slab's, too.
enum class SlabStage : std::uint8_t {
  kNone,
  kLevels,        // the samples at all depths
  kMet,           // which cells the surface meets
  kLeaves,        // where samples count, and for how much
  kCoefficients,  // the slab's part of the tree
  kValues,
  kSolved,
};

/// The slabs of a cloud, from below. What has been made of one is kept until it is dropped, and
/// made again, the same, when it is asked for again.
class Slabs {
 public:
  /// `keeps_all`: nothing is dropped before the last time that it is needed.
  Slabs(SampleStore* store, int depth, int top, std::size_t attribute_count, bool keeps_all,
        int threads);

  int count() const { return static_cast<int>(slots_.size()); }
  int depth() const { return depth_; }
  /// The depth of cells that are as high as a slab.
  int top() const { return top_; }
  int height() const { return 1 << (depth_ - top_); }

  /// Brings slabs from `begin` up to `end`, as far as there are such, to a stage.
  void bring(int begin, int end, SlabStage stage);
  /// Forgets slabs below one, where not all are kept, or `for_good`.
  void drop_below(int end, bool for_good);

  /// How many times a slab was brought to its next stage.
  std::size_t steps() const { return steps_; }

  /// Null where there is no such slab.
  const SampleSlab* samples(int s) const;
  const FluxTree* tree(int s) const;
  /// Values that were made otherwise, as kValues.
  void set_values(int s, FluxTree tree);

  /// The weight of outliers in a slab.
  double left_out(int s) const { return slots_[static_cast<std::size_t>(s)].left_out; }

  /// What counts at depths whose cells are as high as a slab, or half, may be of slabs that are not
  /// at hand: it is little, and kept of each slab since it had its leaves.
  bool is_sparse(int k) const { return k >= top_ && k <= std::min(top_ + 1, depth_); }
  const std::vector<SupportCell>& sparse(int s, int k) const {
    return sparse_[static_cast<std::size_t>(s)][static_cast<std::size_t>(k - top_)];
  }

  /// For kLeaves: the levels down to `top` of all slabs together, and where a slab's cells begin
  /// in the last of them. For kValues: the levels
  /// above.
  SampleSlab whole;
  std::vector<std::size_t> offsets;
  double mean_weight = 1.0;
  int least_leaf = 0;
  CoarseTree coarse;
  /// For kSolved: the value wanted at samples; 0: nothing is solved for.
  float middle = 0.0F;
  /// Of the wavelets' function, where it is solved for: over the box around the points.
  double unsolved_mean = 0.0;
  /// Of the root's volume: that of the box around the points.
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
  void synthesise_slab(int s);
  void solve(int s);
  void drop_used(int s, SlabStage stage);

  SampleStore* store_;
  int depth_;
  int top_;
  std::size_t attribute_count_;
  bool keeps_all_;
  int threads_;
  int dropped_ = 0;  // slabs below this have nothing
  std::atomic<std::size_t> steps_ = 0;
  std::vector<Slot> slots_;
  std::vector<std::array<std::vector<SupportCell>, 2>> sparse_;
};

}  // namespace prefilter
