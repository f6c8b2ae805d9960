// SPDX-License-Identifier: GPL-3.0-or-later

// PLY files: the header, and the rows of its elements.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/io/text_reader.h"
#include "prefilter/base/run.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat;
  std::optional<ScalarType> count_type;  // for lists
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// Bytes of a binary row; the least possible number if it has lists.
  std::size_t row_size() const;
  /// Index of a property, or the number of properties if there is none.
  std::size_t find(const std::string& property) const;
};

/// Reads the rows of elements. All functions throw Error for files that are not PLY or are damaged,
/// with the file's name and the position of the damage.
class PlyFile {
 public:
  /// Reads the header. Throws Error if the file is too short for the announced rows.
  explicit PlyFile(ByteReader bytes);

  const std::string& name() const { return text_.name(); }
  bool is_text() const { return is_text_; }
  /// Whether the byte order differs from this machine's.
  bool is_swapped() const { return is_swapped_; }
  const std::vector<PlyElement>& elements() const { return elements_; }
  /// Index of an element, or the number of elements if there is none.
  std::size_t find(const std::string& element) const;
  /// The texts after "obj_info" in such lines.
  const std::vector<std::string>& obj_info() const { return obj_info_; }

  /// Moves to the first row of an element. May have to read preceding rows, which `progress` can
  /// cancel.
  void go_to(std::size_t element, const Run& run = {});
  /// Reads the next row of the element, which must exist.
  void read_row();
  /// Values of the current row by property index; lists have 0.
  std::span<const double> scalars() const { return scalars_; }
  std::span<const double> list(std::size_t property) const;
  /// Up to `most` raw binary rows, and at least one, of an element without lists.
  std::span<const std::byte> read_records(std::size_t most);
  /// Skips this many such rows, which must exist.
  void skip_records(std::uint64_t count);
  /// Number of unread rows of the element.
  std::uint64_t rows_left() const { return elements_[element_].count - row_; }
  /// Message about data after the last row of the last element; empty if there is none.
  std::string surplus();
  /// Throws an Error about the current row.
  [[noreturn]] void throw_here(const std::string& what) const;

 private:
  void read_header();
  void read_property(std::string_view line);
  void read_text_row(const PlyElement& element);
  void read_binary_row(const PlyElement& element);
  const std::byte* next_bytes(std::size_t count);
  void skip_rows(const Run& run);
  void check_size();

  TextReader text_;
  bool is_text_ = false;
  bool is_swapped_ = false;
  std::vector<PlyElement> elements_;
  std::vector<std::string> obj_info_;
  std::vector<TextPlace> element_starts_;  // starts of the elements found so far
  std::size_t element_ = 0;
  std::uint64_t row_ = 0;     // rows of the element read so far
  bool is_skipping_ = false;  // lists are not stored
  std::vector<double> values_;
  std::vector<double> scalars_;
  std::vector<double> list_values_;
  std::vector<std::size_t> list_ends_;  // in list_values_, by property index
};

}  // namespace prefilter
