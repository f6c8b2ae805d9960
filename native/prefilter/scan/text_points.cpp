// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/scan/text_points.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <span>

#include "prefilter/base/elementary.h"
#include "prefilter/base/error.h"
#include "prefilter/io/text_reader.h"
#include "prefilter/scan/point_fields.h"

namespace prefilter {
namespace {

constexpr std::string_view kSeparators = " \t\r\v\f,;";
constexpr std::size_t kLinesLookedAt = 4096;

// What is known of a column from the lines that were looked at.
struct Column {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  bool is_whole = true;
  bool is_double = false;
  bool begins_unit = true;  // whether it and the next two hold vectors of length 1

  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
    is_whole = is_whole && std::floor(value) == value;
    is_double = is_double || needs_double(value);
  }

 private:
  // Whether the decimals that tell the number from others of double precision tell more than
  // those of the nearest float.
  static bool needs_double(double value) {
    char as_double[32];
    char as_float[32];
    const auto end = std::to_chars(as_double, as_double + sizeof as_double, value).ptr;
    const auto float_end =
        std::to_chars(as_float, as_float + sizeof as_float, static_cast<float>(value)).ptr;
    return std::isfinite(value) && !std::equal(as_double, end, as_float, float_end);
  }
};

bool is_color(std::span<const Column> columns) {
  return std::all_of(columns.begin(), columns.end(),
                     [](const Column& each) { return each.is_whole && each.low >= 0.0; }) &&
         std::any_of(columns.begin(), columns.end(),
                     [](const Column& each) { return each.high > 1.0; });
}

// Normals are written with few digits.
bool is_unit(const double* vector) {
  return std::abs(elementary::hypot(vector[0], vector[1], vector[2]) - 1.0) < 0.01;
}

// Names and types of columns, from what was seen in them.
class ColumnNames {
 public:
  explicit ColumnNames(std::span<const Column> columns) : columns_(columns) {
    name({"x", "y", "z"}, columns[0].is_double || columns[1].is_double || columns[2].is_double
                              ? ScalarType::kDouble
                              : ScalarType::kFloat);
    const std::size_t left = columns.size() - 3;
    if (left % 3 == 1 && (left == 1 || is_three_after(columns))) {
      name({"intensity"}, ScalarType::kFloat);
    }
    while (columns.size() - fields_.size() >= 3) name_three();
    if (columns.size() - fields_.size() == 1 && !has_intensity()) {
      name({"intensity"}, ScalarType::kFloat);
    }
    while (fields_.size() < columns.size()) name_any();
  }

  const std::vector<ScanField>& fields() const { return fields_; }

 private:
  // Whether the fourth column is one by itself, before three that belong together.
  static bool is_three_after(std::span<const Column> columns) {
    return is_color(columns.subspan(4, 3)) || (columns[4].begins_unit && !columns[3].begins_unit);
  }
  void name(std::initializer_list<const char*> names, ScalarType type) {
    for (const char* each : names) fields_.push_back({each, type, fields_.size(), 0});
  }
  void name_any() {
    fields_.push_back(
        {"value" + std::to_string(fields_.size() + 1), ScalarType::kFloat, fields_.size(), 0});
  }
  bool has_intensity() const {
    return std::any_of(fields_.begin(), fields_.end(),
                       [](const ScanField& each) { return each.name == "intensity"; });
  }

  void name_three() {
    const auto three = columns_.subspan(fields_.size(), 3);
    if (is_color(three)) {
      const bool is_byte = std::all_of(three.begin(), three.end(),
                                       [](const Column& each) { return each.high <= 255.0; });
      if (!has_color_) {
        name({"red", "green", "blue"}, is_byte ? ScalarType::kUint8 : ScalarType::kFloat);
        has_color_ = true;
        return;
      }
    } else if (!has_normal_) {
      name({"nx", "ny", "nz"}, ScalarType::kFloat);
      has_normal_ = true;
      return;
    }
    for (int k = 0; k < 3; ++k) name_any();
  }

  std::span<const Column> columns_;
  std::vector<ScanField> fields_;
  bool has_color_ = false;
  bool has_normal_ = false;
};

class TextPoints final : public PointSource {
 public:
  explicit TextPoints(const std::string& path) : text_(path) {
    look_at_lines();
    rewind();
  }

  // A file may hold several clouds, each with its count.
  std::optional<std::size_t> count() const override { return std::nullopt; }
  bool has_normals() const override { return fields_.has_normals(); }
  const std::vector<PointAttribute>& attributes() const override { return fields_.attributes(); }
  bool is_double() const override { return fields_.is_double(); }

  void rewind() override {
    text_.go_to({});
    counted_ = 0;
    found_ = 0;
    has_count_ = false;
  }

  bool read(std::size_t most, PointBatch* batch) override {
    fields_.resize(0, batch);
    std::size_t size = 0;
    while (size < most && next_values()) {
      if (values_.size() != width_) {
        throw_invalid(text_.where() + ": found " + std::to_string(values_.size()) + " numbers; " +
                      std::to_string(width_) + " are needed, as before");
      }
      fields_.resize(size + 1, batch);
      fields_.put_values(values_.data(), size, batch);
      ++size;
    }
    return size > 0;
  }

 private:
  // The numbers of the next line of a point; false at the end of the file.
  bool next_values() {
    std::string_view line;
    while (text_.next_line(&line)) {
      line = line.substr(0, std::min(line.find('#'), line.find("//")));
      text_.parse(line, kSeparators, &values_);
      if (values_.size() == 1) {
        take_count();
      } else if (!values_.empty()) {
        if (has_count_ && found_ == counted_) {
          throw_invalid(text_.where() + ": more points than the " + std::to_string(counted_) +
                        " that were announced");
        }
        ++found_;
        return true;
      }
    }
    check_count();
    return false;
  }

  void take_count() {
    check_count();
    if (!(values_[0] >= 0.0 && values_[0] < 9e15 && std::floor(values_[0]) == values_[0])) {
      throw_invalid(text_.where() +
                    ": found a single number that is not a count; a point needs x, y and z");
    }
    if (!has_count_ && found_ > 0) {
      throw_invalid(text_.where() + ": found 1 number; " + std::to_string(width_) +
                    " are needed, as before");
    }
    counted_ = static_cast<std::uint64_t>(values_[0]);
    found_ = 0;
    has_count_ = true;
  }

  void check_count() const {
    if (has_count_ && found_ < counted_) {
      throw_invalid(text_.where() + ": ends after " + std::to_string(found_) + " of the " +
                    std::to_string(counted_) + " points that were announced");
    }
  }

  void look_at_lines() {
    std::vector<Column> columns;
    // The rest of what is wrong is found when it is read.
    for (std::size_t k = 0; k < kLinesLookedAt && next_values(); ++k) {
      if (k == 0) {
        if (values_.size() < 3) {
          throw_invalid(text_.where() + ": found " + std::to_string(values_.size()) +
                        " numbers; x, y and z are needed");
        }
        columns.resize(values_.size());
        width_ = values_.size();
      }
      if (values_.size() != width_) break;
      for (std::size_t c = 0; c < width_; ++c) {
        columns[c].include(values_[c]);
        if (c + 3 <= width_ && !is_unit(&values_[c])) columns[c].begins_unit = false;
      }
    }
    // A file without points may have none.
    columns.resize(std::max<std::size_t>(columns.size(), 3));
    fields_ = PointFields(ColumnNames(columns).fields(), text_.name());
  }

  TextReader text_;
  PointFields fields_;
  std::size_t width_ = 0;
  std::vector<double> values_;
  // Of the points that a count has announced, and of those that came since.
  std::uint64_t counted_ = 0;
  std::uint64_t found_ = 0;
  bool has_count_ = false;
};

}  // namespace

std::unique_ptr<PointSource> open_text_points(const std::string& path) {
  return std::make_unique<TextPoints>(path);
}

}  // namespace prefilter
