// SPDX-License-Identifier: GPL-3.0-or-later

// The layers in each cell of a row, with their winding numbers along the cell's left side.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/layer_set.h"
#include "prefilter/shapes/raster/open_columns.h"
#include "prefilter/shapes/raster/stack_arcs.h"

namespace prefilter {

/// Change of the winding number at a height along the left side of a cell.
struct SideStep {
  double y = 0.0;  // relative to the cell's center
  std::int32_t winding = 0;

  bool operator==(const SideStep&) const = default;
};

/// A layer in a cell.
struct CellLayer {
  std::uint32_t layer = 0;
  FillRule fill_rule = FillRule::kNonzero;
  std::int32_t base = 0;  // winding number at the lower left corner
  std::span<const SideStep> steps;
  std::span<const StackArc> arcs;
};

/// Visits a row of cells from the left, after a pass over all layers from the highest. Layers
/// behind opaque full layers are left out.
class RowLayers {
 public:
  /// Layers behind this transmittance do not change a float.
  static constexpr double kMinTransmittance = 1e-7;
  /// Cells with more arcs are sampled: moments hold at most 31 overlapping regions right of arcs.
  static constexpr std::size_t kMaxSweptArcs = 60;

  RowLayers(const LayerStack& stack, int channels);

  /// Processes the wanted columns; others are left out.
  void make_row(int row, const OpenColumns& requested, StackArcs* arcs);
  /// Number of layers and of arcs in a cell. Columns count from the window's first.
  std::size_t layer_count(int column) const {
    return first_record_[column + 1] - first_record_[column];
  }
  std::size_t arc_count(int column) const;

  /// Moves to a column to the right of the last.
  void enter(int column);
  /// The cell's layers with arcs or steps, from the highest.
  std::span<const CellLayer> layers() const { return layers_; }
  /// Layers that fill the whole cell; they are not in layers().
  const LayerSet& full() const { return full_; }
  /// The next column whose layers differ, or the column after the last.
  int next_change(int column) const;

 private:
  // A layer in a cell, with ranges of steps and arcs.
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
  // A layer begins or ceases to fill cells at a column.
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
  void update_windings(std::span<const StackArc> arcs);
  bool is_filled_all_over(std::span<const StackArc> arcs, FillRule rule) const;
  void sort_records();

  std::vector<double> log_transmittance_;  // log of the largest transmittance of each layer
  std::vector<FillRule> rules_;
  std::vector<bool> are_cutters_;
  int columns_ = 0;
  OpenColumns open_;
  std::vector<double> log_transmittance_steps_;  // changes between columns, over the layers so far
  int layers_until_test_ = 0;
  std::vector<std::uint32_t> arc_counts_;  // per column, over the layers so far
  std::vector<StackArc> arcs_;
  std::vector<SideStep> steps_;
  std::vector<Record> records_;
  std::vector<Record> sorted_records_;
  std::vector<std::uint32_t> first_record_;
  std::vector<Change> changes_;
  std::vector<Change> sorted_changes_;
  std::vector<std::uint32_t> first_change_;

  // For the current layer.
  std::int32_t base_ = 0;
  std::vector<SideStep> left_steps_;
  std::vector<SideStep> next_steps_;
  std::int32_t full_end_ = -1;  // end of its last full cells

  LayerSet full_;
  std::vector<CellLayer> layers_;
};

}  // namespace prefilter
