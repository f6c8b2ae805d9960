// SPDX-License-Identifier: GPL-3.0-or-later

// Lines of numbers.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prefilter/base/io/byte_reader.h"

namespace prefilter {

/// A place in a file to come back to.
struct TextPlace {
  std::uint64_t offset = 0;
  std::uint64_t line = 0;  // lines before it
};

/// A file line by line; of what is not text it reads bytes.
class TextReader {
 public:
  explicit TextReader(ByteReader bytes) : bytes_(std::move(bytes)) {}
  explicit TextReader(const std::string& path) : bytes_(path) {}

  ByteReader& bytes() { return bytes_; }
  const std::string& name() const { return bytes_.name(); }

  /// What ends lines: "\n", with or without "\r" before it, unless this says otherwise.
  void set_line_end(char end) { end_ = end; }
  /// Of the line that was read last, from 1 on.
  std::uint64_t line() const { return line_; }

  /// The next line without its end; false where there are no more. It stays where
  /// it is until the next call. Throws Error for a line that is no text: longer than 16 MiB.
  bool next_line(std::string_view* line);
  /// Passes a line.
  bool skip_line();

  TextPlace place() const { return {bytes_.offset(), line_}; }
  void go_to(const TextPlace& place) {
    bytes_.seek(place.offset);
    line_ = place.line;
  }

  /// "'cloud.ply': line 7", of the line that was read last.
  std::string where() const { return name() + ": line " + std::to_string(line_); }
  /// Replaces values by the numbers of the line that was read last. Throws Error where something
  /// else is among them.
  void parse(std::string_view line, std::string_view separators, std::vector<double>* values) const;

 private:
  ByteReader bytes_;
  char end_ = '\n';
  std::uint64_t line_ = 0;
};

/// What separates the words of a line, where commas do not.
inline constexpr std::string_view kBlanks = " \t\r\v\f";

/// Takes the first word off a line; empty where there is none.
std::string_view take_word(std::string_view* line, std::string_view separators = kBlanks);

/// A number as programs write it, also "+1", "nan", "inf", "1.#QNAN"; what is too large becomes
/// infinite. False where the word is none.
bool to_number(std::string_view word, double* number);

/// A count in decimal digits. False where the word is none, or 2^63 or more.
bool to_count(std::string_view word, std::uint64_t* count);

/// A piece of a file for a message: in quotes, shortened, without what a terminal would obey.
std::string in_quotes(std::string_view text);

}  // namespace prefilter
