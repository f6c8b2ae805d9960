// SPDX-License-Identifier: GPL-3.0-or-later

// Pixel values of a stack of layers, cell by cell.
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

/// Statistics of the cells processed.
struct StackWork {
  std::size_t swept_cells = 0;
  std::size_t swept_steps = 0;
  std::size_t sampled_cells = 0;
};

/// N is the filter's degree.
///
/// Cells are swept, which is exact, as far as the steps for a row allow; cells with more arcs are
/// sampled. The choice depends only on the row.
template <int N>
class StackRows {
 public:
  /// Steps for an image: a few tenths of a second on one core.
  static constexpr std::size_t kSweepSteps = std::size_t{1} << 24;

  /// All arguments must outlive this object. `sweep_steps` limits the steps of sweeps in an image.
  StackRows(const LayerStack& stack, const CellFilter& filter, const ChannelValues& background,
            int channels, int width, int height, std::size_t sweep_steps = kSweepSteps);

  /// Adds the stack's color minus the background to `values`, the pixel rows [first_row, end_row).
  void add_values(int first_row, int end_row, BandValues* values);
  /// Does the same under the box filter, only for marked pixels.
  void add_marked(int first_row, int end_row, const CompositedRows& marks, BandValues* values);
  const StackWork& work() const { return work_; }

 private:
  void add_row(int row);
  void add_requested(int begin, int end, int row);
  void add_run(int begin, int end, int row);
  void add_varying_run(int begin, int end, int row);
  void add_means(const Paint& paint, int begin, int end, int row);
  void add_cell(int column, int row);
  void add_swept(int column, int row);
  void add_sampled(int column, int row);
  void integrate(const SweptPart& part, int column, int row, std::int32_t pair);
  void add_state_pair(const ArcMoments<N>& moments, const ChannelValues& step);
  void plan_row();

  const LayerStack& stack_;
  const CellFilter& filter_;
  int channels_;
  int width_;
  bool has_parabolas_ = false;  // whether curves are represented by parabolas
  std::size_t sweep_steps_;     // per row
  std::size_t max_arcs_ = 0;
  StackArcs arcs_;
  OpenColumns requested_;
  RowLayers layers_;
  CellColors colors_;
  CellSweep sweep_;
  CellAreas areas_;
  CellQuadrature quadrature_;
  std::unique_ptr<CellSamples> samples_;  // created for the first sampled cell
  std::unique_ptr<PaintMeans> means_;
  const Paint* means_of_ = nullptr;
  std::vector<double> run_;  // means of a run
  CellPixels pixels_;
  StackWork work_;
  KeyIndex state_pairs_;
  std::vector<ArcMoments<N>> moments_;
  ArcBatch<N> batch_;
  std::vector<ChannelValues> state_colors_;
  std::array<std::vector<double>, kMaxChannels> sums_;  // integrals times x^a y^b
};

extern template class StackRows<0>;
extern template class StackRows<1>;
extern template class StackRows<2>;
extern template class StackRows<3>;
extern template class StackRows<7>;

}  // namespace prefilter
