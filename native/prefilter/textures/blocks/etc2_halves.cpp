// SPDX-License-Identifier: GPL-3.0-or-later

// Individual and differential mode (Khronos Data Format 1.3, section 21.1). For each table and
// several initial colors: assign each texel the closest of four modifiers, fit the base color to
// the assignment, and repeat until it is stable.
#include <algorithm>
#include <limits>

#include "prefilter/textures/blocks/etc2_search.h"

namespace prefilter {
namespace {

constexpr int kTables = 8;
constexpr int kModifiers[kTables][4] = {
    {2, 8, -2, -8},     {5, 17, -5, -17},   {9, 29, -9, -29},     {13, 42, -13, -42},
    {18, 60, -18, -60}, {24, 80, -24, -80}, {33, 106, -33, -106}, {47, 183, -47, -183}};
constexpr int kHalf = EtcTexels::kCount / 2;
constexpr int kMaxHalfRounds = 4;
constexpr int kIndividualBits = 4, kDifferentialBits = 5;
constexpr int kLeastStep = -4, kGreatestStep = 3;

struct Bounds {
  EtcColor low, high;
};

struct HalfFit {
  EtcColor base{};
  int table = 0;
  std::array<int, kHalf> indices{};
  int error = kLargestError + 1;
};

int expand_halves(int value, int bits) {
  return bits == kIndividualBits ? value * 17 : value << 3 | value >> 2;
}

class Half {
 public:
  Half(const EtcTexels& texels, bool is_flipped, int which) {
    std::size_t count = 0;
    for (int t = 0; t < EtcTexels::kCount; ++t) {
      const int along = is_flipped ? t % 4 : t / 4;
      if (along / 2 != which) continue;
      const auto at = static_cast<std::size_t>(t);
      colors_[count] = texels.colors[at];
      weights_[count] = texels.weights[at];
      total_ += texels.weights[at];
      places_[count++] = t;
    }
  }

  int place(std::size_t texel) const { return places_[texel]; }

  HalfFit fit(int bits, const Bounds& bounds) const {
    HalfFit best;
    for (int table = 0; table < kTables; ++table) {
      const int middle = (kModifiers[table][0] + kModifiers[table][1]) / 2;
      for (const int shift : {0, -middle, middle}) {
        HalfFit start;
        start.table = table;
        start.indices.fill(-1);
        start.base = base_for(start, shift, bits, bounds);
        refine_fit(&start, bits, bounds, max_initial_error(best.error));
        if (start.error < best.error) best = start;
      }
    }
    descend(&best, bits, bounds);
    return best;
  }

  HalfFit fit(int bits) const {
    const int most = (1 << bits) - 1;
    return fit(bits, {{0, 0, 0}, {most, most, most}});
  }

 private:
  /// Assigns each texel the closest of the four colors, until the error exceeds the limit.
  void assign_texels(HalfFit* fit, int bits, int limit) const {
    fit->error = 0;
    for (std::size_t t = 0; t < kHalf && fit->error <= limit; ++t) {
      int least = std::numeric_limits<int>::max();
      for (int i = 0; i < 4; ++i) {
        int error = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const int color = expand_halves(fit->base[c], bits) + kModifiers[fit->table][i];
          error += square(std::clamp(color, 0, 255) - colors_[t][c]);
        }
        if (error >= least) continue;
        least = error;
        fit->indices[t] = i;
      }
      fit->error += weights_[t] * least;
    }
  }

  /// Mean of the texels minus their modifiers. `shift` is used as the modifier without an
  /// assignment.
  EtcColor base_for(const HalfFit& fit, int shift, int bits, const Bounds& bounds) const {
    EtcColor base{};
    const int most = (1 << bits) - 1;
    for (std::size_t c = 0; c < 3; ++c) {
      int sum = 0;
      for (std::size_t t = 0; t < kHalf; ++t) {
        const int index = fit.indices[t];
        const int modifier = index < 0 ? shift : kModifiers[fit.table][index];
        sum += weights_[t] * (colors_[t][c] - modifier);
      }
      const int whole = 255 * std::max(total_, 1);
      const int rounded = (2 * std::clamp(sum, 0, whole) * most + whole) / (2 * whole);
      base[c] = std::clamp(rounded, bounds.low[c], bounds.high[c]);
    }
    return base;
  }

  void refine_fit(HalfFit* fit, int bits, const Bounds& bounds, int limit) const {
    assign_texels(fit, bits, limit);
    if (fit->error > limit) return;
    for (int round = 1; round < kMaxHalfRounds; ++round) {
      HalfFit next = *fit;
      next.base = base_for(*fit, 0, bits, bounds);
      if (next.base == fit->base) return;
      assign_texels(&next, bits, fit->error);
      if (next.error >= fit->error) return;
      *fit = next;
    }
  }

  /// Tries the neighbors of the base color until none is better.
  void descend(HalfFit* fit, int bits, const Bounds& bounds) const {
    for (bool is_better = true; is_better;) {
      is_better = false;
      const EtcColor middle = fit->base;
      for (int neighbor = 0; neighbor < 27; ++neighbor) {
        HalfFit next = *fit;
        next.base = {middle[0] + neighbor / 9 - 1, middle[1] + neighbor / 3 % 3 - 1,
                     middle[2] + neighbor % 3 - 1};
        bool is_allowed = true;
        for (std::size_t c = 0; c < 3; ++c) {
          is_allowed &= next.base[c] >= bounds.low[c] && next.base[c] <= bounds.high[c];
        }
        if (!is_allowed) continue;
        assign_texels(&next, bits, fit->error);
        if (next.error >= fit->error) continue;
        *fit = next;
        is_better = true;
      }
    }
  }

  std::array<EtcColor, kHalf> colors_{};
  std::array<int, kHalf> weights_{};
  std::array<int, kHalf> places_{};
  int total_ = 0;
};

/// The base colors that differential mode can combine with another one.
Bounds bounds_around(const EtcColor& base, int least, int greatest) {
  constexpr int kMaxBase = (1 << kDifferentialBits) - 1;
  Bounds bounds{};
  for (std::size_t c = 0; c < 3; ++c) {
    bounds.low[c] = std::max(base[c] + least, 0);
    bounds.high[c] = std::min(base[c] + greatest, kMaxBase);
  }
  return bounds;
}

bool fit_differential_range(const HalfFit& first, const HalfFit& second) {
  for (std::size_t c = 0; c < 3; ++c) {
    const int step = second.base[c] - first.base[c];
    if (step < kLeastStep || step > kGreatestStep) return false;
  }
  return true;
}

struct Pair {
  HalfFit first, second;
  int error() const { return first.error + second.error; }
};

Pair differential(const Half& one, const Half& other) {
  const Pair free{one.fit(kDifferentialBits), other.fit(kDifferentialBits)};
  if (fit_differential_range(free.first, free.second)) return free;
  Pair by_first = free;
  by_first.second =
      other.fit(kDifferentialBits, bounds_around(free.first.base, kLeastStep, kGreatestStep));
  Pair by_second = free;
  by_second.first =
      one.fit(kDifferentialBits, bounds_around(free.second.base, -kGreatestStep, -kLeastStep));
  return by_second.error() < by_first.error() ? by_second : by_first;
}

std::uint64_t packed(const Pair& pair, const Half& one, const Half& other, bool is_differential,
                     bool is_flipped) {
  std::uint64_t bits = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const auto first = static_cast<std::uint64_t>(pair.first.base[c]);
    const auto second = static_cast<std::uint64_t>(pair.second.base[c]);
    const std::uint64_t both =
        is_differential ? first << 3 | ((second - first) & 7) : first << 4 | second;
    bits |= both << (56 - 8 * c);
  }
  bits |= static_cast<std::uint64_t>(pair.first.table) << 37;
  bits |= static_cast<std::uint64_t>(pair.second.table) << 34;
  bits |= static_cast<std::uint64_t>(is_differential) << 33;
  bits |= static_cast<std::uint64_t>(is_flipped) << 32;
  const auto add = [&](const Half& half, const HalfFit& fit) {
    for (std::size_t t = 0; t < kHalf; ++t) {
      const auto index = static_cast<std::uint64_t>(fit.indices[t]);
      bits |= (index >> 1) << (16 + half.place(t)) | (index & 1) << half.place(t);
    }
  };
  add(one, pair.first);
  add(other, pair.second);
  return bits;
}

}  // namespace

EtcBlock search_etc_halves(const EtcTexels& texels) {
  EtcBlock best{0, kLargestError + 1};
  for (const bool is_flipped : {false, true}) {
    const Half one(texels, is_flipped, 0);
    const Half other(texels, is_flipped, 1);
    const Pair individual{one.fit(kIndividualBits), other.fit(kIndividualBits)};
    const Pair steps = differential(one, other);
    best = closer(best, {packed(individual, one, other, false, is_flipped), individual.error()});
    best = closer(best, {packed(steps, one, other, true, is_flipped), steps.error()});
  }
  return best;
}

}  // namespace prefilter
