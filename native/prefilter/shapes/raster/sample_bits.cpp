// SPDX-License-Identifier: GPL-3.0-or-later

// Bit-parallel scan conversion on a shuffled 64 x 64 grid.
#include "prefilter/shapes/raster/sample_bits.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <span>

#include "prefilter/base/vectors.h"
#include "prefilter/shapes/outline/fill_rule.h"

namespace prefilter {
namespace {

constexpr int kSampleBitsSide = SampleBits::kSide;
constexpr int kCount = SampleBits::kCount;
constexpr std::uint64_t kSampleBitsAll = ~std::uint64_t{0};

// A fixed permutation of the integers below 64.
constexpr std::array<int, kSampleBitsSide> shuffled(unsigned first, unsigned factor,
                                                    unsigned shift) {
  std::array<int, kSampleBitsSide> numbers{};
  for (unsigned i = 0; i < kSampleBitsSide; ++i) {
    unsigned mixed = (i * factor + first) % kSampleBitsSide;
    mixed ^= mixed >> shift;
    mixed = mixed * 27 % kSampleBitsSide;
    mixed ^= mixed >> 3;
    numbers[i] = static_cast<int>(mixed);
  }
  return numbers;
}

// Shifts of rows to the right and of columns upward, in 1/64 of a step.
constexpr std::array<int, kSampleBitsSide> kRowShifts = shuffled(7, 43, 2);
constexpr std::array<int, kSampleBitsSide> kColumnShifts = shuffled(29, 37, 3);

constexpr std::array<float, kSampleBitsSide> positions_of(
    const std::array<int, kSampleBitsSide>& shifts) {
  std::array<float, kSampleBitsSide> positions{};
  for (int i = 0; i < kSampleBitsSide; ++i)
    positions[i] = (static_cast<float>(shifts[i]) + 0.5F) / kSampleBitsSide;
  return positions;
}

constexpr std::array<float, kSampleBitsSide> kRowPositions = positions_of(kRowShifts);

// Columns shifted by at least this much.
constexpr std::array<std::uint64_t, kSampleBitsSide + 1> kShiftedFrom = [] {
  std::array<std::uint64_t, kSampleBitsSide + 1> columns{};
  for (int shift = 0; shift <= kSampleBitsSide; ++shift) {
    for (int c = 0; c < kSampleBitsSide; ++c) {
      if (kColumnShifts[c] >= shift) columns[shift] |= std::uint64_t{1} << c;
    }
  }
  return columns;
}();

// Columns from this one on.
constexpr std::array<std::uint64_t, kSampleBitsSide + 1> kFrom = [] {
  std::array<std::uint64_t, kSampleBitsSide + 1> columns{};
  for (int c = 0; c < kSampleBitsSide; ++c) columns[c] = kSampleBitsAll << c;
  return columns;
}();

using Band = SampleBits::Band;

// Number of samples below a height; no two samples have the same height.
int samples_below(double y) {
  return std::clamp(static_cast<int>(std::ceil((y + 0.5) * kCount - 0.5)), 0, kCount);
}

// Samples of a band to the right of a line with |dx| <= dy.
void find_right_of_steep(Point2 low, Point2 high, const Band& band, SampleRows* right) {
  const double slope = (high.x - low.x) / (high.y - low.y);
  const int begin = band.first_row();
  const int end = band.end_row();
  const double y = (begin + 0.5) / kSampleBitsSide - 0.5;
  const auto first =
      static_cast<float>((low.x + (y - low.y) * slope + 0.5) * kSampleBitsSide + 1.0);
  const auto step = static_cast<float>(slope);
  std::array<std::int32_t, kSampleBitsSide> columns;
  for (int row = begin; row < end; ++row) {
    const float column = first + step * static_cast<float>(row - begin) - kRowPositions[row];
    columns[row] = static_cast<std::int32_t>(
        std::min(std::max(column, 0.0F), static_cast<float>(kSampleBitsSide)));
  }
  for (int row = begin; row < end; ++row) (*right)[row] = kFrom[columns[row]];
  (*right)[begin] &= band.columns(begin);
  if (end - 1 > begin) (*right)[end - 1] &= band.columns(end - 1);
}

// Samples of a band to the right of a line with |dx| > dy, which has one height in each column.
void find_right_of_flat(Point2 low, Point2 high, const Band& band, SampleRows* right) {
  const double slope = (high.y - low.y) / (high.x - low.x);
  const auto column_of = [](double x) {
    return std::clamp(static_cast<int>((x + 0.5) * kSampleBitsSide), 0, kSampleBitsSide - 1);
  };
  const int begin = column_of(std::min(low.x, high.x));
  const int end = column_of(std::max(low.x, high.x)) + 1;
  const double x = (begin + 0.5) / kSampleBitsSide - 0.5;
  const auto first = static_cast<float>((low.y + (x - low.x) * slope + 0.5) * kCount + 0.5);
  const auto step = static_cast<float>(slope * kSampleBitsSide);
  const auto least = static_cast<float>(band.low);
  const auto most = static_cast<float>(band.high);
  std::array<std::int32_t, kSampleBitsSide> rows;  // the first row above the line
  for (int column = begin; column < end; ++column) {
    const float number = first + step * static_cast<float>(column - begin);
    rows[column] = (static_cast<std::int32_t>(std::min(std::max(number, least), most)) +
                    kSampleBitsSide - 1 - kColumnShifts[column]) >>
                   6;
  }
  // Rows at which samples enter or leave the region.
  std::array<std::uint64_t, kSampleBitsSide + 2> changes;
  const int first_row = band.first_row();
  const int end_row = band.end_row();
  std::fill(changes.begin() + first_row, changes.begin() + end_row + 2, 0);
  const auto change = [&changes](int number, std::uint64_t columns) {
    const int row = number / kSampleBitsSide;
    const std::uint64_t above = kShiftedFrom[number % kSampleBitsSide];
    changes[row] ^= columns & above;
    changes[row + 1] ^= columns & ~above;
  };
  const bool leans_right = high.x > low.x;
  change(band.low, kFrom[leans_right ? begin : end]);
  change(band.high, kFrom[leans_right ? end : begin]);
  for (int column = begin; column < end; ++column) {
    changes[rows[column]] ^= std::uint64_t{1} << column;
  }
  std::uint64_t columns = 0;
  for (int row = first_row; row < end_row; ++row) {
    columns ^= changes[row];
    (*right)[row] = columns;
  }
}

// Finds the samples to the right of a line, in the band of its rows.
Band find_right_of(Point2 low, Point2 high, SampleRows* right) {
  const Band band{samples_below(low.y), samples_below(high.y)};
  if (band.low >= band.high) return {};
  if (std::fabs(high.x - low.x) <= high.y - low.y) {
    find_right_of_steep(low, high, band, right);
  } else {
    find_right_of_flat(low, high, band, right);
  }
  return band;
}

// Bounds on the winding numbers of a layer.
struct WindingRange {
  explicit WindingRange(const CellLayer& layer) : least(layer.base), most(layer.base) {
    for (const SideStep& step : layer.steps) add(step.winding);
    for (const StackArc& arc : layer.arcs) add(arc.winding);
  }
  void add(std::int64_t winding) { (winding < 0 ? least : most) += winding; }
  // Number of bits that distinguish all of them from 0.
  int bits() const {
    return static_cast<int>(
        std::bit_width(static_cast<std::uint64_t>(std::max(std::abs(least), std::abs(most)))));
  }

  std::int64_t least = 0;
  std::int64_t most = 0;
};

// Adds or subtracts one bit in the bit planes of winding numbers, two rows at a time, by ripple
// carry. The number of planes is kPlanes or, if that is 0, `count`.
template <bool kFalls, int kPlanes>
void add_to_planes(const SampleRows& added, int first, int end, SampleRows* planes,
                   std::size_t count) {
  using Rows = Vector<std::uint64_t, 2>;
  if (kPlanes > 0) count = kPlanes;
  for (int row = first; row < end; row += 2) {
    Rows carried;
    std::memcpy(&carried, added.data() + row, sizeof(carried));
    for (std::size_t plane = 0; plane < count; ++plane) {
      Rows old;
      std::memcpy(&old, planes[plane].data() + row, sizeof(old));
      const Rows sum = old ^ carried;
      std::memcpy(planes[plane].data() + row, &sum, sizeof(sum));
      carried = kFalls ? carried & ~old : carried & old;
    }
  }
}

// Adds one bit, of the weight of the first plane, in the rows of a band. May clear rows of `added`
// beside the band.
template <bool kFalls>
void add_bit(const SampleBits::Band& band, std::span<SampleRows> planes, SampleRows* added) {
  int first = band.first_row();
  int end = band.end_row();
  if (first % 2 != 0) (*added)[--first] = 0;
  if (end % 2 != 0) (*added)[end++] = 0;
  switch (planes.size()) {
    case 2:
      return add_to_planes<kFalls, 2>(*added, first, end, planes.data(), 2);
    case 3:
      return add_to_planes<kFalls, 3>(*added, first, end, planes.data(), 3);
    case 4:
      return add_to_planes<kFalls, 4>(*added, first, end, planes.data(), 4);
    case 5:
      return add_to_planes<kFalls, 5>(*added, first, end, planes.data(), 5);
    default:
      return add_to_planes<kFalls, 0>(*added, first, end, planes.data(), planes.size());
  }
}

}  // namespace

std::uint64_t SampleBits::Band::columns(int row) const {
  return kShiftedFrom[std::clamp(low - row * kSampleBitsSide, 0, kSampleBitsSide)] &
         ~kShiftedFrom[std::clamp(high - row * kSampleBitsSide, 0, kSampleBitsSide)];
}

// Calls use(low, high) for lines that approximate an arc.
template <typename Use>
void SampleBits::for_lines(const StackArc& arc, const Point2& center, const Use& use) const {
  if (arc.curve == StackArc::kLine) {
    use(arc.low, arc.high);
    return;
  }
  const StackCurve& curve = stack_arcs_.curve(arc);
  const ParametricCurve& whole = stack_arcs_.piece(curve).curve;
  // One line suffices if the arc's middle is closer to it than the spacing of samples.
  constexpr int kMaxLines = 8;
  const Point2 middle = whole.at(0.5 * (curve.t_begin + curve.t_end)) - center;
  const Point2 way = arc.high - arc.low;
  const double off = std::fabs(cross(way, middle - arc.low));
  if (off * 512.0 < std::max(std::fabs(way.x), way.y)) {
    use(arc.low, arc.high);
    return;
  }
  const bool rises = whole.at(curve.t_begin).y < whole.at(curve.t_end).y;
  Point2 low = arc.low;
  for (int i = 1; i <= kMaxLines; ++i) {
    const double share = static_cast<double>(rises ? i : kMaxLines - i) / kMaxLines;
    Point2 high = arc.high;
    if (i < kMaxLines) {
      high = whole.at(curve.t_begin + share * (curve.t_end - curve.t_begin)) - center;
      high.y = std::clamp(high.y, low.y, arc.high.y);
    }
    if (high.y > low.y) use(low, high);
    low = high;
  }
}

void SampleBits::fill_odd(const CellLayer& layer, const Point2& center) {
  filled_.fill(layer.base % 2 == 0 ? 0 : kSampleBitsAll);
  const auto flip = [this](const Band& band) {
    for (int row = band.first_row(); row < band.end_row(); ++row) filled_[row] ^= right_[row];
  };
  for (const SideStep& step : layer.steps) {
    if (step.winding % 2 == 0) continue;
    const Band above{samples_below(step.y), kCount};
    for (int row = above.first_row(); row < kSampleBitsSide; ++row)
      filled_[row] ^= above.columns(row);
  }
  for (const StackArc& arc : layer.arcs) {
    if (arc.winding % 2 == 0) continue;
    for_lines(arc, center,
              [&](Point2 low, Point2 high) { flip(find_right_of(low, high, &right_)); });
  }
}

void SampleBits::add_winding(const Band& band, std::int32_t winding) {
  auto remaining = static_cast<std::uint32_t>(std::abs(winding));
  for (std::size_t first = 0; remaining != 0; ++first, remaining >>= 1) {
    if ((remaining & 1) == 0) continue;
    const auto planes = std::span(planes_).subspan(first);
    if (winding < 0) {
      add_bit<true>(band, planes, &right_);
    } else {
      add_bit<false>(band, planes, &right_);
    }
  }
}

void SampleBits::fill_by_winding(const CellLayer& layer, const Point2& center, int bits) {
  planes_.resize(static_cast<std::size_t>(bits));
  for (SampleRows& plane : planes_) plane.fill(0);
  // The initial winding numbers follow the steps along the left side.
  std::int32_t winding = layer.base;
  Band band;
  const auto fill_to = [&](int end) {
    band.high = end;
    for (std::size_t plane = 0; plane < planes_.size(); ++plane) {
      if ((static_cast<std::uint64_t>(winding) >> plane & 1) == 0) continue;
      for (int row = band.first_row(); row < band.end_row(); ++row) {
        planes_[plane][row] |= band.columns(row);
      }
    }
    band.low = end;
  };
  for (const SideStep& step : layer.steps) {
    fill_to(samples_below(step.y));
    winding += step.winding;
  }
  fill_to(kCount);
  for (const StackArc& arc : layer.arcs) {
    for_lines(arc, center, [&](Point2 low, Point2 high) {
      add_winding(find_right_of(low, high, &right_), arc.winding);
    });
  }
  filled_.fill(0);
  for (const SampleRows& plane : planes_) {
    for (int row = 0; row < kSampleBitsSide; ++row) filled_[row] |= plane[row];
  }
}

const SampleRows& SampleBits::fill(const CellLayer& layer, const Point2& center) {
  const WindingRange range(layer);
  // If all winding numbers are -1, 0 or 1, both rules fill the odd ones.
  if (layer.fill_rule == FillRule::kEvenOdd || (range.least >= -1 && range.most <= 1)) {
    fill_odd(layer, center);
  } else {
    fill_by_winding(layer, center, range.bits());
  }
  return filled_;
}

}  // namespace prefilter
