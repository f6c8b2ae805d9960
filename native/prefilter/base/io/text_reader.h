// SPDX-License-Identifier: GPL-3.0-or-later

// Reads lines of numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prefilter/base/io/byte_reader.h"

namespace prefilter {

/// A position in a file to return to.
struct TextPlace {
  std::uint64_t offset = 0;
  std::uint64_t line = 0;  // number of lines before it
};

/// Reads a file line by line; binary parts are read through bytes().
class TextReader {
 public:
  explicit TextReader(ByteReader bytes) : bytes_(std::move(bytes)) {}
  explicit TextReader(const std::string& path) : bytes_(path) {}

  ByteReader& bytes() { return bytes_; }
  const std::string& name() const { return bytes_.name(); }

  /// Sets the line end; the default is "
  /// ", optionally preceded by "\r".
  void set_line_end(char end) { end_ = end; }
  /// Number of the last line, from 1.
  std::uint64_t line() const { return line_; }

  /// Reads the next line, without its end; false at the end of the file. It is valid until the next
  /// call. Throws Error for a line longer than 16 MiB, which is not text.
  bool next_line(std::string_view* line);
  /// Skips a line.
  bool skip_line();

  TextPlace place() const { return {bytes_.offset(), line_}; }
  void go_to(const TextPlace& place) {
    bytes_.seek(place.offset);
    line_ = place.line;
  }

  /// Location of the last line, as in "'cloud.ply': line 7".
  std::string where() const { return name() + ": line " + std::to_string(line_); }
  /// Replaces `values` by the numbers in the last line. Throws Error if it contains anything else.
  void parse(std::string_view line, std::string_view separators, std::vector<double>* values) const;

 private:
  ByteReader bytes_;
  char end_ = '\n';
  std::uint64_t line_ = 0;
};

/// Word separators in lines, other than commas.
inline constexpr std::string_view kBlanks = " \t\r\v\f";

/// Removes the first word from a line and returns it; empty if there is none.
std::string_view take_word(std::string_view* line, std::string_view separators = kBlanks);

/// Parses a number in any common notation, including "+1", "nan", "inf", "1.#QNAN"; too large ones
/// become infinite. False if the word is not a number.
bool to_number(std::string_view word, double* number);

/// Parses a count in decimal digits. False if the word is not one, or for 2^63 and more.
bool to_count(std::string_view word, std::uint64_t* count);

/// A part of a file for a message: quoted, shortened, and without terminal control characters.
std::string in_quotes(std::string_view text);

}  // namespace prefilter
