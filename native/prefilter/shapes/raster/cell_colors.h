// SPDX-License-Identifier: GPL-3.0-or-later

// Composited color of a cell for any set of layers that are present at a point.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prefilter/shapes/raster/cell_filter.h"
#include "prefilter/shapes/raster/gradient_means.h"
#include "prefilter/shapes/raster/round_gradient.h"
#include "prefilter/shapes/raster/row_layers.h"

namespace prefilter {

/// Layers composited front to back: their premultiplied color and their transmittance.
struct LayerAccumulator {
  ChannelValues color{};
  double transmittance = 1.0;

  /// Composites a color behind the layers so far.
  void put_behind(const ChannelValues& value, double opaque, int channels) {
    for (int c = 0; c < channels; ++c) color[c] += transmittance * value[c];
    transmittance *= 1.0 - opaque;
  }
};

/// If all colors of a stack are constant, each set of layers has one color; otherwise the color
/// varies by point.
class CellColors {
 public:
  /// A layer of a cell that may be visible.
  struct SeenLayer {
    /// The index of a layer that fills the cell.
    static constexpr std::uint32_t kFull = UINT32_MAX;

    std::uint32_t layer = 0;
    std::uint32_t place = kFull;  // index among the layers of the cell
  };

  CellColors(const LayerStack& stack, const CellFilter& filter, const ChannelValues& background,
             int channels);

  bool is_constant() const { return stack_.is_constant; }
  /// Whether no color changes much over a pixel, ignoring jumps at stops.
  bool is_gentle() const { return is_gentle_; }
  int channels() const { return channels_; }
  const ChannelValues& background() const { return background_; }

  /// Starts a cell with these layers, from the highest, and the layers in `full` that fill it. Both
  /// must not change until the next cell.
  void begin_cell(int column, int row, std::span<const CellLayer> layers, const LayerSet& full);
  /// Moves to another cell with the same layers.
  void move_to(int column, int row) {
    center_ = {filter_.to_pixel(column + 0.5), filter_.to_pixel(row + 0.5)};
  }
  /// Examines the highest `count` layers of the cell, and returns how many of them can be visible.
  std::size_t examine(std::size_t count);
  double opacity(const ChannelValues& value) const {
    return channels_ == kMaxChannels ? value[kMaxChannels - 1] : 1.0;
  }

  /// For constant colors: the full layers above visible layer i and below the one before it; for
  /// the index after the last, those behind all of them.
  const LayerAccumulator& over(std::size_t i) const { return full_[i]; }
  /// For constant colors: the color of visible layer i.
  const ChannelValues& color(std::size_t i) const { return colors_[i]; }
  /// For constant colors: writes the color minus the background where layer i is present if bit i
  /// of `present` is set, for up to 64 layers.
  void compose(std::uint64_t present, ChannelValues* out) const;

  /// For varying colors: all examined layers, from the highest.
  std::span<const SeenLayer> seen_layers() const { return seen_layers_; }
  /// A point, relative to the cell's center in cells, and the parallelogram around it over which
  /// fine stops are averaged. Without sides, the value is the value at the point.
  struct Spot {
    Point2 point;
    Point2 side;
    Point2 other_side;
  };
  /// Whether an examined layer has fine stops, so that parallelograms must be given.
  bool has_fine_stops() const;
  /// Value of a layer at a spot.
  ChannelValues color_at(std::uint32_t layer, const Spot& spot) const;
  /// Whether any layer is visible where these layers are present.
  bool is_visible_where(std::uint64_t present) const;
  /// Whether the composited color is constant over the cell where these layers are present.
  bool is_constant_where(std::uint64_t present) const;
  /// The color at a spot, minus the background; see compose().
  ChannelValues compose_at(std::uint64_t present, const Spot& spot) const;

 private:
  bool append_full(std::uint32_t end, std::uint32_t behind, const LayerSet& full);
  bool append_constant_full(std::uint32_t end, std::uint32_t behind, const LayerSet& full);
  void append_layer(std::uint32_t layer);

  const LayerStack& stack_;
  const CellFilter& filter_;
  ChannelValues background_;
  int channels_;
  double pixels_per_cell_;
  std::vector<LayerAccumulator> layer_colors_;  // the layers, if all are constant
  // For varying colors: upper bounds of the layers' transmittance, and fast evaluation of
  // gradients.
  bool is_gentle_ = true;
  std::vector<double> max_transmittance_;
  std::vector<std::optional<RoundGradient>> round_;
  std::vector<std::optional<GradientMeans>> fine_;  // by layer; empty if none is fine
  Point2 center_;
  std::span<const CellLayer> layers_;
  const LayerSet* all_full_ = nullptr;
  std::uint32_t examined_below_ = 0;
  std::size_t examined_ = 0;  // how often full layers were examined
  std::size_t seen_ = 0;
  bool is_at_end_ = false;
  std::vector<LayerAccumulator> full_;
  std::vector<ChannelValues> colors_;
  std::vector<SeenLayer> seen_layers_;
  double transmittance_ = 1.0;  // upper bound of the transmittance of the full layers examined
};

}  // namespace prefilter
