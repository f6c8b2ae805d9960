// SPDX-License-Identifier: GPL-3.0-or-later

// Heuristics for files without column names: counts, ranges and unit lengths.
#include "prefilter/points/scan/text_columns.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "prefilter/base/elementary.h"
#include "prefilter/base/io/text_reader.h"
#include "prefilter/points/scan/field_names.h"

namespace prefilter {
namespace {

// Whether the shortest decimal representation of the double has more digits than that of the
// nearest float.
bool needs_double(double value) {
  char as_double[32];
  char as_float[32];
  const auto end = std::to_chars(as_double, as_double + sizeof as_double, value).ptr;
  const auto float_end =
      std::to_chars(as_float, as_float + sizeof as_float, static_cast<float>(value)).ptr;
  return std::isfinite(value) && !std::equal(as_double, end, as_float, float_end);
}

bool are_bytes(std::span<const TextColumn> columns) {
  return std::all_of(columns.begin(), columns.end(), [](const TextColumn& each) {
    return each.is_whole && each.low >= 0.0 && each.high <= 255.0;
  });
}

// Type of integer colors, from their largest value.
ScalarType type_of_colors(std::span<const TextColumn> columns) {
  if (are_bytes(columns)) return ScalarType::kUint8;
  const bool are_deep = std::all_of(columns.begin(), columns.end(), [](const TextColumn& each) {
    return each.is_whole && each.low >= 0.0 && each.high <= 65535.0;
  });
  return are_deep ? ScalarType::kUint16 : ScalarType::kFloat;
}

bool is_color(std::span<const TextColumn> columns) {
  return std::all_of(columns.begin(), columns.end(),
                     [](const TextColumn& each) { return each.is_whole && each.low >= 0.0; }) &&
         std::any_of(columns.begin(), columns.end(),
                     [](const TextColumn& each) { return each.high > 1.0; });
}

ScalarType type_of_positions(const TextColumn& x, const TextColumn& y, const TextColumn& z) {
  return x.is_double || y.is_double || z.is_double ? ScalarType::kDouble : ScalarType::kFloat;
}

ScalarType type_of_named_colors(std::span<const TextColumn> columns,
                                std::span<const std::string> names) {
  std::vector<TextColumn> colors;
  for (const char* name : {"red", "green", "blue"}) {
    const auto place = std::find(names.begin(), names.end(), name) - names.begin();
    if (place == std::ssize(names)) return ScalarType::kFloat;
    colors.push_back(columns[static_cast<std::size_t>(place)]);
  }
  return type_of_colors(colors);
}

std::string name_of_any(std::size_t column) { return "value" + std::to_string(column + 1); }

class ColumnNames {
 public:
  explicit ColumnNames(std::span<const TextColumn> columns) : columns_(columns) {
    name({"x", "y", "z"}, type_of_positions(columns[0], columns[1], columns[2]));
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

  std::vector<ScanField> take() { return std::move(fields_); }

 private:
  // Whether the fourth column stands alone before a triple.
  static bool is_three_after(std::span<const TextColumn> columns) {
    return is_color(columns.subspan(4, 3)) || (columns[4].begins_unit && !columns[3].begins_unit);
  }
  void name(std::initializer_list<const char*> names, ScalarType type) {
    for (const char* each : names) fields_.push_back({each, type, fields_.size(), 0});
  }
  void name_any() {
    fields_.push_back({name_of_any(fields_.size()), ScalarType::kFloat, fields_.size(), 0});
  }
  bool has_intensity() const {
    return std::any_of(fields_.begin(), fields_.end(),
                       [](const ScanField& each) { return each.name == "intensity"; });
  }

  void name_three() {
    const auto three = columns_.subspan(fields_.size(), 3);
    if (is_color(three)) {
      if (!has_color_) {
        name({"red", "green", "blue"}, type_of_colors(three));
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

  std::span<const TextColumn> columns_;
  std::vector<ScanField> fields_;
  bool has_color_ = false;
  bool has_normal_ = false;
};

// Synonyms of names in header lines, in addition to those of field_name.
constexpr std::pair<std::string_view, std::string_view> kSynonyms[] = {
    {"r", "red"},
    {"g", "green"},
    {"b", "blue"},
    {"i", "intensity"},
    {"class", "classification"},
    {"easting", "x"},
    {"northing", "y"},
    {"elevation", "z"},
    {"height", "z"},
    {"east", "x"},
    {"north", "y"},
};

std::string_view without_quotes(std::string_view word) {
  constexpr std::string_view kAround = "\"' \t";
  const std::size_t begin = word.find_first_not_of(kAround);
  if (begin == std::string_view::npos) return {};
  return word.substr(begin, word.find_last_not_of(kAround) - begin + 1);
}

std::string column_name(std::string_view quoted_word) {
  const std::string_view word = without_quotes(quoted_word);
  std::string name;
  for (const char c : word) name += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  for (const auto& [synonym, meaning] : kSynonyms) {
    if (name == synonym) return std::string(meaning);
  }
  return field_name(name);
}

}  // namespace

void TextColumn::include(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
  is_whole = is_whole && std::floor(value) == value;
  is_double = is_double || needs_double(value);
}

// Normals are often written with few digits.
bool is_unit(const double* vector) {
  return std::abs(elementary::hypot(vector[0], vector[1], vector[2]) - 1.0) < 0.01;
}

std::vector<ScanField> guessed_fields(std::span<const TextColumn> columns) {
  return ColumnNames(columns).take();
}

std::vector<ScanField> named_fields(std::span<const TextColumn> columns,
                                    std::span<const std::string> names) {
  if (names.size() != columns.size()) return {};
  const auto place_of = [&](std::string_view name) {
    return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const std::array<std::size_t, 3> axes{place_of("x"), place_of("y"), place_of("z")};
  const ScalarType position_type =
      type_of_positions(columns[axes[0]], columns[axes[1]], columns[axes[2]]);
  const ScalarType color_type = type_of_named_colors(columns, names);
  std::vector<ScanField> fields;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::string& name = names[c];
    ScanField field = {name, ScalarType::kFloat, c, 0};
    if (std::find(axes.begin(), axes.end(), c) != axes.end()) {
      field.type = position_type;
    } else if (name == "red" || name == "green" || name == "blue") {
      field.type = color_type;
    }
    // A name may be repeated or empty.
    if (name.empty() || place_of(name) != c) field.name = name_of_any(c);
    fields.push_back(std::move(field));
  }
  return fields;
}

std::vector<std::string> names_in(std::string_view line) {
  std::vector<std::string> names;
  const std::size_t first_separator = line.find_first_of(",;\t");
  if (first_separator == std::string_view::npos) {
    for (std::string_view word = take_word(&line); !word.empty(); word = take_word(&line)) {
      names.push_back(column_name(word));
    }
    return names;
  }
  const char separator = line[first_separator];
  while (true) {
    const std::size_t end = std::min(line.find(separator), line.size());
    std::string_view part = without_quotes(line.substr(0, end));
    const std::string_view known = known_field_name(part);
    // A unit may follow the first word.
    names.push_back(known.empty() ? column_name(take_word(&part)) : std::string(known));
    if (end == line.size()) return names;
    line.remove_prefix(end + 1);
  }
}

}  // namespace prefilter
