// SPDX-License-Identifier: GPL-3.0-or-later

// Layers are processed from the highest; winding numbers are propagated from cell to cell along the
// left sides.
#include "prefilter/shapes/raster/row_layers.h"

#include <algorithm>

#include "prefilter/base/elementary.h"
#include "prefilter/shapes/outline/fill_rule.h"
#include "prefilter/shapes/raster/paint_bounds.h"

namespace prefilter {
namespace {

// Slightly below the logarithm of RowLayers::kMinTransmittance.
constexpr double kMinLogTransmittance = -16.2;
// log(1/1024): layers below this transmittance are invisible to sampling.
constexpr double kMinSampledLogTransmittance = -6.94;

// Occlusion is tested once per this many full layers.
constexpr int kLayersPerOcclusionTest = 16;

// Counting sort by column: column c's elements begin at first[c].
template <typename T>
void sort_by_columns(const std::vector<T>& things, int columns, std::vector<std::uint32_t>* first,
                     std::vector<T>* sorted) {
  first->assign(static_cast<std::size_t>(columns) + 3, 0);
  for (const T& thing : things) ++(*first)[static_cast<std::size_t>(thing.column) + 2];
  for (std::size_t i = 1; i < first->size(); ++i) (*first)[i] += (*first)[i - 1];
  sorted->resize(things.size());
  for (const T& thing : things) {
    (*sorted)[(*first)[static_cast<std::size_t>(thing.column) + 1]++] = thing;
  }
}

}  // namespace

RowLayers::RowLayers(const LayerStack& stack, int channels) : full_(stack.layers.size()) {
  for (const StackLayer& layer : stack.layers) {
    rules_.push_back(layer.fill_rule);
    are_cutters_.push_back(layer.is_cutter);
    log_transmittance_.push_back(
        layer.is_cutter ? 0.0 : elementary::log(max_transmittance(*layer.paint, channels)));
  }
}

void RowLayers::make_row(int row, const OpenColumns& requested, StackArcs* arcs) {
  for (const Change& change : changes_) full_.erase(change.layer);
  columns_ = arcs->window().end_column - arcs->window().first_column;
  open_ = requested;
  log_transmittance_steps_.assign(static_cast<std::size_t>(columns_) + 1, 0.0);
  layers_until_test_ = kLayersPerOcclusionTest;
  arc_counts_.assign(static_cast<std::size_t>(columns_), 0);
  arcs_.clear();
  steps_.clear();
  records_.clear();
  changes_.clear();
  arcs->begin_row(row);
  for (const StackArcs::Layer& layer : arcs->layers()) {
    if (!open_.any()) break;
    if (!arcs->is_open(layer, open_)) continue;
    const std::size_t first = arcs_.size();
    arcs->append(layer, open_, &arcs_);
    if (arcs_.size() > first) add_layer(layer.layer, first);
    if (layers_until_test_ <= 0) close_hidden();
  }
  sort_by_columns(records_, columns_, &first_record_, &sorted_records_);
  sort_by_columns(changes_, columns_, &first_change_, &sorted_changes_);
}

void RowLayers::add_layer(std::uint32_t layer, std::size_t first_arc) {
  base_ = 0;
  left_steps_.clear();
  full_end_ = -1;
  int column = 0;
  const std::size_t end = arcs_.size();
  for (std::size_t i = first_arc; i < end;) {
    const std::size_t first = i;
    const int at = arcs_[first].column;
    while (i < end && arcs_[i].column == at) ++i;
    add_gap(layer, column, at);
    if (at >= 0 && open_.is_open(at)) add_cell(layer, at, first, i);
    update_windings(std::span(arcs_).subspan(first, i - first));
    column = at + 1;
  }
  add_gap(layer, column, columns_);
}

// Handles the cells [begin, end), which have no arcs of the layer.
void RowLayers::add_gap(std::uint32_t layer, int begin, int end) {
  if (left_steps_.empty()) {
    if (is_filled(base_, rules_[layer])) add_full(layer, begin, end);
    return;
  }
  for (int column = open_.next(begin, end); column < end; column = open_.next(column + 1, end)) {
    add_cell(layer, column, 0, 0);
  }
}

// Whether the winding number cannot be 0 anywhere: bounds it by the values along the left side and
// the arcs' windings.
bool RowLayers::is_filled_all_over(std::span<const StackArc> arcs, FillRule rule) const {
  if (rule != FillRule::kNonzero) return false;
  std::int64_t least = base_;
  std::int64_t most = base_;
  std::int64_t side = base_;
  for (const SideStep& step : left_steps_) {
    side += step.winding;
    least = std::min(least, side);
    most = std::max(most, side);
  }
  for (const StackArc& arc : arcs) (arc.winding < 0 ? least : most) += arc.winding;
  return least > 0 || most < 0;
}

void RowLayers::add_cell(std::uint32_t layer, int column, std::size_t first_arc,
                         std::size_t end_arc) {
  const auto arcs = std::span(arcs_).subspan(first_arc, end_arc - first_arc);
  if (is_filled_all_over(arcs, rules_[layer])) {
    add_full(layer, column, column + 1);
    return;
  }
  arc_counts_[column] += static_cast<std::uint32_t>(arcs.size());
  const auto first_step = static_cast<std::uint32_t>(steps_.size());
  steps_.insert(steps_.end(), left_steps_.begin(), left_steps_.end());
  records_.push_back({layer, rules_[layer], column, base_, first_step,
                      static_cast<std::uint32_t>(steps_.size()),
                      static_cast<std::uint32_t>(first_arc), static_cast<std::uint32_t>(end_arc)});
}

void RowLayers::add_full(std::uint32_t layer, int begin, int end) {
  if (are_cutters_[layer]) return;
  begin = open_.next(begin, end);
  if (begin >= end) return;
  if (full_end_ == begin) {
    changes_.back().column = end;
  } else {
    changes_.push_back({begin, layer, true});
    changes_.push_back({end, layer, false});
  }
  if (full_end_ < 0) --layers_until_test_;
  full_end_ = end;
  if (log_transmittance_[layer] >= kMinLogTransmittance) {
    log_transmittance_steps_[begin] += log_transmittance_[layer];
    log_transmittance_steps_[end] -= log_transmittance_[layer];
    return;
  }
  for (int column = begin; column < end; column = open_.next(column + 1, end)) {
    open_.close(column);
  }
}

void RowLayers::close_hidden() {
  layers_until_test_ = kLayersPerOcclusionTest;
  double log_transmittance = 0.0;
  for (int column = 0; column < columns_; ++column) {
    log_transmittance += log_transmittance_steps_[column];
    const bool is_sampled = arc_counts_[column] > kMaxSweptArcs;
    if (log_transmittance < (is_sampled ? kMinSampledLogTransmittance : kMinLogTransmittance) &&
        open_.is_open(column)) {
      open_.close(column);
    }
  }
}

// Updates the winding numbers to those along the right side of a cell.
void RowLayers::update_windings(std::span<const StackArc> arcs) {
  for (const StackArc& arc : arcs) {
    if (arc.low.y <= -0.5) {
      base_ += arc.winding;
    } else {
      left_steps_.push_back({arc.low.y, arc.winding});
    }
    if (arc.high.y < 0.5) left_steps_.push_back({arc.high.y, -arc.winding});
  }
  std::sort(left_steps_.begin(), left_steps_.end(),
            [](const SideStep& a, const SideStep& b) { return a.y < b.y; });
  // Horizontal edges leave no arcs, so steps may persist over many cells.
  next_steps_.clear();
  for (std::size_t i = 0; i < left_steps_.size();) {
    SideStep sum = left_steps_[i];
    while (++i < left_steps_.size() && left_steps_[i].y == sum.y)
      sum.winding += left_steps_[i].winding;
    if (sum.winding != 0) next_steps_.push_back(sum);
  }
  std::swap(left_steps_, next_steps_);
}

std::size_t RowLayers::arc_count(int column) const {
  std::size_t count = 0;
  for (std::size_t i = first_record_[column]; i < first_record_[column + 1]; ++i) {
    count += sorted_records_[i].end_arc - sorted_records_[i].first_arc;
  }
  return count;
}

void RowLayers::enter(int column) {
  for (std::size_t i = first_change_[column]; i < first_change_[column + 1]; ++i) {
    const Change& change = sorted_changes_[i];
    if (change.fills) {
      full_.insert(change.layer);
    } else {
      full_.erase(change.layer);
    }
  }
  layers_.clear();
  for (std::size_t i = first_record_[column]; i < first_record_[column + 1]; ++i) {
    const Record& record = sorted_records_[i];
    layers_.push_back(
        {record.layer, record.fill_rule, record.base,
         std::span(steps_).subspan(record.first_step, record.end_step - record.first_step),
         std::span(arcs_).subspan(record.first_arc, record.end_arc - record.first_arc)});
  }
}

int RowLayers::next_change(int column) const {
  for (++column; column < columns_; ++column) {
    if (first_change_[column] != first_change_[column + 1] || layer_count(column) > 0) break;
  }
  return column;
}

}  // namespace prefilter
