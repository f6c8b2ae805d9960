// SPDX-License-Identifier: GPL-3.0-or-later

// Front-to-back compositing of premultiplied colors (Porter and Duff's "over"), with early
// termination.
#include "prefilter/shapes/raster/cell_colors.h"

#include <algorithm>

#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {
namespace {

// Layers behind this transmittance do not change a float.
constexpr double kMinTransmittance = RowLayers::kMinTransmittance;

}  // namespace

CellColors::CellColors(const LayerStack& stack, const CellFilter& filter,
                       const ChannelValues& background, int channels)
    : stack_(stack),
      filter_(filter),
      background_(background),
      channels_(channels),
      pixels_per_cell_(1.0 / filter.cells_per_pixel) {
  for (const StackLayer& layer : stack.layers) {
    if (stack.is_constant) {
      const ChannelValues& color = layer.paint->constant;
      layer_colors_.push_back({color, 1.0 - opacity(color)});
    } else {
      constexpr double kGentleVariation = 1.0 / 8.0;
      is_gentle_ = is_gentle_ && variation_per_pixel(*layer.paint).value < kGentleVariation;
      max_transmittance_.push_back(prefilter::max_transmittance(*layer.paint, channels));
      round_.push_back(RoundGradient::of(*layer.paint, 1.0));
    }
  }
  for (std::size_t i = 0; i < stack.layers.size(); ++i) {
    const StackLayer& layer = stack.layers[i];
    if (layer.is_cutter || !prefilter::has_fine_stops(*layer.paint)) continue;
    fine_.resize(stack.layers.size());
    fine_[i].emplace(*layer.paint);
  }
}

bool CellColors::append_constant_full(std::uint32_t end, std::uint32_t behind,
                                      const LayerSet& full) {
  LayerAccumulator sum;
  full.each_between(end, behind, [&](std::uint32_t layer) {
    const LayerAccumulator& accumulated = layer_colors_[layer];
    // Uses all four channels; values beyond the image's channels are not read.
    for (int c = 0; c < kMaxChannels; ++c) sum.color[c] += sum.transmittance * accumulated.color[c];
    sum.transmittance *= accumulated.transmittance;
    return sum.transmittance >= kMinTransmittance;
  });
  full_.push_back(sum);
  return sum.transmittance >= kMinTransmittance;
}

// Composites the full layers below `end` and above `behind`. Returns whether the transmittance
// still matters.
bool CellColors::append_full(std::uint32_t end, std::uint32_t behind, const LayerSet& full) {
  ++examined_;
  if (stack_.is_constant) return append_constant_full(end, behind, full);
  full.each_between(end, behind, [&](std::uint32_t layer) {
    seen_layers_.push_back({layer, SeenLayer::kFull});
    transmittance_ *= max_transmittance_[layer];
    return transmittance_ >= kMinTransmittance;
  });
  return transmittance_ >= kMinTransmittance;
}

void CellColors::append_layer(std::uint32_t layer) {
  if (stack_.is_constant) {
    colors_.push_back(layer_colors_[layer].color);
  } else if (!stack_.layers[layer].is_cutter) {
    seen_layers_.push_back({layer, static_cast<std::uint32_t>(seen_)});
  }
  ++seen_;
}

void CellColors::begin_cell(int column, int row, std::span<const CellLayer> layers,
                            const LayerSet& full) {
  move_to(column, row);
  full_.clear();
  colors_.clear();
  seen_layers_.clear();
  transmittance_ = 1.0;
  layers_ = layers;
  all_full_ = &full;
  examined_below_ = static_cast<std::uint32_t>(stack_.layers.size());
  examined_ = 0;
  seen_ = 0;
  is_at_end_ = false;
  examine(0);
}

std::size_t CellColors::examine(std::size_t count) {
  while (!is_at_end_) {
    if (examined_ > count) break;
    if (examined_ > 0) append_layer(layers_[seen_].layer);
    const bool is_last = seen_ == layers_.size();
    const std::uint32_t behind = is_last ? LayerSet::kNone : layers_[seen_].layer;
    is_at_end_ = !append_full(examined_below_, behind, *all_full_) || is_last;
    examined_below_ = behind;
  }
  return std::min(count, seen_);
}

void CellColors::compose(std::uint64_t present, ChannelValues* out) const {
  LayerAccumulator accumulated;
  for (std::size_t layer = 0; layer <= seen_; ++layer) {
    const LayerAccumulator& next = full_[layer];
    accumulated.put_behind(next.color, 1.0 - next.transmittance, channels_);
    if (layer < seen_ && (present >> layer & 1) != 0) {
      const ChannelValues& color = colors_[layer];
      accumulated.put_behind(color, opacity(color), channels_);
    }
  }
  *out = accumulated.color;
  for (int c = 0; c < channels_; ++c)
    (*out)[c] -= (1.0 - accumulated.transmittance) * background_[c];
}

bool CellColors::has_fine_stops() const {
  return !fine_.empty() &&
         std::any_of(seen_layers_.begin(), seen_layers_.end(),
                     [&](const SeenLayer& seen) { return fine_[seen.layer].has_value(); });
}

ChannelValues CellColors::color_at(std::uint32_t layer, const Spot& spot) const {
  const Paint& paint = *stack_.layers[layer].paint;
  if (paint.kind == Paint::Kind::kConstant) return paint.constant;
  const Point2 place = center_ + pixels_per_cell_ * spot.point;
  if (!fine_.empty() && fine_[layer] && !(spot.side == Point2{})) {
    return fine_[layer]->mean_over(place, pixels_per_cell_ * spot.side,
                                   pixels_per_cell_ * spot.other_side);
  }
  return round_[layer] ? round_[layer]->at(place) : paint.at(place);
}

bool CellColors::is_visible_where(std::uint64_t present) const {
  return std::any_of(seen_layers_.begin(), seen_layers_.end(), [&](const SeenLayer& seen) {
    return seen.place == SeenLayer::kFull || (present >> seen.place & 1) != 0;
  });
}

bool CellColors::is_constant_where(std::uint64_t present) const {
  for (const SeenLayer& seen : seen_layers_) {
    if (seen.place != SeenLayer::kFull && (present >> seen.place & 1) == 0) continue;
    if (stack_.layers[seen.layer].paint->kind != Paint::Kind::kConstant) return false;
    if (max_transmittance_[seen.layer] < kMinTransmittance) return true;
  }
  return true;
}

ChannelValues CellColors::compose_at(std::uint64_t present, const Spot& spot) const {
  LayerAccumulator accumulated;
  for (const SeenLayer& seen : seen_layers_) {
    if (seen.place != SeenLayer::kFull && (present >> seen.place & 1) == 0) continue;
    const ChannelValues color = color_at(seen.layer, spot);
    accumulated.put_behind(color, opacity(color), channels_);
    if (accumulated.transmittance < kMinTransmittance) break;
  }
  for (int c = 0; c < channels_; ++c)
    accumulated.color[c] -= (1.0 - accumulated.transmittance) * background_[c];
  return accumulated.color;
}

}  // namespace prefilter
