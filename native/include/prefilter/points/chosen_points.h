// SPDX-License-Identifier: GPL-3.0-or-later

// Selects points of a source by a box, classes, and returns.
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

/// Which of the returns (echoes) of a laser cancel_check to keep. A cancel_check may pass leaves on
/// its way to the ground.
enum class Returns { kAll, kFirst, kLast, kOnly };

inline constexpr Named<Returns> kReturnsNames[] = {
    {"all", Returns::kAll},
    {"first", Returns::kFirst},
    {"last", Returns::kLast},
    {"only", Returns::kOnly},
};

/// Selection of points. A return number of 0, used for points without returns, counts as 1.
struct PointChoice {
  static constexpr std::size_t kClasses = 256;

  std::optional<Box> box;  // closed: includes its boundary
  std::optional<std::bitset<kClasses>> classes;
  Returns returns = Returns::kAll;
};

/// The points of a source that match a choice.
class ChosenPoints final : public ChangedPoints {
 public:
  /// `name` is the source's name in messages. Throws Error if the choice needs classes or returns,
  /// and the source has no attribute "classification", "return_number" or, except for kFirst,
  /// "number_of_returns".
  ChosenPoints(PointSource* source, const PointChoice& choice, const std::string& name);

  std::optional<std::size_t> count() const override { return std::nullopt; }
  bool read(std::size_t most, PointBatch* batch) override;

 private:
  bool is_chosen(const PointBatch& batch, std::size_t point) const;

  PointChoice choice_;
  std::size_t class_attribute_ = 0;  // attribute indices
  std::size_t return_number_attribute_ = 0;
  std::size_t number_of_returns_attribute_ = 0;
};

}  // namespace prefilter
