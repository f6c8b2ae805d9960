// A table's texels as places in memory, for all cells of a pyramid.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "prefilter/base/lanes.h"
#include "prefilter/sampling/pairs.h"
#include "prefilter/sampling/pyramid.h"
#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// The symmetries of a cell: mirrored along x (1), along y (2), and before that swapped (4).
inline constexpr int kSymmetries = 8;

/// What samples in cells of one level are made of.
struct PlannedCells {
  int available = 0;   // levels, see TableSection
  bool nests = false;  // whether a cell is 2 x 2 and 4 x 4 texels of the levels below it
  // Of the cells' level and of the ones below it, as far as there are any, else of the last one:
  std::array<Pair, 3> sizes{};    // texels
  std::array<Pair, 3> pitches{};  // from one texel to the next, and from row to row [bytes]
  std::array<std::uintptr_t, 3> texels{};
  // Cells from `low` to `high`, both included, read no texel outside of its level.
  Pair low{};
  Pair high{};
  const float* weights = nullptr;         // see SectionPlan
  const std::uint8_t* finer = nullptr;    // likewise
  const std::int32_t* offsets = nullptr;  // [subdomain][symmetry][texel]: from the cell's low
                                          // corner in the texel's level [bytes]
};

/// All that a sampler looks up in a table, in the order in which it is needed. There are so many
/// texels that vectors of four hold them; those beyond the table's weigh nothing.
class TexelPlan {
 public:
  TexelPlan(const Pyramid& pyramid, const SamplingTable& table);
  TexelPlan(const TexelPlan&) = delete;
  TexelPlan& operator=(const TexelPlan&) = delete;

  const TableShape& shape() const { return shape_; }
  int padded_texels() const { return padded_; }
  const PlannedCells& cells(int level) const { return cells_[level]; }
  const PlannedCells* cells() const { return cells_.data(); }

 private:
  struct SectionPlan {
    std::vector<Lanes> weights;       // [subdomain][term][texel]; bytes' are those of their value
    std::vector<std::uint8_t> finer;  // [subdomain][texel]
  };

  void plan_section(const TableSection& section, float unit, SectionPlan& plan) const;
  PlannedCells plan_cells(const Pyramid& pyramid, const SamplingTable& table, int level);

  TableShape shape_;
  int padded_;
  std::array<SectionPlan, 3> sections_;  // by available levels - 1
  std::vector<std::vector<std::int32_t>> offsets_;
  std::vector<PlannedCells> cells_;  // by level
};

}  // namespace prefilter
