// SPDX-License-Identifier: GPL-3.0-or-later

// What a cell shows where some of the layers that pass it are, and others are not.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prefilter/raster/local_color.h"
#include "prefilter/raster/row_layers.h"

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

/// Colors are told at the nodes of a cell: one, or those by which a polynomial of degree 2 is told.
class CellColors {
 public:
  CellColors(const LayerStack& stack, const CellFilter& filter, const ChannelValues& background,
             int channels);

  std::size_t nodes() const { return stack_.is_constant ? 1 : kColorNodes; }
  int channels() const { return channels_; }
  const ChannelValues& background() const { return background_; }

  /// For a cell with these layers, from the highest, over and between those that are `full`. They
  /// must not change until the next cell.
  void begin_cell(int column, int row, std::span<const CellLayer> layers, const LayerSet& full);
  /// Looks at so many layers of the cell, from the highest, and returns how many of them are seen
  /// where they are.
  std::size_t look_at(std::size_t count);
  /// What is full over layer i of those that are seen and below the one before it, at the nodes;
  /// behind all of them for the last one of these.
  std::span<const Veil> over(std::size_t i) const {
    return std::span(full_).subspan(i * nodes(), nodes());
  }
  /// The color of layer i at the nodes.
  std::span<const ChannelValues> color(std::size_t i) const {
    return std::span(colors_).subspan(i * nodes(), nodes());
  }
  double opacity(const ChannelValues& value) const {
    return channels_ == kMaxChannels ? value[kMaxChannels - 1] : 1.0;
  }
  /// Writes to `out`, a value a node, what shows less the background where bit i of `present` tells
  /// whether layer i is there, of up to 64.
  void compose(std::uint64_t present, ChannelValues* out) const;
  /// The color between the nodes.
  void powers(std::span<const ChannelValues> at_nodes,
              std::array<ColorPowers, kMaxChannels>* out) const;

 private:
  void append_color(const Paint& paint, std::vector<ChannelValues>* colors) const;
  bool append_full(std::uint32_t end, std::uint32_t behind, const LayerSet& full);
  bool append_constant_full(std::uint32_t end, std::uint32_t behind, const LayerSet& full);

  const LayerStack& stack_;
  const CellFilter& filter_;
  ChannelValues background_;
  int channels_;
  std::vector<Veil> veils_;  // the layers, where all are constant
  Point2 center_;
  std::span<const CellLayer> layers_;
  const LayerSet* all_full_ = nullptr;
  std::uint32_t looked_below_ = 0;
  std::size_t seen_ = 0;
  bool is_at_end_ = false;
  std::vector<Veil> full_;
  std::vector<ChannelValues> colors_;
  std::vector<ChannelValues> behind_;
};

}  // namespace prefilter
