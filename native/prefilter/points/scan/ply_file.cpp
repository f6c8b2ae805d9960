// SPDX-License-Identifier: GPL-3.0-or-later

// Stanford's PLY format in text and in binary of either byte order. A single pass finds the start
// of each element.
#include "prefilter/points/scan/ply_file.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "prefilter/base/cancel_check.h"
#include "prefilter/base/error.h"
#include "prefilter/base/text.h"

namespace prefilter {
namespace {

// A longer header indicates a binary file that happens to start like one.
constexpr std::uint64_t kMaxPlyHeaderSize = std::uint64_t{1} << 20;

struct TypeName {
  std::string_view name;
  ScalarType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", ScalarType::kInt8},     {"int8", ScalarType::kInt8},
    {"uchar", ScalarType::kUint8},   {"uint8", ScalarType::kUint8},
    {"short", ScalarType::kInt16},   {"int16", ScalarType::kInt16},
    {"ushort", ScalarType::kUint16}, {"uint16", ScalarType::kUint16},
    {"int", ScalarType::kInt32},     {"int32", ScalarType::kInt32},
    {"uint", ScalarType::kUint32},   {"uint32", ScalarType::kUint32},
    {"int64", ScalarType::kInt64},   {"uint64", ScalarType::kUint64},
    {"float", ScalarType::kFloat},   {"float32", ScalarType::kFloat},
    {"double", ScalarType::kDouble}, {"float64", ScalarType::kDouble},
};

ScalarType type_named(std::string_view name, const TextReader& text) {
  for (const TypeName& each : kTypeNames) {
    if (each.name == name) return each.type;
  }
  throw_invalid(text.where() + ": " + in_quotes(name) + " is not a type of PLY");
}

bool is_blank(std::string_view line) { return take_word(&line).empty(); }

template <typename Named>
std::size_t find_named(const std::vector<Named>& all, const std::string& name) {
  const auto position =
      std::find_if(all.begin(), all.end(), [&](const Named& each) { return each.name == name; });
  return static_cast<std::size_t>(position - all.begin());
}

}  // namespace

bool PlyElement::has_lists() const {
  return std::any_of(properties.begin(), properties.end(),
                     [](const PlyProperty& each) { return each.count_type.has_value(); });
}

std::size_t PlyElement::row_size() const {
  std::size_t size = 0;
  for (const PlyProperty& each : properties) size += size_of(each.count_type.value_or(each.type));
  return size;
}

std::size_t PlyElement::find(const std::string& property) const {
  return find_named(properties, property);
}

PlyFile::PlyFile(ByteReader bytes) : text_(std::move(bytes)) {
  read_header();
  element_starts_.push_back(text_.place());
  check_size();
}

std::size_t PlyFile::find(const std::string& element) const {
  return find_named(elements_, element);
}

void PlyFile::read_header() {
  const auto magic = text_.bytes().peek(4);
  const std::string_view first(reinterpret_cast<const char*>(magic.data()),
                               std::min<std::size_t>(magic.size(), 4));
  if (first.size() < 4 || !first.starts_with("ply") ||
      std::string_view(" \t\r\n").find(first[3]) == std::string_view::npos) {
    throw_invalid(name() + " is not a PLY file: it begins with " + in_quotes(first));
  }
  std::string_view line;
  bool has_format = false;
  while (text_.next_line(&line)) {
    if (text_.bytes().offset() > kMaxPlyHeaderSize) {
      throw_invalid(text_.where() + ": the header is longer than 1 MiB");
    }
    const std::string_view keyword = take_word(&line);
    if (keyword == "format") {
      const std::string_view format = take_word(&line);
      is_text_ = format == "ascii";
      if (!is_text_ && format != "binary_little_endian" && format != "binary_big_endian") {
        throw_invalid(text_.where() + ": format " + in_quotes(format) +
                      "; ascii, binary_little_endian or binary_big_endian is needed");
      }
      is_swapped_ = (format == "binary_big_endian") != (std::endian::native == std::endian::big);
      has_format = true;
    } else if (keyword == "element") {
      PlyElement element;
      element.name = take_word(&line);
      const std::string_view count = take_word(&line);
      if (element.name.empty() || !to_count(count, &element.count)) {
        throw_invalid(text_.where() + ": element " + in_quotes(element.name) + " with count " +
                      in_quotes(count) +
                      "; a name and a whole number from 0 to 2^63 - 1 are needed");
      }
      if (find(element.name) < elements_.size()) {
        throw_invalid(text_.where() + ": a second element " + in_quotes(element.name));
      }
      elements_.push_back(std::move(element));
    } else if (keyword == "property") {
      read_property(line);
    } else if (keyword == "obj_info") {
      obj_info_.emplace_back(line);
    } else if (keyword == "end_header") {
      if (!has_format) throw_invalid(name() + ": the header has no line 'format'");
      return;
    }
    // All other lines are comments, or remnants in files of Stanford's scanner.
  }
  throw_invalid(name() + ": ends within the header, after line " +
                std::to_string(text_.place().line));
}

void PlyFile::read_property(std::string_view line) {
  if (elements_.empty()) throw_invalid(text_.where() + ": a property before any element");
  PlyProperty property;
  std::string_view type = take_word(&line);
  if (type == "list") {
    property.count_type = type_named(take_word(&line), text_);
    if (*property.count_type >= ScalarType::kFloat) {
      throw_invalid(text_.where() + ": the length of a list has to be of a type of whole numbers");
    }
    type = take_word(&line);
  }
  property.type = type_named(type, text_);
  property.name = take_word(&line);
  PlyElement& element = elements_.back();
  if (property.name.empty()) throw_invalid(text_.where() + ": a property without a name");
  if (element.find(property.name) < element.properties.size()) {
    throw_invalid(text_.where() + ": a second property " + in_quotes(property.name) + " of " +
                  in_quotes(element.name));
  }
  element.properties.push_back(std::move(property));
}

// Compares announced counts with the file's size before anything is allocated.
void PlyFile::check_size() {
  const std::uint64_t there = text_.bytes().remaining();
  std::uint64_t needed = 0;
  for (const PlyElement& element : elements_) {
    // A number takes at least a digit and a separator; the last line may lack the latter.
    const std::uint64_t row = is_text_ ? 2 * element.properties.size() : element.row_size();
    if (row == 0) continue;
    const std::uint64_t end = there + (is_text_ ? 1 : 0);
    if (element.count > (end - needed) / row) {
      throw_invalid(name() + ": too short for the " + std::to_string(element.count) + " rows of " +
                    in_quotes(element.name) + " in its header: " + std::to_string(there) +
                    " bytes follow the header");
    }
    needed += element.count * row;
  }
}

void PlyFile::go_to(std::size_t element, const Run& run) {
  while (element_starts_.size() <= element) {
    element_ = element_starts_.size() - 1;
    row_ = 0;
    text_.go_to(element_starts_.back());
    skip_rows(run);
    element_starts_.push_back(text_.place());
  }
  element_ = element;
  row_ = 0;
  text_.go_to(element_starts_[element]);
  scalars_.assign(elements_[element].properties.size(), 0.0);
  list_ends_.assign(elements_[element].properties.size(), 0);
}

void PlyFile::skip_rows(const Run& run) {
  const PlyElement& element = elements_[element_];
  if (element.properties.empty()) return;
  if (!is_text_ && !element.has_lists()) {
    text_.bytes().seek(text_.bytes().offset() + element.count * element.row_size());
    return;
  }
  scalars_.assign(element.properties.size(), 0.0);
  list_ends_.assign(element.properties.size(), 0);
  is_skipping_ = true;
  CancelCheck cancel_check(run);
  while (rows_left() > 0) {
    cancel_check.step();
    read_row();
  }
  is_skipping_ = false;
}

void PlyFile::read_row() {
  const PlyElement& element = elements_[element_];
  ++row_;
  list_values_.clear();
  if (is_text_) {
    read_text_row(element);
  } else {
    read_binary_row(element);
  }
}

void PlyFile::read_text_row(const PlyElement& element) {
  if (element.properties.empty()) return;
  std::string_view line;
  do {
    if (!text_.next_line(&line)) throw_here("the file ends before it");
  } while (is_blank(line));
  text_.parse(line, kBlanks, &values_);
  std::size_t next = 0;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (next < values_.size()) {
      scalars_[i] = values_[next++];
      if (element.properties[i].count_type) {
        const double length = std::exchange(scalars_[i], 0.0);
        if (!(length >= 0.0 && length == std::floor(length))) {
          throw_here("found a list of length " + to_text(length));
        }
        if (length > static_cast<double>(values_.size() - next)) {
          throw_here("a list is longer than its line");
        }
        const auto begin = values_.begin() + static_cast<std::ptrdiff_t>(next);
        next += static_cast<std::size_t>(length);
        list_values_.insert(list_values_.end(), begin,
                            values_.begin() + static_cast<std::ptrdiff_t>(next));
      }
    } else {
      throw_here("found " + std::to_string(values_.size()) + " values; more are needed");
    }
    list_ends_[i] = list_values_.size();
  }
  if (next < values_.size()) {
    throw_here("found " + std::to_string(values_.size()) + " values; " + std::to_string(next) +
               " are needed");
  }
}

void PlyFile::read_binary_row(const PlyElement& element) {
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    const std::size_t size = size_of(property.type);
    if (property.count_type) {
      const double length =
          load_scalar(*property.count_type, is_swapped_, next_bytes(size_of(*property.count_type)));
      if (length < 0.0) throw_here("found a list of length " + to_text(length));
      const auto count = static_cast<std::uint64_t>(length);
      if (count > text_.bytes().remaining() / size) {
        throw_here("a list of length " + to_text(length) + " is longer than the file");
      }
      if (is_skipping_) {
        text_.bytes().seek(text_.bytes().offset() + count * size);
      } else {
        for (std::uint64_t k = 0; k < count; ++k) {
          list_values_.push_back(load_scalar(property.type, is_swapped_, next_bytes(size)));
        }
      }
    } else {
      scalars_[i] = load_scalar(property.type, is_swapped_, next_bytes(size));
    }
    list_ends_[i] = list_values_.size();
  }
}

const std::byte* PlyFile::next_bytes(std::size_t count) {
  const auto bytes = text_.bytes().peek(count);
  if (bytes.size() < count) throw_here("the file ends within it");
  text_.bytes().skip(count);
  return bytes.data();
}

std::span<const double> PlyFile::list(std::size_t property) const {
  const std::size_t begin = property == 0 ? 0 : list_ends_[property - 1];
  return std::span(list_values_).subspan(begin, list_ends_[property] - begin);
}

std::span<const std::byte> PlyFile::read_records(std::size_t most) {
  const std::size_t size = elements_[element_].row_size();
  const auto bytes = text_.bytes().peek(size);
  const std::size_t count = static_cast<std::size_t>(
      std::min({std::uint64_t{most}, rows_left(), std::uint64_t{bytes.size() / size}}));
  row_ += std::max<std::size_t>(count, 1);
  if (count == 0) throw_here("the file ends within it");
  text_.bytes().skip(count * size);
  return bytes.first(count * size);
}

void PlyFile::skip_records(std::uint64_t count) {
  text_.bytes().seek(text_.bytes().offset() + count * elements_[element_].row_size());
  row_ += count;
}

std::string PlyFile::surplus() {
  if (element_ + 1 < elements_.size() || rows_left() > 0) return "";
  while (true) {
    const auto trailing = text_.bytes().peek(1);
    if (trailing.empty()) return "";
    const std::string_view more(reinterpret_cast<const char*>(trailing.data()), trailing.size());
    if (more.find_first_not_of(" \t\r\n\v\f") != std::string_view::npos) {
      return name() + ": holds more than the " + std::to_string(elements_[element_].count) +
             " rows of " + in_quotes(elements_[element_].name) + " in its header";
    }
    text_.bytes().skip(trailing.size());
  }
}

void PlyFile::throw_here(const std::string& what) const {
  const PlyElement& element = elements_[element_];
  const std::string row = std::to_string(row_) + " of " + std::to_string(element.count);
  throw_invalid((is_text_ ? text_.where() : name()) + ": " + element.name + " " + row + ": " +
                what);
}

}  // namespace prefilter
