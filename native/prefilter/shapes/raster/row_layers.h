// SPDX-License-Identifier: GPL-3.0-or-later

// The layers of which outlines pass the cells of a row, and what each winds around along their left
// sides.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/layer_set.h"
#include "prefilter/shapes/raster/open_columns.h"
#include "prefilter/shapes/raster/stack_arcs.h"

namespace prefilter {

/// From a height on, the winding number at the left side of a cell is higher by this.
struct SideStep {
  double y = 0.0;  // from the cell's center
  std::int32_t winding = 0;

  bool operator==(const SideStep&) const = default;
};

/// A layer in a cell.
struct CellLayer {
  std::uint32_t layer = 0;
  FillRule fill_rule = FillRule::kNonzero;
  std::int32_t base = 0;  // its winding number at the lower left corner
  std::span<const SideStep> steps;
  std::span<const StackArc> arcs;
};

/// Goes along a row of cells from the left, after all layers went along it from the highest: where
/// those that fill cells let nothing pass, what lies behind is left out.
class RowLayers {
 public:
  /// Of layers that let less pass in all nothing is seen in a float.
  static constexpr double kLeastPassing = 1e-7;
  /// With more arcs a cell is sampled: moments hold 31 regions to the right of some, one over
  /// another.
  static constexpr std::size_t kMostSweptArcs = 60;

  RowLayers(const LayerStack& stack, int channels);

  /// Of the columns that are wanted; what is in others is left out.
  void make_row(int row, const OpenColumns& wanted, StackArcs* arcs);
  /// How many layers are in a cell, and how many arcs. Columns are from the window's first.
  std::size_t layer_count(int column) const {
    return first_record_[column + 1] - first_record_[column];
  }
  std::size_t arc_count(int column) const;

  /// Comes to a column, right of those before.
  void enter(int column);
  /// Those of the cell, from the highest.
  std::span<const CellLayer> layers() const { return layers_; }
  /// Layers that fill all of the cell. Not with them are the layers of the cell.
  const LayerSet& full() const { return full_; }
  /// The next column where there is something else, or the one behind the last.
  int next_change(int column) const;

 private:
  // A layer in a cell, its steps and arcs by number.
  struct Record {
    std::uint32_t layer = 0;
    FillRule fill_rule = FillRule::kNonzero;
    std::int32_t column = 0;
    std::int32_t base = 0;
    std::uint32_t first_step = 0;
    std::uint32_t end_step = 0;
    std::uint32_t first_arc = 0;
    std::uint32_t end_arc = 0;
  };
  // A layer fills cells from here on, or up to here.
  struct Change {
    std::int32_t column = 0;
    std::uint32_t layer = 0;
    bool fills = false;
  };

  void add_layer(std::uint32_t layer, std::size_t first_arc);
  void add_gap(std::uint32_t layer, int begin, int end);
  void add_cell(std::uint32_t layer, int column, std::size_t first_arc, std::size_t end_arc);
  void add_full(std::uint32_t layer, int begin, int end);
  void close_hidden();
  void leave(std::span<const StackArc> arcs);
  bool is_filled_all_over(std::span<const StackArc> arcs, FillRule rule) const;
  void sort_records();

  std::vector<double> depths_;  // of each layer: what passes is e to less than the power of this
  std::vector<FillRule> rules_;
  std::vector<bool> are_cutters_;
  int columns_ = 0;
  OpenColumns open_;
  std::vector<double> depth_steps_;  // of the layers so far, from column to column
  int layers_until_closing_ = 0;
  std::vector<std::uint32_t> arc_counts_;  // of the layers so far, of each column
  std::vector<StackArc> arcs_;
  std::vector<SideStep> steps_;
  std::vector<Record> records_;
  std::vector<Record> sorted_records_;
  std::vector<std::uint32_t> first_record_;
  std::vector<Change> changes_;
  std::vector<Change> sorted_changes_;
  std::vector<std::uint32_t> first_change_;

  // Of the layer in hand.
  std::int32_t base_ = 0;
  std::vector<SideStep> own_steps_;
  std::vector<SideStep> next_steps_;
  std::int32_t full_end_ = -1;  // of its last cells that are full

  LayerSet full_;
  std::vector<CellLayer> layers_;
};

}  // namespace prefilter
