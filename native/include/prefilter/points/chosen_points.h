// SPDX-License-Identifier: GPL-3.0-or-later

// Some points of a source: of a box, of some classes, of some returns.
#pragma once

#include <bitset>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "prefilter/base/geometry.h"
#include "prefilter/base/names.h"
#include "prefilter/points/point_source.h"

namespace prefilter {

/// Of the echoes of one pulse of a scanner, which may pass leaves on its way to the ground.
enum class Returns { kAll, kFirst, kLast, kOnly };

inline constexpr Named<Returns> kReturnsNames[] = {
    {"all", Returns::kAll},
    {"first", Returns::kFirst},
    {"last", Returns::kLast},
    {"only", Returns::kOnly},
};

/// What points have to be. A number of 0, which files have for points without returns, counts as 1.
struct PointChoice {
  static constexpr std::size_t kClasses = 256;

  std::optional<Box> box;  // its sides belong to it
  std::optional<std::bitset<kClasses>> classes;
  Returns returns = Returns::kAll;
};

/// The points of a source that a choice has.
class ChosenPoints final : public ChangedPoints {
 public:
  /// `name` is what messages call the source. Throws Error where a choice asks for classes or
  /// returns, and the source has no "classification", or no "return_number" (and, but for the
  /// first, "number_of_returns").
  ChosenPoints(PointSource* source, const PointChoice& choice, const std::string& name);

  std::optional<std::size_t> count() const override { return std::nullopt; }
  bool read(std::size_t most, PointBatch* batch) override;

 private:
  bool is_chosen(const PointBatch& batch, std::size_t point) const;

  PointChoice choice_;
  std::size_t class_ = 0;  // places of attributes
  std::size_t number_ = 0;
  std::size_t of_ = 0;
};

}  // namespace prefilter
