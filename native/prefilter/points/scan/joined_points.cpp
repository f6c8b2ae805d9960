// SPDX-License-Identifier: GPL-3.0-or-later

// Concatenates sources, and maps their attributes by name.
#include "prefilter/points/joined_points.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/images/transfer.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {
namespace {

constexpr float kWhiteByte = 255.0F;

enum class AttributeKind { kValue, kAlpha, kColor };

AttributeKind kind_of(const PointAttribute& attribute) {
  std::string_view name = attribute.name;
  name.remove_prefix(name.rfind('.') + 1);  // npos + 1 is 0
  if (name == "alpha") return AttributeKind::kAlpha;
  return name == "red" || name == "green" || name == "blue" ? AttributeKind::kColor
                                                            : AttributeKind::kValue;
}

float missing_value(const PointAttribute& attribute) {
  if (kind_of(attribute) == AttributeKind::kValue) return 0.0F;
  return attribute.is_byte ? kWhiteByte : 1.0F;
}

// Converts a source's value to the cloud's representation.
float converted(float value, bool is_byte, const PointAttribute& to) {
  const AttributeKind kind = kind_of(to);
  if (is_byte == to.is_byte || kind == AttributeKind::kValue) return value;
  if (is_byte) {
    const float share = value / kWhiteByte;
    return kind == AttributeKind::kColor ? srgb_to_linear(share) : share;
  }
  return kWhiteByte * (kind == AttributeKind::kColor ? linear_to_srgb(value) : value);
}

}  // namespace

JoinedPoints::JoinedPoints(std::vector<PointSource*> sources, std::size_t rows_a_share)
    : sources_(std::move(sources)) {
  if (sources_.empty()) throw_invalid("sources: none; at least one is needed");
  for (const PointSource* source : sources_) {
    if (source->has_normals() != sources_.front()->has_normals()) {
      throw_invalid("sources: only some have normals; all or none is needed");
    }
    for (const PointAttribute& each : source->attributes()) {
      if (!attribute_index(attributes_, each.name)) attributes_.push_back(each);
    }
  }
  for (const PointSource* source : sources_) {
    std::vector<Column>& columns = columns_.emplace_back();
    for (const PointAttribute& each : attributes_) {
      const std::optional<std::size_t> from = attribute_index(source->attributes(), each.name);
      columns.push_back({from, from && source->attributes()[*from].is_byte});
    }
  }
  for (std::size_t k = 0; k < sources_.size(); ++k) add_shares(k, rows_a_share);
  end_ = shares_.size();
}

void JoinedPoints::add_shares(std::size_t source, std::size_t rows_a_share) {
  const std::size_t rows = sources_[source]->rows().value_or(0);
  if (rows <= rows_a_share) {
    shares_.push_back({source, 0, std::nullopt});
    return;
  }
  for (std::size_t begin = 0; begin < rows; begin += rows_a_share) {
    shares_.push_back({source, begin, begin + std::min(rows_a_share, rows - begin)});
  }
}

std::optional<std::size_t> JoinedPoints::count() const {
  std::size_t sum = 0;
  for (std::size_t k = first_; k < end_; ++k) {
    const Share& share = shares_[k];
    const std::optional<std::size_t> count = sources_[share.source]->count();
    if (!count) return std::nullopt;
    sum += share.end ? *share.end - share.begin : *count;
  }
  return sum;
}

bool JoinedPoints::is_double() const {
  return std::any_of(sources_.begin(), sources_.end(),
                     [](const PointSource* source) { return source->is_double(); });
}

std::vector<std::string> JoinedPoints::warnings() const {
  std::vector<std::string> all;
  for (const PointSource* source : sources_) {
    const std::vector<std::string> own = source->warnings();
    all.insert(all.end(), own.begin(), own.end());
  }
  return all;
}

void JoinedPoints::rewind() {
  current_ = first_;
  is_begun_ = false;
}

void JoinedPoints::choose_share(std::size_t share) {
  first_ = share;
  end_ = share + 1;
  rewind();
}

void JoinedPoints::begin(const Share& share) {
  PointSource* const source = sources_[share.source];
  if (share.end) {
    source->choose_rows(share.begin, *share.end);
  } else {
    source->rewind();
  }
}

bool JoinedPoints::read(std::size_t most, PointBatch* batch) {
  for (; current_ < end_; ++current_, is_begun_ = false) {
    const Share& share = shares_[current_];
    if (!std::exchange(is_begun_, true)) begin(share);
    PointSource* const source = sources_[share.source];
    if (!source->read(most, batch)) continue;
    const std::size_t count = batch->positions.size();
    const std::optional<Vector3> viewpoint = source->viewpoint();
    if (viewpoint) batch->viewpoints.assign(count, *viewpoint);
    batch->attributes = convert_attributes(share.source, batch->attributes, count);
    batch->cloud = current_;
    return true;
  }
  return false;
}

std::vector<float> JoinedPoints::convert_attributes(std::size_t source,
                                                    const std::vector<float>& values,
                                                    std::size_t points) const {
  const std::vector<Column>& columns = columns_[source];
  const std::size_t width = sources_[source]->attributes().size();
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
