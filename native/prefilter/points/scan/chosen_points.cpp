// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/points/chosen_points.h"

#include <algorithm>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

std::size_t place_of(const PointSource& source, const std::string& attribute,
                     const std::string& option, const std::string& name) {
  const std::vector<PointAttribute>& all = source.attributes();
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const PointAttribute& each) { return each.name == attribute; });
  if (found == all.end()) {
    throw_invalid(option + ": points of " + name + " have no '" + attribute + "'");
  }
  return static_cast<std::size_t>(found - all.begin());
}

bool holds(const Box& box, const Vector3& point) {
  for (int a = 0; a < 3; ++a) {
    if (!(point[a] >= box.low[a] && point[a] <= box.high[a])) return false;
  }
  return true;
}

// Leaves of rows of `width` values those whose points are kept.
template <typename T>
void keep(const std::vector<bool>& is_kept, std::size_t width, std::vector<T>* values) {
  if (values->empty()) return;
  std::size_t to = 0;
  for (std::size_t i = 0; i < is_kept.size(); ++i) {
    if (!is_kept[i]) continue;
    for (std::size_t k = 0; k < width; ++k) (*values)[to++] = (*values)[i * width + k];
  }
  values->resize(to);
}

}  // namespace

void keep_points(const std::vector<bool>& is_kept, std::size_t attribute_count, PointBatch* batch) {
  keep(is_kept, 1, &batch->positions);
  keep(is_kept, 1, &batch->normals);
  keep(is_kept, 1, &batch->weights);
  keep(is_kept, 1, &batch->viewpoints);
  keep(is_kept, attribute_count, &batch->attributes);
}

ChosenPoints::ChosenPoints(PointSource* source, const PointChoice& choice, const std::string& name)
    : ChangedPoints(source), choice_(choice) {
  if (choice_.classes) class_ = place_of(*source_, "classification", "classes", name);
  if (choice_.returns == Returns::kAll) return;
  if (choice_.returns != Returns::kOnly) {
    number_ = place_of(*source_, "return_number", "returns", name);
  }
  if (choice_.returns != Returns::kFirst) {
    of_ = place_of(*source_, "number_of_returns", "returns", name);
  }
}

bool ChosenPoints::is_chosen(const PointBatch& batch, std::size_t point) const {
  if (choice_.box && !holds(*choice_.box, batch.positions[point])) return false;
  if (!choice_.classes && choice_.returns == Returns::kAll) return true;
  const float* const values = batch.attributes.data() + point * source_->attributes().size();
  if (choice_.classes) {
    const float found = values[class_];
    const bool is_class = found >= 0.0F && found < static_cast<float>(PointChoice::kClasses);
    if (!is_class || !(*choice_.classes)[static_cast<std::size_t>(found)]) return false;
  }
  const float number = std::max(values[number_], 1.0F);
  const float of = std::max(values[of_], 1.0F);
  switch (choice_.returns) {
    case Returns::kFirst:
      return number == 1.0F;
    case Returns::kLast:
      return number >= of;
    case Returns::kOnly:
      return of == 1.0F;
    case Returns::kAll:
      break;
  }
  return true;
}

bool ChosenPoints::read(std::size_t most, PointBatch* batch) {
  if (!source_->read(most, batch)) return false;
  std::vector<bool> is_kept(batch->positions.size());
  for (std::size_t i = 0; i < is_kept.size(); ++i) is_kept[i] = is_chosen(*batch, i);
  keep_points(is_kept, source_->attributes().size(), batch);
  // Also where none is left, so that whoever reads can be told to stop.
  return true;
}

}  // namespace prefilter
