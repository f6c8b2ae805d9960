// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/voxels/slits.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/parallel.h"
#include "prefilter/voxels/finest_cells.h"

namespace prefilter {
namespace {

constexpr float kSlitsHalf = 0.5F;
constexpr float kMaxSlitOccupancy = 0.65F;  // fuller cells stay
constexpr float kOpenedOccupancy = 0.495F;  // just empty
constexpr int kSide = 3;                    // cells per axis of a block
constexpr int kBlock = kSide * kSide * kSide;
constexpr int kCenterCell = kBlock / 2;
constexpr int kSamples = 4;  // samples per axis of a cell
constexpr int kRow = kSide * kSamples;
constexpr Vector3 kSampleOffset = {0.0271828, -0.0314159,
                                   0.0141421};  // offset from axis-aligned planes
constexpr std::int64_t kNecksPerTask = 4;

using Block = std::array<float, kBlock>;

constexpr std::array<int, 3> place_in_block(int i) {
  return {i % kSide, i / kSide % kSide, i / kSide / kSide};
}

// Number of axes along which two cells of a block differ; 4 if they do not touch.
int steps_between(int i, int j) {
  const auto a = place_in_block(i);
  const auto b = place_in_block(j);
  int steps = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const int step = std::abs(a[k] - b[k]);
    if (step > 1) return 4;
    steps += step;
  }
  return steps;
}

// Connected parts of flagged cells around a block's center: numbered from 1, or 0.
struct CellParts {
  std::array<int, kBlock> of{};
  int count = 0;
};

// Connected parts of the cells within `most_from_middle` steps of the block's center; cells within
// `most_between` steps are connected.
template <typename Has>
CellParts parts_around(int most_from_middle, int most_between, const Has& has) {
  CellParts parts;
  const auto counts = [&](int i) {
    return i != kCenterCell && has(i) && steps_between(i, kCenterCell) <= most_from_middle;
  };
  for (int first = 0; first < kBlock; ++first) {
    if (!counts(first) || parts.of[first] != 0) continue;
    std::vector<int> stack = {first};
    parts.of[first] = ++parts.count;
    while (!stack.empty()) {
      const int i = stack.back();
      stack.pop_back();
      for (int j = 0; j < kBlock; ++j) {
        if (!counts(j) || parts.of[j] != 0 || steps_between(i, j) > most_between) continue;
        parts.of[j] = parts.count;
        stack.push_back(j);
      }
    }
  }
  return parts;
}

Block block_at(const CellTree& cells, int depth, const LeafPlace& at) {
  Block block;
  for (int i = 0; i < kBlock; ++i) {
    const auto offset = place_in_block(i);
    LeafPlace place = at;
    for (std::size_t a = 0; a < 3; ++a) place[a] += offset[a] - 1;
    block[i] = occupancy_at(cells, depth, place);
  }
  return block;
}

// Whether the full cells at the faces of a cell form several parts without it; full cells at its
// edges connect them.
bool parts_full_faces(const CellTree& cells, int depth, const LeafPlace& at) {
  const auto is_full = [&](std::size_t axis, int step, std::size_t other, int other_step) {
    LeafPlace place = at;
    place[axis] += step;
    if (other != axis) place[other] += other_step;
    return occupancy_at(cells, depth, place) >= kSlitsHalf;
  };
  constexpr std::size_t kFaces = 6;
  const auto step_of = [](std::size_t face) { return face % 2 == 0 ? -1 : 1; };
  std::array<bool, kFaces> is_full_face;
  std::array<std::size_t, kFaces> part;
  std::size_t parts = 0;
  for (std::size_t f = 0; f < kFaces; ++f) {
    is_full_face[f] = is_full(f / 2, step_of(f), f / 2, 0);
    part[f] = f;
    parts += is_full_face[f] ? 1 : 0;
  }
  for (std::size_t f = 0; f < kFaces && parts > 1; ++f) {
    for (std::size_t g = f / 2 * 2 + 2; g < kFaces && parts > 1; ++g) {
      if (!is_full_face[f] || !is_full_face[g] || part[f] == part[g]) continue;
      if (!is_full(f / 2, step_of(f), g / 2, step_of(g))) continue;
      std::replace(part.begin(), part.end(), std::size_t{part[g]}, std::size_t{part[f]});
      --parts;
    }
  }
  return parts > 1;
}

// The parts of full cells at the faces of a block's center if only the center connects them, and
// the empty cells form one part; otherwise none. Full cells are connected by faces, empty ones by
// corners (G. Bertrand, Simple points, topological numbers and geodesic neighborhoods in cubic
// grids, 1994).
std::optional<CellParts> joined_by_center(const Block& block) {
  const CellParts full = parts_around(2, 1, [&](int i) { return block[i] >= kSlitsHalf; });
  std::uint32_t at_faces = 0;
  for (int i = 0; i < kBlock; ++i) {
    if (full.of[i] != 0 && steps_between(i, kCenterCell) == 1) at_faces |= 1U << full.of[i];
  }
  if ((at_faces & (at_faces - 1)) == 0) return {};
  const CellParts empty = parts_around(3, 3, [&](int i) { return block[i] < kSlitsHalf; });
  if (empty.count != 1) return {};
  return full;
}

// Tests whether the mesh itself connects the parts of full cells around a cell.
class Separation {
 public:
  Separation(const WindingNumbers& winding, double unit) : winding_(winding), unit_(unit) {}

  bool is_apart(const LeafPlace& at, const CellParts& full) const {
    std::vector<double> numbers(static_cast<std::size_t>(kRow) * kRow * kRow);
    const auto index = [](int x, int y, int z) {
      return (static_cast<std::size_t>(z) * kRow + y) * kRow + x;
    };
    for (int z = 0; z < kRow; ++z) {
      for (int y = 0; y < kRow; ++y) {
        for (int x = 0; x < kRow; ++x) {
          const std::array<int, 3> before = {x > 0 ? x - 1 : x, x > 0 || y == 0 ? y : y - 1,
                                             x > 0 || y > 0 || z == 0 ? z : z - 1};
          const Vector3 here = sample(at, {x, y, z});
          double& number = numbers[index(x, y, z)];
          if (x + y + z == 0) {
            number = winding_.at(here);
            continue;
          }
          const std::optional<double> excess = winding_.excess(here, sample(at, before));
          number = excess ? numbers[index(before[0], before[1], before[2])] + *excess
                          : winding_.at(here);
        }
      }
    }
    return !has_path(numbers, full);
  }

 private:
  Vector3 sample(const LeafPlace& at, const std::array<int, 3>& k) const {
    Vector3 point;
    for (std::size_t a = 0; a < 3; ++a) {
      point[a] = (at[a] - 1 + (k[a] + 0.5) / kSamples + kSampleOffset[a]) / unit_;
    }
    return point;
  }

  // Whether samples inside the mesh connect two of the parts.
  static bool has_path(const std::vector<double>& numbers, const CellParts& full) {
    constexpr std::array<int, 3> kSteps = {1, kRow, kRow * kRow};
    std::vector<std::uint8_t> is_seen(numbers.size(), 0);
    for (std::size_t first = 0; first < numbers.size(); ++first) {
      if (is_seen[first] != 0 || numbers[first] < 0.5) continue;
      std::uint32_t touched_parts = 0;
      std::vector<int> stack = {static_cast<int>(first)};
      is_seen[first] = 1;
      while (!stack.empty()) {
        const int i = stack.back();
        stack.pop_back();
        const std::array<int, 3> at = {i % kRow, i / kRow % kRow, i / kRow / kRow};
        const int cell = at[0] / kSamples + kSide * (at[1] / kSamples + kSide * (at[2] / kSamples));
        touched_parts |= 1U << full.of[cell];
        for (std::size_t a = 0; a < 3; ++a) {
          for (const int step : {-1, 1}) {
            if (at[a] + step < 0 || at[a] + step >= kRow) continue;
            const auto other = static_cast<std::size_t>(i + step * kSteps[a]);
            if (is_seen[other] != 0 || numbers[other] < 0.5) continue;
            is_seen[other] = 1;
            stack.push_back(static_cast<int>(other));
          }
        }
      }
      touched_parts &= ~1U;
      if ((touched_parts & (touched_parts - 1)) != 0) return true;
    }
    return false;
  }

  const WindingNumbers& winding_;
  double unit_;
};

struct Neck {
  LeafPlace at;
  float value;
  bool is_apart = false;
};

}  // namespace

void open_slits(const WindingNumbers& winding, double unit, const CellTree& thickened, int depth,
                const Run& run, CellTree* cells) {
  if (cells->depth() != depth || depth == 0) return;
  std::vector<Neck> necks;
  for_finest(*cells, [&](const LeafPlace& at, float value) {
    if (value < kSlitsHalf || value > kMaxSlitOccupancy || !parts_full_faces(*cells, depth, at))
      return;
    if (!thickened.levels.empty() && occupancy_at(thickened, depth, at) > 0.0F) return;
    if (joined_by_center(block_at(*cells, depth, at))) necks.push_back({at, value});
  });
  const Separation separation(winding, unit);
  const Stages stages(run, {9, 1});
  parallel_ranges(static_cast<std::int64_t>(necks.size()), kNecksPerTask, stages[0],
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto i = static_cast<std::size_t>(begin);
                         i < static_cast<std::size_t>(end); ++i) {
                      const auto full = joined_by_center(block_at(*cells, depth, necks[i].at));
                      necks[i].is_apart = full && separation.is_apart(necks[i].at, *full);
                    }
                  });
  std::erase_if(necks, [](const Neck& neck) { return !neck.is_apart; });
  std::stable_sort(necks.begin(), necks.end(),
                   [](const Neck& a, const Neck& b) { return a.value < b.value; });
  for (const Neck& neck : necks) {
    if (joined_by_center(block_at(*cells, depth, neck.at))) {
      set_leaf(neck.at, depth, kOpenedOccupancy, cells);
    }
  }
  if (!necks.empty()) update_means(cells, stages[1]);
}

}  // namespace prefilter
