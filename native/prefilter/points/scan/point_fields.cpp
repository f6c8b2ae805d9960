// SPDX-License-Identifier: GPL-3.0-or-later

// Records are converted column by column in small blocks.
#include "prefilter/points/scan/point_fields.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>
#include <string_view>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/io/text_reader.h"
#include "prefilter/points/scan/field_names.h"

namespace prefilter {
namespace {

// Records per block, so that they and the results fit into the L1 cache.
constexpr std::size_t kRecordsAtOnce = 256;

template <std::size_t kSize>
struct Unsigned;
template <>
struct Unsigned<1> {
  using Type = std::uint8_t;
};
template <>
struct Unsigned<2> {
  using Type = std::uint16_t;
};
template <>
struct Unsigned<4> {
  using Type = std::uint32_t;
};
template <>
struct Unsigned<8> {
  using Type = std::uint64_t;
};

template <typename Bits>
Bits reversed(Bits bits) {
  if constexpr (sizeof(Bits) == 2) return __builtin_bswap16(bits);
  if constexpr (sizeof(Bits) == 4) return __builtin_bswap32(bits);
  if constexpr (sizeof(Bits) == 8) return __builtin_bswap64(bits);
  return bits;
}

template <typename T, bool kIsSwapped>
T load(const std::byte* bytes) {
  typename Unsigned<sizeof(T)>::Type bits;
  std::memcpy(&bits, bytes, sizeof bits);
  if constexpr (kIsSwapped) bits = reversed(bits);
  return std::bit_cast<T>(bits);
}

// Calls `function` with a value of the C++ type of a ScalarType.
template <typename Function>
auto with_type(ScalarType type, const Function& function) {
  switch (type) {
    case ScalarType::kInt8:
      return function(std::int8_t{});
    case ScalarType::kUint8:
      return function(std::uint8_t{});
    case ScalarType::kInt16:
      return function(std::int16_t{});
    case ScalarType::kUint16:
      return function(std::uint16_t{});
    case ScalarType::kInt32:
      return function(std::int32_t{});
    case ScalarType::kUint32:
      return function(std::uint32_t{});
    case ScalarType::kInt64:
      return function(std::int64_t{});
    case ScalarType::kUint64:
      return function(std::uint64_t{});
    case ScalarType::kFloat:
      return function(float{});
    case ScalarType::kDouble:
      break;
  }
  return function(double{});
}

template <typename Out>
void convert_column(ScalarType type, bool is_swapped, const std::byte* from, std::size_t stride,
                    std::size_t count, Out* to, std::size_t to_stride) {
  with_type(type, [&](auto like) {
    using T = decltype(like);
    const auto convert = [&]<bool kIsSwapped>() {
      for (std::size_t i = 0; i < count; ++i) {
        to[i * to_stride] = static_cast<Out>(load<T, kIsSwapped>(from + i * stride));
      }
    };
    is_swapped ? convert.template operator()<true>() : convert.template operator()<false>();
  });
}

// Whether a type has more digits than a float.
bool is_precise(ScalarType type) {
  return type == ScalarType::kDouble || (size_of(type) >= 4 && type != ScalarType::kFloat);
}

}  // namespace

std::size_t size_of(ScalarType type) {
  return with_type(type, [](auto like) { return sizeof like; });
}

double load_scalar(ScalarType type, bool is_swapped, const std::byte* bytes) {
  return with_type(type, [&](auto like) {
    using T = decltype(like);
    return static_cast<double>(is_swapped ? load<T, true>(bytes) : load<T, false>(bytes));
  });
}

PointFields::PointFields(const std::vector<ScanField>& fields, const std::string& name) {
  std::set<std::string> names;
  for (const ScanField& field : fields) {
    if (!names.insert(field.name).second) {
      throw_invalid(name + ": points have two values named " + in_quotes(field.name));
    }
  }
  std::vector<ScanField> known = fields;
  for (ScanField& field : known) {
    // Fields with a standard name take precedence over synonyms.
    std::string meaning = field_name(field.name);
    if (names.insert(meaning).second) field.name = std::move(meaning);
  }
  const auto has_all = [&](std::array<const char*, 3> axes) {
    return std::all_of(axes.begin(), axes.end(),
                       [&](const char* each) { return names.contains(each); });
  };
  has_normals_ = has_all({"nx", "ny", "nz"});
  for (const ScanField& field : known) add(field);
  for (const char* axis : {"x", "y", "z"}) {
    if (!names.contains(axis)) {
      throw_invalid(name + ": points have no coordinate '" + axis + "'; x, y and z are needed");
    }
  }
}

void PointFields::add(const ScanField& field) {
  const auto axis_in = [&](const std::array<std::string_view, 3>& axes) {
    return static_cast<std::size_t>(std::find(axes.begin(), axes.end(), field.name) - axes.begin());
  };
  if (const std::size_t axis = axis_in({"x", "y", "z"}); axis < 3) {
    columns_.push_back({field, Role::kPosition, axis});
    is_double_ = is_double_ || is_precise(field.type);
  } else if (const std::size_t along = axis_in({"nx", "ny", "nz"}); has_normals_ && along < 3) {
    columns_.push_back({field, Role::kNormal, along});
  } else if (field.name == "confidence") {
    columns_.push_back({field, Role::kWeight, 0});
    has_weights_ = true;
  } else {
    const bool is_color = axis_in({"red", "green", "blue"}) < 3 || field.name == "alpha";
    const bool is_deep = is_color && field.type == ScalarType::kUint16;
    columns_.push_back({field, Role::kAttribute, attributes_.size(), is_deep});
    attributes_.push_back({field.name, is_deep || field.type == ScalarType::kUint8});
    has_deep_colors_ = has_deep_colors_ || is_deep;
  }
}

float PointFields::to_byte(double value) const {
  return static_cast<float>(std::round(value * color_scale_));
}

void PointFields::resize(std::size_t count, PointBatch* batch) const {
  batch->positions.resize(count);
  batch->normals.resize(has_normals_ ? count : 0);
  batch->weights.resize(has_weights_ ? count : 0);
  batch->viewpoints.clear();
  batch->attributes.resize(count * attributes_.size());
}

void PointFields::put_values(const double* values, std::size_t point, PointBatch* batch) const {
  for (const Column& column : columns_) {
    const double value = values[column.field.index];
    switch (column.role) {
      case Role::kPosition:
        batch->positions[point][column.component] = value;
        break;
      case Role::kNormal:
        batch->normals[point][column.component] = static_cast<float>(value);
        break;
      case Role::kWeight:
        batch->weights[point] = static_cast<float>(value);
        break;
      case Role::kAttribute:
        batch->attributes[point * attributes_.size() + column.component] =
            column.is_deep ? to_byte(value) : static_cast<float>(value);
        break;
    }
  }
}

void PointFields::put_records(const std::byte* records, std::size_t stride, bool is_swapped,
                              std::size_t first, std::size_t count, PointBatch* batch) const {
  for (std::size_t done = 0; done < count; done += kRecordsAtOnce) {
    const std::size_t some = std::min(kRecordsAtOnce, count - done);
    const std::size_t point = first + done;
    for (const Column& column : columns_) {
      const std::byte* const from = records + done * stride + column.field.offset;
      const auto convert = [&](auto* to, std::size_t to_stride) {
        convert_column(column.field.type, is_swapped, from, stride, some, to, to_stride);
      };
      switch (column.role) {
        case Role::kPosition:
          convert(&batch->positions[point][column.component], 3);
          break;
        case Role::kNormal:
          convert(&batch->normals[point][column.component], 3);
          break;
        case Role::kWeight:
          convert(&batch->weights[point], 1);
          break;
        case Role::kAttribute:
          put_attribute(column, from, stride, is_swapped, point, some, batch);
          break;
      }
    }
  }
}

void PointFields::put_attribute(const Column& column, const std::byte* from, std::size_t stride,
                                bool is_swapped, std::size_t point, std::size_t count,
                                PointBatch* batch) const {
  const std::size_t width = attributes_.size();
  float* const to = &batch->attributes[point * width + column.component];
  convert_column(column.field.type, is_swapped, from, stride, count, to, width);
  for (std::size_t i = 0; column.is_deep && i < count; ++i) to[i * width] = to_byte(to[i * width]);
}

std::optional<std::size_t> attribute_index(const std::vector<PointAttribute>& attributes,
                                           const std::string& name) {
  const auto attribute =
      std::find_if(attributes.begin(), attributes.end(),
                   [&](const PointAttribute& each) { return each.name == name; });
  if (attribute == attributes.end()) return std::nullopt;
  return static_cast<std::size_t>(attribute - attributes.begin());
}

void find_color_scale(PointSource* source, PointFields* fields) {
  if (!fields->has_deep_colors()) return;
  constexpr std::size_t kSampledPoints = 1'000'000;
  constexpr std::size_t kBatchSize = 1 << 16;
  const std::vector<PointAttribute>& attributes = source->attributes();
  fields->set_color_scale(1.0);
  source->rewind();
  PointBatch batch;
  float highest = 0.0F;
  for (std::size_t colored = 0; colored < kSampledPoints && source->read(kBatchSize, &batch);) {
    for (std::size_t i = 0; i < batch.attributes.size(); i += attributes.size()) {
      float brightest = 0.0F;
      for (std::size_t a = 0; a < attributes.size(); ++a) {
        const std::string& name = attributes[a].name;
        if (name != "red" && name != "green" && name != "blue") continue;
        brightest = std::max(brightest, batch.attributes[i + a]);
      }
      highest = std::max(highest, brightest);
      colored += brightest > 0.0F ? 1 : 0;
    }
    if (highest > 255.0F) break;
  }
  fields->set_color_scale(highest > 255.0F ? kDeepColorScale : 1.0);
  source->rewind();
}

}  // namespace prefilter
