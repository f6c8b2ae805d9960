// SPDX-License-Identifier: GPL-3.0-or-later

// Filters batches by position and by the LAS attributes of classes and returns.
#include "prefilter/points/chosen_points.h"

#include <algorithm>

#include "prefilter/base/error.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {
namespace {

std::size_t required_attribute(const PointSource& source, const std::string& attribute,
                               const std::string& option, const std::string& name) {
  const auto index = attribute_index(source.attributes(), attribute);
  if (!index) {
    throw_invalid(option + ": points of " + name + " have no '" + attribute + "'");
  }
  return *index;
}

bool holds(const Box& box, const Vector3& point) {
  for (int a = 0; a < 3; ++a) {
    if (!(point[a] >= box.low[a] && point[a] <= box.high[a])) return false;
  }
  return true;
}

// Removes rows of `width` values whose points are not kept.
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
  if (choice_.classes)
    class_attribute_ = required_attribute(*source_, "classification", "classes", name);
  if (choice_.returns == Returns::kAll) return;
  if (choice_.returns != Returns::kOnly) {
    return_number_attribute_ = required_attribute(*source_, "return_number", "returns", name);
  }
  if (choice_.returns != Returns::kFirst) {
    number_of_returns_attribute_ =
        required_attribute(*source_, "number_of_returns", "returns", name);
  }
}

bool ChosenPoints::is_chosen(const PointBatch& batch, std::size_t point) const {
  if (choice_.box && !holds(*choice_.box, batch.positions[point])) return false;
  if (!choice_.classes && choice_.returns == Returns::kAll) return true;
  const float* const values = batch.attributes.data() + point * source_->attributes().size();
  if (choice_.classes) {
    const float point_class = values[class_attribute_];
    const bool is_class =
        point_class >= 0.0F && point_class < static_cast<float>(PointChoice::kClasses);
    if (!is_class || !(*choice_.classes)[static_cast<std::size_t>(point_class)]) return false;
  }
  const float number = std::max(values[return_number_attribute_], 1.0F);
  const float of = std::max(values[number_of_returns_attribute_], 1.0F);
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
  // Returns even an empty batch, so that the reader can check for cancellation.
  return true;
}

}  // namespace prefilter
