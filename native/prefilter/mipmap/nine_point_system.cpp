// A mass matrix that is scaled by its diagonal has a condition number of about 9 on whole texels,
// so a few Gauss-Seidel sweeps do; and a sweep that clamps each texel as it goes converges to the
// solution of the problem with ranges.
#include "prefilter/mipmap/nine_point_system.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "prefilter/base/parallel.h"

namespace prefilter {
namespace {

// Levels of fewer texels are not worth a second thread.
constexpr std::int64_t kTexelsWorthThreads = 64 * 64;

float of(float entry) { return entry; }
Lanes of(const LaneValues& entry) { return entry.v; }
void add_to(float* entry, float value) { *entry += value; }
void add_to(LaneValues* entry, const LaneValues& value) { entry->v += value.v; }

float inverse_of(float entry) { return entry > 0.0F ? 1.0F / entry : 0.0F; }
LaneValues inverse_of(const LaneValues& entry) {
  const Lanes zero{};
  return {entry.v > zero ? 1.0F / entry.v : zero};
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
  // Both ends may be one texel: at a clamped edge, or where an axis has only one.
  const int dx = x[0] == x[1] ? 0 : 1;
  const int dy = y[0] == y[1] ? 0 : 1;

  for (int j = 0; j < 2; ++j) {
    if (y[j] < 0) continue;
    for (int i = 0; i < 2; ++i) {
      if (x[i] < 0) continue;
      const std::ptrdiff_t texel = at(x[i], y[j]);
      add_to(&stencils_[texel].centre, products[3 * (2 * j) + 2 * i]);
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
    add_to(&stencil.centre, value);
    add_to(&stencil.centre, value);
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

template <typename Entry>
bool NinePointSystem<Entry>::relax_row(int y, const SolveOptions& options, Lanes typical) {
  // A little over-relaxation saves sweeps; from about 1.3 on it costs some.
  constexpr float kRelaxation = 1.15F;
  const int south_row = row_beside(y, -1);
  const int north_row = row_beside(y, 1);
  const Stencil* here = stencils_.data() + at(0, y);
  const Stencil* south = stencils_.data() + at(0, south_row);
  LaneValues* values = texels_.data() + at(0, y);
  const LaneValues* south_values = texels_.data() + at(0, south_row);
  const LaneValues* north_values = texels_.data() + at(0, north_row);
  const LaneValues* right_side = right_side_.data() + at(0, y);

  // Open ranges are as wide as floats go, and not infinite: times an alpha of 0 they are 0.
  constexpr float kWidest = std::numeric_limits<float>::max();
  Lanes low{};
  Lanes high{};
  for (int c = 0; c < kMaxChannels; ++c) {
    low[c] = std::max(options.ranges[c].low, -kWidest);
    high[c] = std::min(options.ranges[c].high, kWidest);
  }
  const auto tolerance = static_cast<float>(options.tolerance);

  Lanes excess{};
  const auto relax = [&](int x, int west, int east) {
    const Lanes old = values[x].v;
    Lanes sum = right_side[x].v;
    sum -= of(here[x].east) * values[east].v;
    sum -= of(here[x].north) * north_values[x].v;
    sum -= of(south[x].north) * south_values[x].v;
    sum -= of(here[x].north_east) * north_values[east].v;
    sum -= of(south[west].north_east) * south_values[west].v;
    sum -= of(here[x].north_west) * north_values[west].v;
    sum -= of(south[east].north_west) * south_values[east].v;
    sum -= of(here[west].east) * values[west].v;
    const Lanes inverse = Lanes{} + of(here[x].centre);
    const Lanes free = inverse > 0.0F ? old + kRelaxation * (sum * inverse - old) : old;
    Lanes scale = Lanes{} + 1.0F;
    if (options.ranges_times_alpha) {
      scale = Lanes{} + std::clamp(free[3], low[3], high[3]);
      scale[3] = 1.0F;
    }
    const Lanes next = lane_min(lane_max(free, low * scale), high * scale);
    values[x].v = next;
    const Lanes step = lane_max(next - old, old - next);
    excess = lane_max(excess, step - tolerance * lane_max(typical, lane_max(next, -next)));
  };
  const bool repeat = wrap_.u == Wrap::kRepeat;
  const int pad = width_;
  if (width_ == 1) {
    relax(0, pad, pad);
  } else {
    relax(0, repeat ? width_ - 1 : pad, 1);
    for (int x = 1; x + 1 < width_; ++x) relax(x, x - 1, x + 1);
    relax(width_ - 1, width_ - 2, repeat ? 0 : pad);
  }
  bool moved = false;
  for (int c = 0; c < kMaxChannels; ++c) moved = moved || excess[c] > 0.0F;
  return moved;
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
int NinePointSystem<Entry>::solve(const SolveOptions& options, const Progress& progress) {
  const Lanes typical = typical_values();

  // A row is relaxed while it or a row beside it still moves; the slot past the last row is for a
  // row that is not there. Rows of one colour, 0 and 1 in turn, are not beside each other, so they
  // can move at the same time; of an odd number that repeats, the last is beside the first, and
  // comes by itself.
  std::vector<unsigned char> moves(static_cast<std::size_t>(height_) + 1, 1);
  moves[height_] = 0;
  const auto relax = [&](int y) {
    if (moves[y] == 0 && moves[row_beside(y, -1)] == 0 && moves[row_beside(y, 1)] == 0) return;
    moves[y] = relax_row(y, options, typical) ? 1 : 0;
  };
  const bool odd_ring = wrap_.v == Wrap::kRepeat && height_ > 1 && height_ % 2 == 1;
  const std::int64_t rows_of_colour[2] = {(height_ + 1) / 2 - (odd_ring ? 1 : 0), height_ / 2};

  int sweeps = 0;
  bool done = false;
  std::exception_ptr cancelled;
  const bool small = static_cast<std::int64_t>(width_) * height_ < kTexelsWorthThreads;
  parallel_team(small ? 1 : resolve_threads(options.threads), [&](Team& team) {
    while (!done) {
      for (int colour = 0; colour < 2; ++colour) {
        const std::int64_t end = team.share_end(rows_of_colour[colour]);
        for (std::int64_t i = team.share_begin(rows_of_colour[colour]); i < end; ++i) {
          relax(static_cast<int>(2 * i) + colour);
        }
        team.wait_for_all();
      }
      if (team.rank() == 0) {
        if (odd_ring) relax(height_ - 1);
        ++sweeps;
        const bool settled = std::find(moves.begin(), moves.end(), 1) == moves.end();
        try {
          progress.report(static_cast<double>(sweeps) / options.max_sweeps);
        } catch (...) {
          cancelled = std::current_exception();
        }
        done = settled || sweeps >= options.max_sweeps || cancelled;
      }
      team.wait_for_all();
    }
  });
  if (cancelled) std::rethrow_exception(cancelled);
  return sweeps;
}

template <typename Entry>
void NinePointSystem<Entry>::clear() {
  std::fill(stencils_.begin(), stencils_.end(), Stencil{});
  std::fill(right_side_.begin(), right_side_.end(), LaneValues{});
}

template <typename Entry>
void NinePointSystem<Entry>::invert_diagonal() {
  for (Stencil& stencil : stencils_) stencil.centre = inverse_of(stencil.centre);
}

template <typename Entry>
bool NinePointSystem<Entry>::is_part(std::ptrdiff_t at) const {
  const Lanes inverse = Lanes{} + of(stencils_[at].centre);
  return inverse[0] > 0.0F || inverse[1] > 0.0F || inverse[2] > 0.0F || inverse[3] > 0.0F;
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
