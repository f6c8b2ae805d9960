// SPDX-License-Identifier: GPL-3.0-or-later

// PLY files: the header, and the rows of the elements that it announces.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "prefilter/base/io/text_reader.h"
#include "prefilter/base/progress.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {

struct PlyProperty {
  std::string name;
  ScalarType type = ScalarType::kFloat;
  std::optional<ScalarType> count_type;  // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// Of a binary row; of its shortest where it has lists.
  std::size_t row_size() const;
  /// The number of a property, or how many there are.
  std::size_t find(const std::string& property) const;
};

/// Reads the rows of one element after the other. All functions throw Error for what is no PLY
/// file or is damaged, with its name and the place in it.
class PlyFile {
 public:
  /// Reads the header. Throws where the file is too short for what it announces.
  explicit PlyFile(ByteReader bytes);

  const std::string& name() const { return text_.name(); }
  bool is_text() const { return is_text_; }
  /// Whether numbers are of the endianness that this machine does not have.
  bool is_swapped() const { return is_swapped_; }
  const std::vector<PlyElement>& elements() const { return elements_; }
  /// The number of an element, or how many there are.
  std::size_t find(const std::string& element) const;
  /// What comes after a word of a line "obj_info".
  const std::vector<std::string>& obj_info() const { return obj_info_; }

  /// Goes to the first row of an element. Where what comes before has to be read for that, a
  /// progress can stop it.
  void go_to(std::size_t element, const Progress& progress = {});
  /// Reads the next row of this element, of which there must be one left.
  void read_row();
  /// Of the row that was read last: its values by the number of the property; lists have 0.
  std::span<const double> scalars() const { return scalars_; }
  std::span<const double> list(std::size_t property) const;
  /// Binary rows as they lie there, `most` at the most and one at least, where the element has no
  /// lists.
  std::span<const std::byte> read_records(std::size_t most);
  /// Goes over so many of these, which are there.
  void skip_records(std::uint64_t count);
  /// Rows of this element that are left.
  std::uint64_t rows_left() const { return elements_[element_].count - row_; }
  /// What to say where anything follows the rows of the last element; empty where nothing does.
  std::string surplus();
  /// Throws an Error about the row that was read last.
  [[noreturn]] void throw_here(const std::string& what) const;

 private:
  void read_header();
  void read_property(std::string_view line);
  void read_text_row(const PlyElement& element);
  void read_binary_row(const PlyElement& element);
  const std::byte* next_bytes(std::size_t count);
  void skip_rows(const Progress& progress);
  void check_size();

  TextReader text_;
  bool is_text_ = false;
  bool is_swapped_ = false;
  std::vector<PlyElement> elements_;
  std::vector<std::string> obj_info_;
  std::vector<TextPlace> places_;  // where elements begin, as far as is known
  std::size_t element_ = 0;
  std::uint64_t row_ = 0;     // rows of the element that were read
  bool is_skipping_ = false;  // lists need not be kept
  std::vector<double> values_;
  std::vector<double> scalars_;
  std::vector<double> list_values_;
  std::vector<std::size_t> list_ends_;  // in list_values_, by the number of the property
};

}  // namespace prefilter
