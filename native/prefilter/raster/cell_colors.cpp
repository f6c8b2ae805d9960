// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/raster/cell_colors.h"

#include <algorithm>

namespace prefilter {
namespace {

// What is behind so much does not show in a float.
constexpr double kLeastPassing = RowLayers::kLeastPassing;

}  // namespace

CellColors::CellColors(const LayerStack& stack, const CellFilter& filter,
                       const ChannelValues& background, int channels)
    : stack_(stack), filter_(filter), background_(background), channels_(channels) {
  if (!stack.is_constant) return;
  for (const StackLayer& layer : stack.layers) {
    const ChannelValues& color = layer.paint->constant;
    veils_.push_back({color, 1.0 - opacity(color)});
  }
}

void CellColors::append_color(const Paint& paint, std::vector<ChannelValues>* colors) const {
  const double scale = 1.0 / filter_.cells_per_pixel;
  for (std::size_t i = 0; i < kColorNodes; ++i) {
    colors->push_back(paint.kind == Paint::Kind::kConstant
                          ? paint.constant
                          : paint.at(center_ + scale * color_node(i)));
  }
}

bool CellColors::append_constant_full(std::uint32_t end, std::uint32_t behind,
                                      const LayerSet& full) {
  Veil sum;
  full.each_between(end, behind, [&](std::uint32_t layer) {
    const Veil& veil = veils_[layer];
    // All four, of which those beyond the channels are not looked at.
    for (int c = 0; c < kMaxChannels; ++c) sum.color[c] += sum.passing * veil.color[c];
    sum.passing *= veil.passing;
    return sum.passing >= kLeastPassing;
  });
  full_.push_back(sum);
  return sum.passing >= kLeastPassing;
}

// What is full below `end`, and over `behind`. Returns whether something passes.
bool CellColors::append_full(std::uint32_t end, std::uint32_t behind, const LayerSet& full) {
  if (stack_.is_constant) return append_constant_full(end, behind, full);
  const std::size_t first = full_.size();
  full_.resize(first + nodes());
  double most_passing = 1.0;
  for (std::uint32_t layer = full.highest_below(end);
       layer != LayerSet::kNone && (behind == LayerSet::kNone || layer > behind);
       layer = full.highest_below(layer)) {
    behind_.clear();
    append_color(*stack_.layers[layer].paint, &behind_);
    most_passing = 0.0;
    for (std::size_t i = 0; i < nodes(); ++i) {
      Veil& veil = full_[first + i];
      veil.put_behind(behind_[i], opacity(behind_[i]), channels_);
      most_passing = std::max(most_passing, veil.passing);
    }
    if (most_passing < kLeastPassing) return false;
  }
  return true;
}

void CellColors::begin_cell(int column, int row, std::span<const CellLayer> layers,
                            const LayerSet& full) {
  center_ = {filter_.to_pixel(column + 0.5), filter_.to_pixel(row + 0.5)};
  full_.clear();
  colors_.clear();
  layers_ = layers;
  all_full_ = &full;
  looked_below_ = static_cast<std::uint32_t>(stack_.layers.size());
  seen_ = 0;
  is_at_end_ = false;
  look_at(0);
}

std::size_t CellColors::look_at(std::size_t count) {
  while (!is_at_end_) {
    const std::size_t next = full_.size() / nodes();
    if (next > count) break;
    if (next > 0) {
      const std::uint32_t layer = layers_[seen_].layer;
      if (stack_.is_constant) {
        colors_.push_back(veils_[layer].color);
      } else {
        append_color(*stack_.layers[layer].paint, &colors_);
      }
      ++seen_;
    }
    const bool is_last = seen_ == layers_.size();
    const std::uint32_t behind = is_last ? LayerSet::kNone : layers_[seen_].layer;
    is_at_end_ = !append_full(looked_below_, behind, *all_full_) || is_last;
    looked_below_ = behind;
  }
  return std::min(count, seen_);
}

void CellColors::compose(std::uint64_t present, ChannelValues* out) const {
  for (std::size_t i = 0; i < nodes(); ++i) {
    Veil veil;
    for (std::size_t layer = 0; layer <= seen_; ++layer) {
      const Veil& next = full_[layer * nodes() + i];
      veil.put_behind(next.color, 1.0 - next.passing, channels_);
      if (layer < seen_ && (present >> layer & 1) != 0) {
        const ChannelValues& color = colors_[layer * nodes() + i];
        veil.put_behind(color, opacity(color), channels_);
      }
    }
    out[i] = veil.color;
    for (int c = 0; c < channels_; ++c) out[i][c] -= (1.0 - veil.passing) * background_[c];
  }
}

void CellColors::powers(std::span<const ChannelValues> at_nodes,
                        std::array<ColorPowers, kMaxChannels>* out) const {
  for (int c = 0; c < channels_; ++c) (*out)[c] = {};
  if (at_nodes.size() == 1) {
    for (int c = 0; c < channels_; ++c) (*out)[c][0] = at_nodes[0][c];
    return;
  }
  for (std::size_t i = 0; i < kColorNodes; ++i) {
    add_color_node(i, at_nodes[i], channels_, out);
  }
}

}  // namespace prefilter
