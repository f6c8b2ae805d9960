// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/scan/joined_points.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/color/transfer.h"

namespace prefilter {
namespace {

constexpr float kWhiteByte = 255.0F;

enum class Kind { kValue, kAlpha, kColor };

Kind kind_of(const PointAttribute& attribute) {
  std::string_view name = attribute.name;
  name.remove_prefix(name.rfind('.') + 1);  // npos + 1 is 0
  if (name == "alpha") return Kind::kAlpha;
  return name == "red" || name == "green" || name == "blue" ? Kind::kColor : Kind::kValue;
}

float missing_value(const PointAttribute& attribute) {
  if (kind_of(attribute) == Kind::kValue) return 0.0F;
  return attribute.is_byte ? kWhiteByte : 1.0F;
}

// A value of a source as the cloud has it.
float converted(float value, bool is_byte, const PointAttribute& to) {
  const Kind kind = kind_of(to);
  if (is_byte == to.is_byte || kind == Kind::kValue) return value;
  if (is_byte) {
    const float share = value / kWhiteByte;
    return kind == Kind::kColor ? srgb_to_linear(share) : share;
  }
  return kWhiteByte * (kind == Kind::kColor ? linear_to_srgb(value) : value);
}

std::optional<std::size_t> place_of(const std::vector<PointAttribute>& attributes,
                                    const std::string& name) {
  const auto found = std::find_if(attributes.begin(), attributes.end(),
                                  [&](const PointAttribute& each) { return each.name == name; });
  if (found == attributes.end()) return std::nullopt;
  return static_cast<std::size_t>(found - attributes.begin());
}

}  // namespace

JoinedPoints::JoinedPoints(std::vector<PointSource*> sources)
    : sources_(std::move(sources)), end_(sources_.size()) {
  if (sources_.empty()) throw_invalid("sources: none; at least one is needed");
  for (const PointSource* source : sources_) {
    if (source->has_normals() != sources_.front()->has_normals()) {
      throw_invalid("sources: only some have normals; all or none is needed");
    }
    for (const PointAttribute& each : source->attributes()) {
      if (!place_of(attributes_, each.name)) attributes_.push_back(each);
    }
  }
  for (const PointSource* source : sources_) {
    std::vector<Column>& columns = columns_.emplace_back();
    for (const PointAttribute& each : attributes_) {
      const std::optional<std::size_t> from = place_of(source->attributes(), each.name);
      columns.push_back({from, from && source->attributes()[*from].is_byte});
    }
  }
}

std::optional<std::size_t> JoinedPoints::count() const {
  std::size_t sum = 0;
  for (std::size_t k = first_; k < end_; ++k) {
    const std::optional<std::size_t> count = sources_[k]->count();
    if (!count) return std::nullopt;
    sum += *count;
  }
  return sum;
}

bool JoinedPoints::is_double() const {
  return std::any_of(sources_.begin(), sources_.end(),
                     [](const PointSource* source) { return source->is_double(); });
}

void JoinedPoints::rewind() {
  for (PointSource* source : sources_) source->rewind();
  current_ = first_;
}

void JoinedPoints::choose(std::size_t source) {
  first_ = current_ = source;
  end_ = source + 1;
}

bool JoinedPoints::read(std::size_t most, PointBatch* batch) {
  for (; current_ < end_; ++current_) {
    PointSource* const source = sources_[current_];
    if (!source->read(most, batch)) continue;
    const std::size_t count = batch->positions.size();
    const std::optional<Vector3> viewpoint = source->viewpoint();
    if (viewpoint) batch->viewpoints.assign(count, *viewpoint);
    batch->attributes = carried(batch->attributes, count);
    batch->cloud = current_;
    return true;
  }
  return false;
}

std::vector<float> JoinedPoints::carried(const std::vector<float>& values,
                                         std::size_t points) const {
  const std::vector<Column>& columns = columns_[current_];
  const std::size_t width = sources_[current_]->attributes().size();
  std::vector<float> result(points * columns.size());
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Column& column = columns[k];
    const float missing = missing_value(attributes_[k]);
    for (std::size_t i = 0; i < points; ++i) {
      result[i * columns.size() + k] =
          column.from ? converted(values[i * width + *column.from], column.is_byte, attributes_[k])
                      : missing;
    }
  }
  return result;
}

}  // namespace prefilter
