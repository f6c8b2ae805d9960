// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell shows where some of the layers that pass it are, and others are not.
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

/// Layers over each other, without what is behind them: their color, and what passes through.
struct Veil {
  ChannelValues color{};
  double passing = 1.0;

  /// Puts a color behind them.
  void put_behind(const ChannelValues& value, double opaque, int channels) {
    for (int c = 0; c < channels; ++c) color[c] += passing * value[c];
    passing *= 1.0 - opaque;
  }
};

/// A stack whose colors are all constant has one color for each set of layers; any other has a
/// color at each point.
class CellColors {
 public:
  /// A layer of a cell that may be seen.
  struct SeenLayer {
    /// For a layer that fills the cell.
    static constexpr std::uint32_t kFull = UINT32_MAX;

    std::uint32_t layer = 0;
    std::uint32_t place = kFull;  // among the layers of the cell
  };

  CellColors(const LayerStack& stack, const CellFilter& filter, const ChannelValues& background,
             int channels);

  bool is_constant() const { return stack_.is_constant; }
  /// Whether no color changes by much over a pixel, jumps at stops left out.
  bool is_gentle() const { return is_gentle_; }
  int channels() const { return channels_; }
  const ChannelValues& background() const { return background_; }

  /// For a cell with these layers, from the highest, over and between those that are `full`. They
  /// must not change until the next cell.
  void begin_cell(int column, int row, std::span<const CellLayer> layers, const LayerSet& full);
  /// To another cell with the same layers.
  void move_to(int column, int row) {
    center_ = {filter_.to_pixel(column + 0.5), filter_.to_pixel(row + 0.5)};
  }
  /// Looks at so many layers of the cell, from the highest, and returns how many of them are seen
  /// where they are.
  std::size_t look_at(std::size_t count);
  double opacity(const ChannelValues& value) const {
    return channels_ == kMaxChannels ? value[kMaxChannels - 1] : 1.0;
  }

  /// Of constant colors: what is full over layer i of those that are seen and below the one before
  /// it; behind all of them for the last one of these.
  const Veil& over(std::size_t i) const { return full_[i]; }
  /// Of constant colors: the color of layer i.
  const ChannelValues& color(std::size_t i) const { return colors_[i]; }
  /// Of constant colors: writes to `out` what shows less the background where bit i of `present`
  /// tells whether layer i is there, of up to 64.
  void compose(std::uint64_t present, ChannelValues* out) const;

  /// Of other colors: all layers that were looked at, from the highest.
  std::span<const SeenLayer> seen_layers() const { return seen_layers_; }
  /// A point of a cell, from its center in cells, and the parallelogram around it over which the
  /// mean counts where stops are fine; without sides it is the value at the point.
  struct Spot {
    Point2 point;
    Point2 side;
    Point2 other_side;
  };
  /// Whether a layer that was looked at has fine stops, so that spots must be given.
  bool has_fine_stops() const;
  /// The value of a layer at a spot.
  ChannelValues color_at(std::uint32_t layer, const Spot& spot) const;
  /// Whether anything shows where these layers are present.
  bool is_anything_where(std::uint64_t present) const;
  /// Whether what shows where these layers are present is the same all over the cell.
  bool is_constant_where(std::uint64_t present) const;
  /// As compose(), at a spot.
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
  std::vector<Veil> veils_;  // the layers, where all are constant
  // Else what each lets pass at most, and faster ways to its values.
  bool is_gentle_ = true;
  std::vector<double> most_passing_;
  std::vector<std::optional<RoundGradient>> round_;
  std::vector<std::optional<GradientMeans>> fine_;  // by layers, or none at all
  Point2 center_;
  std::span<const CellLayer> layers_;
  const LayerSet* all_full_ = nullptr;
  std::uint32_t looked_below_ = 0;
  std::size_t looked_ = 0;  // how often at what is full
  std::size_t seen_ = 0;
  bool is_at_end_ = false;
  std::vector<Veil> full_;
  std::vector<ChannelValues> colors_;
  std::vector<SeenLayer> seen_layers_;
  double passing_ = 1.0;  // at most, through seen_layers_ that are full
};

}  // namespace prefilter
