// SPDX-License-Identifier: GPL-3.0-or-later

// Modes T and H (Khronos Data Format 1.3, sections 21.1.3 and 21.1.4): orders the texels along the
// line between the two farthest apart, tries all splits into two groups, and for each distance
// refines the two colors to fit the assignment of texels.
#include <algorithm>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "prefilter/textures/blocks/etc2_search.h"

namespace prefilter {
namespace {

constexpr int kDistances[] = {3, 6, 11, 16, 23, 32, 41, 64};
constexpr int kMaxChannel4Bits = 15;
constexpr int kMaxPaintRounds = 3;
constexpr std::size_t kEtc2PaintsTexels = EtcTexels::kCount;

/// The color of a texel: one of the two base colors, plus some distances.
struct Paint {
  std::size_t color;
  int steps;
};
constexpr Paint kOfT[] = {{0, 0}, {1, 1}, {1, 0}, {1, -1}};
constexpr Paint kOfH[] = {{0, 1}, {0, -1}, {1, 1}, {1, -1}};

struct Painting {
  bool is_h = false;
  std::array<EtcColor, 2> colors{};
  int distance = 0;
  std::array<int, kEtc2PaintsTexels> indices{};
  int error = kLargestError + 1;

  const Paint& paint(int index) const { return (is_h ? kOfH : kOfT)[index]; }
};

/// Assigns each texel the closest of the four colors, until the error exceeds the limit.
void assign_texels(const EtcTexels& texels, int limit, Painting* painting) {
  std::array<EtcColor, 4> paints{};
  for (int i = 0; i < 4; ++i) {
    const Paint& paint = painting->paint(i);
    for (std::size_t c = 0; c < 3; ++c) {
      const int color = 17 * painting->colors[paint.color][c];
      const int step = paint.steps * kDistances[painting->distance];
      paints[static_cast<std::size_t>(i)][c] = std::clamp(color + step, 0, 255);
    }
  }
  painting->error = 0;
  for (std::size_t t = 0; t < kEtc2PaintsTexels && painting->error <= limit; ++t) {
    int least = std::numeric_limits<int>::max();
    for (std::size_t i = 0; i < 4; ++i) {
      const EtcColor& texel = texels.colors[t];
      const int error = square(paints[i][0] - texel[0]) + square(paints[i][1] - texel[1]) +
                        square(paints[i][2] - texel[2]);
      if (error >= least) continue;
      least = error;
      painting->indices[t] = static_cast<int>(i);
    }
    painting->error += texels.weights[t] * least;
  }
}

/// The colors that fit the assignment; a color without texels does not change.
std::array<EtcColor, 2> colors_for(const EtcTexels& texels, const Painting& painting) {
  std::array<EtcColor, 2> sums{};
  std::array<int, 2> counts{};
  for (std::size_t t = 0; t < kEtc2PaintsTexels; ++t) {
    const Paint& paint = painting.paint(painting.indices[t]);
    counts[paint.color] += texels.weights[t];
    for (std::size_t c = 0; c < 3; ++c) {
      const int step = paint.steps * kDistances[painting.distance];
      sums[paint.color][c] += texels.weights[t] * (texels.colors[t][c] - step);
    }
  }
  std::array<EtcColor, 2> colors = painting.colors;
  for (std::size_t i = 0; i < 2; ++i) {
    if (counts[i] == 0) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const int whole = 255 * counts[i];
      colors[i][c] =
          (2 * std::clamp(sums[i][c], 0, whole) * kMaxChannel4Bits + whole) / (2 * whole);
    }
  }
  return colors;
}

void refine_fit(const EtcTexels& texels, int limit, Painting* painting) {
  assign_texels(texels, limit, painting);
  if (painting->error > limit) return;
  for (int round = 1; round < kMaxPaintRounds; ++round) {
    Painting next = *painting;
    next.colors = colors_for(texels, *painting);
    if (next.colors == painting->colors) return;
    assign_texels(texels, painting->error, &next);
    if (next.error >= painting->error) return;
    *painting = next;
  }
}

/// The texels inside the image, ordered by their positions along the line.
std::vector<std::size_t> texels_along_line(const EtcTexels& texels) {
  std::vector<std::size_t> inside;
  for (std::size_t t = 0; t < kEtc2PaintsTexels; ++t) {
    if (texels.weights[t] != 0) inside.push_back(t);
  }
  EtcColor along{};
  int farthest = 0;
  for (const std::size_t one : inside) {
    for (const std::size_t other : inside) {
      EtcColor way{};
      for (std::size_t c = 0; c < 3; ++c) way[c] = texels.colors[other][c] - texels.colors[one][c];
      const int distance = square(way[0]) + square(way[1]) + square(way[2]);
      if (distance <= farthest) continue;
      farthest = distance;
      along = way;
    }
  }
  const auto position = [&](std::size_t texel) {
    const EtcColor& color = texels.colors[texel];
    return std::inner_product(color.begin(), color.end(), along.begin(), 0);
  };
  std::stable_sort(inside.begin(), inside.end(), [&](std::size_t one, std::size_t other) {
    return position(one) < position(other);
  });
  return inside;
}

EtcColor mean_of(const EtcTexels& texels, std::span<const std::size_t> some) {
  EtcColor mean{};
  for (std::size_t c = 0; c < 3; ++c) {
    int sum = 0;
    for (const std::size_t texel : some) sum += texels.colors[texel][c];
    const int whole = 255 * static_cast<int>(some.size());
    mean[c] = (2 * sum * kMaxChannel4Bits + whole) / (2 * whole);
  }
  return mean;
}

std::uint64_t packed_t(const Painting& painting) {
  const auto at = [](int value, int position) {
    return static_cast<std::uint64_t>(value) << position;
  };
  const auto& [first, second] = painting.colors;
  const OverflowBits leaving = overflow_bits(first[0] >> 2, first[0] & 3);
  std::uint64_t bits = leaving.upper << 61 | at(first[0] >> 2, 59) | leaving.sign << 58;
  bits |= at(first[0] & 3, 56) | at(first[1], 52) | at(first[2], 48);
  bits |= at(second[0], 44) | at(second[1], 40) | at(second[2], 36);
  return bits | at(painting.distance >> 1, 34) | at(1, 33) | at(painting.distance & 1, 32);
}

int number_of(const EtcColor& color) { return color[0] << 8 | color[1] << 4 | color[2]; }

/// The lowest bit of the distance is encoded as the order of the colors.
std::uint64_t packed_h(const Painting& painting) {
  const auto at = [](int value, int position) {
    return static_cast<std::uint64_t>(value) << position;
  };
  const auto& [first, second] = painting.colors;
  const OverflowBits leaving =
      overflow_bits((first[1] & 1) << 1 | first[2] >> 3, first[2] >> 1 & 3);
  std::uint64_t bits = bit_within(first[0], first[1] >> 1) << 63 | at(first[0], 59);
  bits |= at(first[1] >> 1, 56) | leaving.upper << 53 | at(first[1] & 1, 52);
  bits |= at(first[2] >> 3, 51) | leaving.sign << 50 | at(first[2] & 7, 47);
  bits |= at(second[0], 43) | at(second[1], 39) | at(second[2], 35);
  return bits | at(painting.distance >> 2, 34) | at(1, 33) | at(painting.distance >> 1 & 1, 32);
}

/// Orders the colors of H as their distance requires; false if that is impossible because they are
/// equal.
bool order_colors(Painting* painting) {
  const bool is_descending = number_of(painting->colors[0]) >= number_of(painting->colors[1]);
  if (is_descending == ((painting->distance & 1) != 0)) return true;
  if (painting->colors[0] == painting->colors[1]) return false;
  std::swap(painting->colors[0], painting->colors[1]);
  for (int& index : painting->indices) index ^= 2;
  return true;
}

EtcBlock packed(Painting painting) {
  constexpr EtcBlock kNone{0, kLargestError + 1};
  if (painting.is_h && !order_colors(&painting)) return kNone;
  std::uint64_t bits = painting.is_h ? packed_h(painting) : packed_t(painting);
  for (std::size_t t = 0; t < kEtc2PaintsTexels; ++t) {
    const auto index = static_cast<std::uint64_t>(painting.indices[t]);
    bits |= (index >> 1) << (16 + t) | (index & 1) << t;
  }
  return {bits, painting.error};
}

}  // namespace

EtcBlock search_etc_paints(const EtcTexels& texels) {
  EtcBlock best{0, kLargestError + 1};
  const std::vector<std::size_t> order = texels_along_line(texels);
  const std::span<const std::size_t> all(order);
  for (std::size_t split = 1; split < order.size(); ++split) {
    const EtcColor low = mean_of(texels, all.first(split));
    const EtcColor high = mean_of(texels, all.subspan(split));
    for (int distance = 0; distance < 8; ++distance) {
      for (int kind = 0; kind < 3; ++kind) {
        Painting painting;
        painting.is_h = kind == 2;
        painting.colors = {kind == 1 ? high : low, kind == 1 ? low : high};
        painting.distance = distance;
        refine_fit(texels, max_initial_error(best.error), &painting);
        if (painting.error < best.error) best = closer(best, packed(painting));
      }
    }
  }
  return best;
}

}  // namespace prefilter
