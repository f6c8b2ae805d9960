// SPDX-License-Identifier: GPL-3.0-or-later

// Along a row, the cells between two cells with arcs have the same layers. The value of a cell with
// arcs is a sum over the parts of arcs: the region to the right of each part, times the difference
// of the colors on both sides.
#include "prefilter/shapes/raster/stack_rows.h"

#include <algorithm>
#include <array>

namespace prefilter {
namespace {

constexpr double kStackRowsUnit = 1.0 / (1 << kMomentBits);
constexpr std::size_t kMaxArcsForMoments = RowLayers::kMaxSweptArcs;
// Areas are not limited by the range of integer moments; a curve then consists of several arcs.
constexpr std::size_t kMaxArcsForAreas = 250;

// Approximate steps of a sweep in which some arcs cross; the sweep for areas is shorter.
constexpr std::size_t steps_of(std::size_t arcs, bool are_for_areas) {
  return are_for_areas ? (arcs * arcs + 1) / 2 : 3 * arcs * arcs;
}

// The steps for a row, given the steps for the image.
std::size_t steps_per_row(std::size_t steps, int height) {
  return steps / static_cast<std::size_t>(std::max(height, 64));
}

}  // namespace

template <int N>
StackRows<N>::StackRows(const LayerStack& stack, const CellFilter& filter,
                        const ChannelValues& background, int channels, int width, int height,
                        std::size_t sweep_steps)
    : stack_(stack),
      filter_(filter),
      channels_(channels),
      width_(width),
      sweep_steps_(steps_per_row(sweep_steps, height)),
      layers_(stack, channels),
      colors_(stack, filter, background, channels),
      sweep_(arcs_),
      quadrature_(N),
      pixels_(filter, width) {}

// Chooses the largest number of arcs per cell that is swept in this row.
template <int N>
void StackRows<N>::plan_row() {
  std::array<std::size_t, kMaxArcsForAreas + 1> cells{};  // number of cells by number of arcs
  const std::size_t most = has_parabolas_ ? kMaxArcsForAreas : kMaxArcsForMoments;
  const int columns = arcs_.window().end_column - arcs_.window().first_column;
  for (int column = 0; column < columns; ++column) {
    if (layers_.layer_count(column) == 0) continue;
    const std::size_t arcs = layers_.arc_count(column);
    if (arcs <= most) ++cells[arcs];
  }
  std::size_t steps = 0;
  for (max_arcs_ = 0; max_arcs_ < most; ++max_arcs_) {
    steps += cells[max_arcs_ + 1] * steps_of(max_arcs_ + 1, has_parabolas_);
    if (steps > sweep_steps_) break;
  }
}

template <int N>
void StackRows<N>::add_values(int first_row, int end_row, BandValues* values) {
  pixels_.begin(first_row, end_row, values);
  has_parabolas_ = !stack_.is_constant;
  arcs_.begin_band(stack_, filter_, width_, first_row, end_row, has_parabolas_);
  const GridWindow& window = arcs_.window();
  for (int row = window.first_row; row < window.end_row; ++row) {
    requested_.reset(window.end_column - window.first_column);
    add_row(row);
  }
}

template <int N>
void StackRows<N>::add_marked(int first_row, int end_row, const CompositedRows& marks,
                              BandValues* values) {
  pixels_.begin(first_row, end_row, values);
  has_parabolas_ = true;
  arcs_.begin_band(stack_, filter_, width_, first_row, end_row, has_parabolas_, &marks);
  for (int row = first_row; row < end_row; ++row) {
    if (!marks.has_marks(row)) continue;
    marks.marked_columns(row, &requested_);
    add_row(row);
  }
}

template <int N>
void StackRows<N>::add_row(int row) {
  layers_.make_row(row, requested_, &arcs_);
  plan_row();
  const int first = arcs_.window().first_column;
  const int columns = arcs_.window().end_column - first;
  for (int column = 0; column < columns;) {
    layers_.enter(column);
    if (layers_.layers().empty()) {
      const int end = layers_.next_change(column);
      add_requested(column, end, row);
      column = end;
    } else {
      add_cell(first + column, row);
      ++column;
    }
  }
}

// Adds runs of requested cells.
template <int N>
void StackRows<N>::add_requested(int begin, int end, int row) {
  const int first = arcs_.window().first_column;
  while ((begin = requested_.next(begin, end)) < end) {
    int last = begin + 1;
    while (last < end && requested_.is_open(last)) ++last;
    add_run(first + begin, first + last, row);
    begin = last;
  }
}

template <int N>
void StackRows<N>::add_run(int begin, int end, int row) {
  if (layers_.full().highest_below(static_cast<std::uint32_t>(stack_.layers.size())) ==
      LayerSet::kNone) {
    return;
  }
  colors_.begin_cell(begin, row, {}, layers_.full());
  if (!stack_.is_constant) {
    add_varying_run(begin, end, row);
    return;
  }
  ChannelValues color;
  colors_.compose(0, &color);
  pixels_.add_constant(begin, end, row, {color.data(), static_cast<std::size_t>(channels_)});
}

template <int N>
void StackRows<N>::add_varying_run(int begin, int end, int row) {
  const auto seen = colors_.seen_layers();
  if (N == 0 && seen.size() == 1) {
    add_means(*stack_.layers[seen[0].layer].paint, begin, end, row);
    return;
  }
  for (int column = begin; column < end; ++column) {
    colors_.move_to(column, row);
    quadrature_.find_full(colors_);
    for (int c = 0; c < channels_; ++c) pixels_.add(column, row, c, quadrature_.sums(c));
  }
}

// Adds a single layer under the box filter.
template <int N>
void StackRows<N>::add_means(const Paint& paint, int begin, int end, int row) {
  if (means_ == nullptr || means_of_ != &paint) {
    means_ = std::make_unique<PaintMeans>(paint);
    means_of_ = &paint;
  }
  pixels_.add_row(begin, end, row, [&](int first, int last, double* out) {
    run_.resize(static_cast<std::size_t>(last - first) * channels_);
    means_->find(first, last, row, run_.data());
    for (std::size_t i = 0; i < run_.size(); i += channels_) {
      const double opaque = channels_ == kMaxChannels ? run_[i + kMaxChannels - 1] : 1.0;
      for (int c = 0; c < channels_; ++c) {
        *out++ += run_[i + c] - opaque * colors_.background()[c];
      }
    }
  });
}

template <int N>
void StackRows<N>::add_cell(int column, int row) {
  const auto layers = layers_.layers();
  colors_.begin_cell(column, row, layers, layers_.full());
  const auto seen = layers.first(colors_.examine(CellSweep::kMaxSweptLayers + 1));
  std::size_t arcs = 0;
  for (const CellLayer& layer : seen) arcs += layer.arcs.size();
  const std::size_t most_work = 16 * steps_of(arcs, false) + 256;
  if (arcs <= max_arcs_ && seen.size() <= CellSweep::kMaxSweptLayers) {
    if (!stack_.is_constant) {
      if (quadrature_.find(seen, colors_, most_work)) {
        ++work_.swept_cells;
        work_.swept_steps += quadrature_.work();
        for (int c = 0; c < channels_; ++c) pixels_.add(column, row, c, quadrature_.sums(c));
        return;
      }
    } else if (has_parabolas_) {
      if (areas_.find(seen, colors_, most_work)) {
        ++work_.swept_cells;
        work_.swept_steps += areas_.work();
        const std::span<const double> mean(areas_.mean());
        pixels_.add_constant(column, column + 1, row,
                             mean.first(static_cast<std::size_t>(channels_)));
        return;
      }
    } else if (sweep_.sweep(column, row, seen, most_work)) {
      ++work_.swept_cells;
      work_.swept_steps += sweep_.work();
      add_swept(column, row);
      return;
    }
  }
  ++work_.sampled_cells;
  add_sampled(column, row);
}

template <int N>
void StackRows<N>::add_sampled(int column, int row) {
  if (samples_ == nullptr) {
    samples_ = std::make_unique<CellSamples>(arcs_, channels_, N > 0 || !stack_.is_constant);
  }
  samples_->compose(column, row, layers_.layers(), &colors_);
  const int degree = filter_.degree;
  for (int c = 0; c < channels_; ++c) {
    sums_[c].resize(static_cast<std::size_t>(degree + 1) * (degree + 1));
    samples_->moments(c, degree, sums_[c].data());
    pixels_.add(column, row, c, sums_[c]);
  }
}

// Adds a part of an arc to the moments of a pair of states.
template <int N>
void StackRows<N>::integrate(const SweptPart& part, int column, int row, std::int32_t pair) {
  if (part.arc == SweptPart::kLeftSide) {
    batch_.add_line({-0.5, part.low}, {-0.5, part.high}, 1, pair, &moments_);
    return;
  }
  const StackArc& arc = sweep_.arc(part);
  const Point2 low = sweep_.point_at(arc, part.low);
  const Point2 high = sweep_.point_at(arc, part.high);
  if (arc.curve == StackArc::kLine) {
    batch_.add_line(low, high, 1, pair, &moments_);
    return;
  }
  const StackCurve& curve = arcs_.curve(arc);
  const Point2 center{column + 0.5, row + 0.5};
  const MonotoneCurve& piece = arcs_.piece(curve);
  const bool rises = piece.begin.y < piece.end.y;
  const auto parameter = [&](double y) {
    if (y <= arc.low.y) return rises ? curve.t_begin : curve.t_end;
    if (y >= arc.high.y) return rises ? curve.t_end : curve.t_begin;
    return sweep_.parameter_at(arc, y);
  };
  CellArc cell_arc{parameter(part.low), parameter(part.high), low + center, high + center};
  if (!rises) {
    std::swap(cell_arc.t_begin, cell_arc.t_end);
    std::swap(cell_arc.begin, cell_arc.end);
  }
  batch_.add_curve(piece.curve, cell_arc, center, rises ? 1 : -1, pair, &moments_);
}

// Adds the region right of arcs, times the difference of the colors on both sides.
template <int N>
void StackRows<N>::add_state_pair(const ArcMoments<N>& moments, const ChannelValues& step) {
  std::array<std::array<double, N + 1>, N + 1> powers;
  for (int a = 0; a <= N; ++a) {
    auto& line = powers[a];
    for (int b = 0; b <= N; ++b) {
      line[b] = kStackRowsUnit * (at_high_end(a) * moments.across(b) - moments.inside(a, b));
    }
    for (int b = 1; b <= N; ++b) line[b] += mean_power(b) * line[0];
  }
  for (int c = 0; c < channels_; ++c) {
    for (int a = 0; a <= N; ++a) {
      for (int b = 0; b <= N; ++b) sums_[c][a * (N + 1) + b] += step[c] * powers[a][b];
    }
  }
}

template <int N>
void StackRows<N>::add_swept(int column, int row) {
  const std::size_t states = sweep_.state_count();
  state_colors_.assign(states, {});
  for (std::uint32_t state = 1; state < states; ++state) {
    colors_.compose(sweep_.present_in(state), &state_colors_[state]);
  }
  state_pairs_.clear();
  moments_.clear();
  for (const SweptPart& part : sweep_.parts()) {
    if (state_colors_[part.left] == state_colors_[part.right]) continue;
    const std::uint32_t pair =
        state_pairs_.index_of(static_cast<std::uint64_t>(part.left) << 32 | part.right);
    if (pair == moments_.size()) moments_.emplace_back();
    integrate(part, column, row, static_cast<std::int32_t>(pair));
  }
  batch_.flush(&moments_);
  for (int c = 0; c < channels_; ++c) {
    sums_[c].assign(static_cast<std::size_t>(N + 1) * (N + 1), 0.0);
  }
  for (std::size_t pair = 0; pair < moments_.size(); ++pair) {
    const std::uint64_t key = state_pairs_.keys()[pair];
    const ChannelValues& before = state_colors_[key >> 32];
    ChannelValues step = state_colors_[key & UINT32_MAX];
    for (int c = 0; c < channels_; ++c) step[c] -= before[c];
    add_state_pair(moments_[pair], step);
  }
  for (int c = 0; c < channels_; ++c) pixels_.add(column, row, c, sums_[c]);
}

template class StackRows<0>;
template class StackRows<1>;
template class StackRows<2>;
template class StackRows<3>;
template class StackRows<7>;

}  // namespace prefilter
