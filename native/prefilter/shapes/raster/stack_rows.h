// SPDX-License-Identifier: GPL-3.0-or-later

// The values of pixels under a stack of layers, cell by cell.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "prefilter/geometry/moments/arc_moments.h"
#include "prefilter/shapes/raster/band_values.h"
#include "prefilter/shapes/raster/cell_areas.h"
#include "prefilter/shapes/raster/cell_colors.h"
#include "prefilter/shapes/raster/cell_pixels.h"
#include "prefilter/shapes/raster/cell_quadrature.h"
#include "prefilter/shapes/raster/cell_samples.h"
#include "prefilter/shapes/raster/cell_sweep.h"
#include "prefilter/shapes/raster/composited_rows.h"
#include "prefilter/shapes/raster/layer_stack.h"
#include "prefilter/shapes/raster/paint_means.h"
#include "prefilter/shapes/raster/row_layers.h"
#include "prefilter/shapes/raster/stack_arcs.h"

namespace prefilter {

/// What there is to do in a cell, in steps of a sweep, and what it took.
struct StackWork {
  std::size_t swept_cells = 0;
  std::size_t swept_steps = 0;
  std::size_t sampled_cells = 0;
};

/// N is the filter's degree.
///
/// Cells are swept, which is exact, as far as their number of arcs lets a row of an image be made
/// within a number of steps; those with more arcs are sampled. Which they are depends on the row
/// alone.
template <int N>
class StackRows {
 public:
  /// For an image: some tenths of a second of a processor.
  static constexpr std::size_t kSweepSteps = std::size_t{1} << 24;

  /// All must outlive it. An image takes about so many steps of a sweep.
  StackRows(const LayerStack& stack, const CellFilter& filter, const ChannelValues& background,
            int channels, int width, int height, std::size_t sweep_steps = kSweepSteps);

  /// Adds to `values`, those of the pixel rows [first_row, end_row), what the stack shows less the
  /// background.
  void add_values(int first_row, int end_row, BandValues* values);
  /// The same of the box filter, for the pixels that are marked alone.
  void add_marked(int first_row, int end_row, const CompositedRows& marks, BandValues* values);
  const StackWork& work() const { return work_; }

 private:
  void add_row(int row);
  void add_wanted(int begin, int end, int row);
  void add_run(int begin, int end, int row);
  void add_varying_run(int begin, int end, int row);
  void add_means(const Paint& paint, int begin, int end, int row);
  void add_cell(int column, int row);
  void add_swept(int column, int row);
  void add_sampled(int column, int row);
  void integrate(const SweptPart& part, int column, int row, std::int32_t place);
  void add_place(const ArcMoments<N>& moments, const ChannelValues& step);
  void plan_row();

  const LayerStack& stack_;
  const CellFilter& filter_;
  int channels_;
  int width_;
  bool has_parabolas_ = false;  // by which arcs of curves are told
  std::size_t sweep_steps_;     // for a row
  std::size_t most_arcs_ = 0;
  StackArcs arcs_;
  OpenColumns wanted_;
  RowLayers layers_;
  CellColors colors_;
  CellSweep sweep_;
  CellAreas areas_;
  CellQuadrature quadrature_;
  std::unique_ptr<CellSamples> samples_;  // where a cell is sampled
  std::unique_ptr<PaintMeans> means_;
  const Paint* means_of_ = nullptr;
  std::vector<double> run_;  // of means
  CellPixels pixels_;
  StackWork work_;
  KeyNumbers places_;
  std::vector<ArcMoments<N>> moments_;
  ArcBatch<N> batch_;
  std::vector<ChannelValues> state_colors_;
  std::array<std::vector<double>, kMaxChannels> sums_;  // of x^a y^b
};

extern template class StackRows<0>;
extern template class StackRows<1>;
extern template class StackRows<2>;
extern template class StackRows<3>;
extern template class StackRows<7>;

}  // namespace prefilter
