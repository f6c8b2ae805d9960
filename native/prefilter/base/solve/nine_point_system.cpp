// SPDX-License-Identifier: GPL-3.0-or-later

// Projected Gauss-Seidel. A mass matrix scaled by its diagonal has a condition number of about 9 on
// fully covered texels, so a few sweeps suffice. Clamping each texel in a sweep converges to the
// constrained solution.
#include "prefilter/base/solve/nine_point_system.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// Levels with fewer texels are solved by a single thread.
constexpr std::int64_t kMinParallelTexels = 256 * 256;
constexpr std::int64_t kRowsPerReport = 64;

float of(float entry) { return entry; }
Lanes of(const LaneValues& entry) { return entry.v; }
void add_to(float* entry, float value) { *entry += value; }
void add_to(LaneValues* entry, const LaneValues& value) { entry->v += value.v; }
void add_to(float* entry, Lanes value) { *entry += value[0]; }
void add_to(LaneValues* entry, Lanes value) { entry->v += value; }

float channel(float entry, int) { return entry; }
float channel(const LaneValues& entry, int c) { return entry.v[c]; }

float inverse_of(float entry) { return entry > 0.0F ? 1.0F / entry : 0.0F; }
LaneValues inverse_of(const LaneValues& entry) {
  const Lanes zero{};
  return {select(entry.v > zero, 1.0F / entry.v, zero)};
}

}  // namespace

template <typename Entry>
NinePointSystem<Entry>::NinePointSystem(int width, int height, WrapModes wrap)
    : width_(width), height_(height), wrap_(wrap), stride_(width + 1) {
  const std::size_t count = static_cast<std::size_t>(stride_) * (height + 1);
  stencils_.resize(count);
  right_side_.resize(count);
}

template <typename Entry>
void NinePointSystem<Entry>::add_cell(int column, int row, const TentProducts& products,
                                      const TentIntegrals& right) {
  const int x[2] = {wrap_index(column, width_, wrap_.u), wrap_index(column + 1, width_, wrap_.u)};
  const int y[2] = {wrap_index(row, height_, wrap_.v), wrap_index(row + 1, height_, wrap_.v)};
  // Both ends may be the same texel: at a clamped edge, or along an axis with a single one.
  const int dx = x[0] == x[1] ? 0 : 1;
  const int dy = y[0] == y[1] ? 0 : 1;

  for (int j = 0; j < 2; ++j) {
    if (y[j] < 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (x[i] < 0) continue;
      const std::ptrdiff_t texel = at(x[i], y[j]);
      add_to(&stencils_[texel].center, products[3 * (2 * j) + 2 * i]);
      right_side_[texel].v += right[2 * j + i].v;
    }
    if (x[0] >= 0 && x[1] >= 0) add_pair(x[0], y[j], dx, 0, products[3 * (2 * j) + 1]);
  }
  if (y[0] < 0 || y[1] < 0) return;
  for (int i = 0; i < 2; ++i) {
    if (x[i] >= 0) add_pair(x[i], y[0], 0, dy, products[3 + 2 * i]);
  }
  if (x[0] < 0 || x[1] < 0) return;
  add_pair(x[0], y[0], dx, dy, products[3 + 1]);
  if (dy == 0) {
    add_pair(x[0], y[0], dx, 0, products[3 + 1]);
  } else {
    add_pair(x[1], y[0], -dx, dy, products[3 + 1]);
  }
}

template <typename Entry>
void NinePointSystem<Entry>::add_pair(int x, int y, int dx, int dy, Entry value) {
  Stencil& stencil = stencils_[at(x, y)];
  if (dx == 0 && dy == 0) {
    add_to(&stencil.center, value);
    add_to(&stencil.center, value);
  } else if (dy == 0) {
    add_to(&stencil.east, value);
  } else if (dx == 0) {
    add_to(&stencil.north, value);
  } else {
    add_to(dx > 0 ? &stencil.north_east : &stencil.north_west, value);
  }
}

template <typename Entry>
int NinePointSystem<Entry>::row_beside(int y, int step) const {
  const int beside = y + step;
  if (beside >= 0 && beside < height_) return beside;
  return wrap_.v == Wrap::kRepeat ? height_ - 1 - y : height_;
}

// A row whose texels are relaxed.
template <typename Entry>
class NinePointSystem<Entry>::Row {
 public:
  Row(NinePointSystem* system, int y, const SolveOptions& options, Lanes typical)
      : width_(system->width_),
        repeat_(system->wrap_.u == Wrap::kRepeat),
        times_alpha_(options.ranges_times_alpha),
        tolerance_(static_cast<float>(options.tolerance)),
        typical_(typical) {
    const std::ptrdiff_t south_row = system->at(0, system->row_beside(y, -1));
    const std::ptrdiff_t north_row = system->at(0, system->row_beside(y, 1));
    here_ = system->stencils_.data() + system->at(0, y);
    south_ = system->stencils_.data() + south_row;
    values_ = system->texels_.data() + system->at(0, y);
    south_values_ = system->texels_.data() + south_row;
    north_values_ = system->texels_.data() + north_row;
    right_side_ = system->right_side_.data() + system->at(0, y);
    if (options.texel_ranges != nullptr) {
      texel_low_ = options.texel_ranges->low.data() + system->at(0, y);
      texel_high_ = options.texel_ranges->high.data() + system->at(0, y);
    }
    // Unlimited ranges end at the largest float, not at infinity, which times an alpha of 0 would
    // be NaN.
    constexpr float kUnlimited = std::numeric_limits<float>::max();
    for (int c = 0; c < kMaxChannels; ++c) {
      low_[c] = std::max(options.ranges[c].low, -kUnlimited);
      high_[c] = std::min(options.ranges[c].high, kUnlimited);
    }
  }

  // Relaxes texels [begin, end).
  void relax(int begin, int end) {
    const auto at_end = [&](int x) {
      relax_one(x, x == 0 ? before_first() : x - 1, x + 1 == width_ ? after_last() : x + 1,
                Lanes{});
    };
    if (begin < end && begin == 0) at_end(begin++);
    const int middle_end = std::min(end, width_ - 1);
    for (int x = begin; x < middle_end; ++x) relax_one(x, x - 1, x + 1, Lanes{});
    if (std::max(begin, middle_end) < end) at_end(end - 1);
  }

  // Relaxes one texel, with `link_sum` added to its right side.
  void relax_linked(int x, Lanes link_sum) {
    relax_one(x, x == 0 ? before_first() : x - 1, x + 1 == width_ ? after_last() : x + 1, link_sum);
  }

  // Whether a channel of a texel moved by more than the tolerance.
  bool moved() const {
    bool moved = false;
    for (int c = 0; c < kMaxChannels; ++c) moved = moved || excess_[c] > 0.0F;
    return moved;
  }

 private:
  // A texel of zeros follows each row.
  int before_first() const { return repeat_ && width_ > 1 ? width_ - 1 : width_; }
  int after_last() const { return repeat_ && width_ > 1 ? 0 : width_; }

  void relax_one(int x, int west, int east, Lanes link_sum) {
    // A little over-relaxation saves sweeps; from about 1.3 on it costs sweeps.
    constexpr float kRelaxation = 1.15F;
    const Lanes old = values_[x].v;
    Lanes sum = right_side_[x].v + link_sum;
    sum -= of(here_[x].east) * values_[east].v;
    sum -= of(here_[x].north) * north_values_[x].v;
    sum -= of(south_[x].north) * south_values_[x].v;
    sum -= of(here_[x].north_east) * north_values_[east].v;
    sum -= of(south_[west].north_east) * south_values_[west].v;
    sum -= of(here_[x].north_west) * north_values_[west].v;
    sum -= of(south_[east].north_west) * south_values_[east].v;
    sum -= of(here_[west].east) * values_[west].v;
    const Lanes inverse = Lanes{} + of(here_[x].center);
    const Lanes free = select(inverse > 0.0F, old + kRelaxation * (sum * inverse - old), old);
    const Lanes low = texel_low_ != nullptr ? texel_low_[x].v : low_;
    const Lanes high = texel_high_ != nullptr ? texel_high_[x].v : high_;
    Lanes scale = Lanes{} + 1.0F;
    if (times_alpha_) {
      scale = Lanes{} + std::clamp(free[3], low[3], high[3]);
      scale[3] = 1.0F;
    }
    const Lanes next = lane_min(lane_max(free, low * scale), high * scale);
    values_[x].v = next;
    const Lanes step = lane_max(next - old, old - next);
    excess_ = lane_max(excess_, step - tolerance_ * lane_max(typical_, lane_max(next, -next)));
  }

  int width_;
  bool repeat_;
  bool times_alpha_;
  float tolerance_;
  Lanes typical_;
  Lanes low_{};
  Lanes high_{};
  const LaneValues* texel_low_ = nullptr;
  const LaneValues* texel_high_ = nullptr;
  Lanes excess_{};
  const Stencil* here_;
  const Stencil* south_;
  LaneValues* values_;
  const LaneValues* south_values_;
  const LaneValues* north_values_;
  const LaneValues* right_side_;
};

template <typename Entry>
bool NinePointSystem<Entry>::relax_row(int y, const SolveOptions& options, Lanes typical) {
  Row row(this, y, options, typical);
  if (links_ == nullptr) {
    row.relax(0, width_);
    return row.moved();
  }
  int begin = 0;
  for (auto linked = first_linked(y); linked->at < at(width_, y); ++linked) {
    const int x = static_cast<int>(linked->at - at(0, y));
    row.relax(begin, x);
    begin = x + 1;
  }
  row.relax(begin, width_);
  return row.moved();
}

template <typename Entry>
std::vector<LinkForm::Texel>::const_iterator NinePointSystem<Entry>::first_linked(int y) const {
  return std::lower_bound(
      links_->texels().begin(), links_->texels().end(), at(0, y),
      [](const LinkForm::Texel& texel, std::ptrdiff_t first) { return texel.at < first; });
}

template <typename Entry>
void NinePointSystem<Entry>::relax_linked(const SolveOptions& options, Lanes typical,
                                          std::vector<unsigned char>* moves,
                                          const std::function<bool()>& goes_on) {
  if (links_ == nullptr) return;
  const std::vector<LinkForm::Texel>& linked = links_->texels();
  for (std::size_t k = 0; k + 1 < linked.size();) {
    if (!goes_on()) return;
    const int y = static_cast<int>(linked[k].at / stride_);
    Row row(this, y, options, typical);
    for (; linked[k].at < at(width_, y); ++k) {
      Lanes sum{};
      for (const LinkForm::Entry* entry = links_->begin(k); entry != links_->end(k); ++entry) {
        sum += entry->value * texels_[entry->at].v;
      }
      row.relax_linked(static_cast<int>(linked[k].at - at(0, y)), -link_weights_ * sum);
    }
    if (row.moved()) (*moves)[y] = 1;
  }
}

template <typename Entry>
Lanes NinePointSystem<Entry>::typical_values() const {
  std::array<std::vector<float>, kMaxChannels> row_means;
  for (int y = 0; y < height_; ++y) {
    Lanes sum{};
    float used = 0.0F;
    for (std::ptrdiff_t j = at(0, y); j < at(width_, y); ++j) {
      if (!is_part(j)) continue;
      sum += lane_max(texels_[j].v, -texels_[j].v);
      used += 1.0F;
    }
    for (int c = 0; c < kMaxChannels && used > 0.0F; ++c) row_means[c].push_back(sum[c] / used);
  }
  Lanes typical{};
  for (int c = 0; c < kMaxChannels; ++c) {
    std::vector<float>& means = row_means[c];
    if (means.empty()) continue;
    const auto middle = means.begin() + static_cast<std::ptrdiff_t>(means.size() / 2);
    std::nth_element(means.begin(), middle, means.end());
    typical[c] = *middle;
  }
  return typical;
}

template <typename Entry>
int NinePointSystem<Entry>::solve(const SolveOptions& options, const Run& run) {
  const Lanes typical = typical_values();

  // A row is relaxed as long as it or a neighboring row still moves; the slot past the last row
  // stands for missing neighbors. Rows of one color, alternating between 0 and 1, are not adjacent,
  // so they are relaxed concurrently. In an odd number of repeating rows the last one is adjacent
  // to the first, and is relaxed separately.
  std::vector<unsigned char> moves(static_cast<std::size_t>(height_) + 1, 1);
  moves[height_] = 0;
  const auto relax = [&](int y) {
    if (moves[y] == 0 && moves[row_beside(y, -1)] == 0 && moves[row_beside(y, 1)] == 0) return;
    moves[y] = relax_row(y, options, typical) ? 1 : 0;
  };
  const bool odd_ring = wrap_.v == Wrap::kRepeat && height_ > 1 && height_ % 2 == 1;
  const std::int64_t rows_of_color[2] = {(height_ + 1) / 2 - (odd_ring ? 1 : 0), height_ / 2};

  int sweeps = 0;
  bool done = false;
  std::exception_ptr cancelled;
  std::atomic<bool> stop{false};
  const auto report = [&](double sweeps_done) {
    try {
      if (!cancelled) run.report(sweeps_done / options.max_sweeps);
    } catch (...) {
      cancelled = std::current_exception();
      stop = true;
    }
  };
  const bool small = static_cast<std::int64_t>(width_) * height_ < kMinParallelTexels;
  parallel_team(small ? 1 : resolve_threads(run.threads()), [&](Team& team) {
    while (!done) {
      for (int color = 0; color < 2; ++color) {
        const std::int64_t end = team.share_end(rows_of_color[color]);
        for (std::int64_t i = team.share_begin(rows_of_color[color]); i < end; ++i) {
          if (stop.load(std::memory_order_relaxed)) break;
          relax(static_cast<int>(2 * i) + color);
          if (team.rank() == 0 && i % kRowsPerReport == 0) {
            report(sweeps + 0.5 * (color + static_cast<double>(i) / static_cast<double>(end)));
          }
        }
        team.wait_for_all();
      }
      if (team.rank() == 0) {
        if (odd_ring) relax(height_ - 1);
        relax_linked(options, typical, &moves, [&] {
          report(sweeps + 1.0);
          return !stop.load(std::memory_order_relaxed);
        });
        ++sweeps;
        const bool settled = std::find(moves.begin(), moves.end(), 1) == moves.end();
        report(sweeps);
        done = settled || sweeps >= options.max_sweeps || cancelled;
      }
      team.wait_for_all();
    }
  });
  if (cancelled) std::rethrow_exception(cancelled);
  return sweeps;
}

template <typename Entry>
std::vector<LaneValues> NinePointSystem<Entry>::product() const {
  std::vector<LaneValues> products(stencils_.size());
  const bool repeat = wrap_.u == Wrap::kRepeat && width_ > 1;
  for (int y = 0; y < height_; ++y) {
    const std::ptrdiff_t south = at(0, row_beside(y, -1));
    const std::ptrdiff_t here = at(0, y);
    const std::ptrdiff_t north = at(0, row_beside(y, 1));
    for (int x = 0; x < width_; ++x) {
      if (!is_part(here + x)) continue;
      // A texel of zeros follows each row.
      const int west = x > 0 ? x - 1 : repeat ? width_ - 1 : width_;
      const int east = x + 1 < width_ ? x + 1 : repeat ? 0 : width_;
      const Stencil& stencil = stencils_[here + x];
      products[here + x].v = of(stencil.center) * texels_[here + x].v +
                             of(stencil.east) * texels_[here + east].v +
                             of(stencil.north) * texels_[north + x].v +
                             of(stencil.north_east) * texels_[north + east].v +
                             of(stencil.north_west) * texels_[north + west].v +
                             of(stencils_[here + west].east) * texels_[here + west].v +
                             of(stencils_[south + x].north) * texels_[south + x].v +
                             of(stencils_[south + west].north_east) * texels_[south + west].v +
                             of(stencils_[south + east].north_west) * texels_[south + east].v;
    }
  }
  return products;
}

template <typename Entry>
void NinePointSystem<Entry>::weigh_links(const LinkForm* links, Lanes weights) {
  if (links_ != nullptr) {
    for (std::size_t k = 0; k < alone_.size(); ++k) {
      stencils_[links_->texels()[k].at].center = inverse_of(alone_[k]);
    }
  }
  alone_.clear();
  bool counts = false;
  for (int c = 0; c < kMaxChannels; ++c) counts = counts || weights[c] > 0.0F;
  links_ = links == nullptr || links->empty() || !counts ? nullptr : links;
  link_weights_ = weights;
  if (links_ == nullptr) return;
  for (std::size_t k = 0; k + 1 < links_->texels().size(); ++k) {
    const LinkForm::Texel& texel = links_->texels()[k];
    Entry diagonal = inverse_of(stencils_[texel.at].center);
    alone_.push_back(diagonal);
    add_to(&diagonal, texel.own * link_weights_);
    stencils_[texel.at].center = inverse_of(diagonal);
  }
}

template <typename Entry>
void NinePointSystem<Entry>::clear() {
  std::fill(stencils_.begin(), stencils_.end(), Stencil{});
  std::fill(right_side_.begin(), right_side_.end(), LaneValues{});
  links_ = nullptr;
  alone_.clear();
}

template <typename Entry>
void NinePointSystem<Entry>::invert_diagonal() {
  for (Stencil& stencil : stencils_) stencil.center = inverse_of(stencil.center);
}

template <typename Entry>
bool NinePointSystem<Entry>::is_part(std::ptrdiff_t at) const {
  const Lanes inverse = Lanes{} + of(stencils_[at].center);
  return inverse[0] > 0.0F || inverse[1] > 0.0F || inverse[2] > 0.0F || inverse[3] > 0.0F;
}

template <typename Entry>
std::array<double, kMaxChannels> NinePointSystem<Entry>::form(const std::vector<LaneValues>& b,
                                                              float less, int threads) const {
  using Sums = std::array<double, kMaxChannels>;
  std::vector<Sums> rows(static_cast<std::size_t>(height_));
  const bool repeat = wrap_.u == Wrap::kRepeat && width_ > 1;
  const bool small = static_cast<std::int64_t>(width_) * height_ < kMinParallelTexels;
  parallel_for(height_, Run(small ? 1 : threads), [&](std::int64_t row) {
    const int y = static_cast<int>(row);
    const Stencil* here = stencils_.data() + at(0, y);
    const LaneValues* values = texels_.data() + at(0, y);
    const LaneValues* north = texels_.data() + at(0, row_beside(y, 1));
    const LaneValues* right = b.data() + at(0, y);
    std::size_t linked = 0;
    if (links_ != nullptr)
      linked = static_cast<std::size_t>(first_linked(y) - links_->texels().begin());
    Sums sums{};
    for (int x = 0; x < width_; ++x) {
      const bool is_linked = links_ != nullptr && links_->texels()[linked].at == at(x, y);
      const Entry center = is_linked ? alone_[linked++] : inverse_of(here[x].center);
      if (!is_part(at(x, y))) continue;
      const int past_west = repeat ? width_ - 1 : width_;
      const int west = x > 0 ? x - 1 : past_west;
      const int east = x + 1 < width_ || !repeat ? x + 1 : 0;
      for (int c = 0; c < kMaxChannels; ++c) {
        const auto product = [c](const Entry& entry, const LaneValues& value) {
          return static_cast<double>(channel(entry, c)) * value.v[c];
        };
        const double beside =
            product(here[x].east, values[east]) + product(here[x].north, north[x]) +
            product(here[x].north_east, north[east]) + product(here[x].north_west, north[west]);
        const double value = values[x].v[c];
        const double diagonal = static_cast<double>(channel(center, c)) - less;
        sums[c] += value * (diagonal * value + 2.0 * (beside - right[x].v[c]));
      }
    }
    rows[row] = sums;
  });
  Sums total{};
  for (const Sums& row : rows) {
    for (int c = 0; c < kMaxChannels; ++c) total[c] += row[c];
  }
  return total;
}

template <typename Entry>
Image NinePointSystem<Entry>::take_image(int channels) {
  std::vector<Stencil>().swap(stencils_);
  std::vector<LaneValues>().swap(right_side_);
  Image image(width_, height_, channels);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      for (int c = 0; c < channels; ++c) image.texel(x, y)[c] = texels_[at(x, y)].v[c];
    }
  }
  std::vector<LaneValues>().swap(texels_);
  return image;
}

template class NinePointSystem<float>;
template class NinePointSystem<LaneValues>;

}  // namespace prefilter
