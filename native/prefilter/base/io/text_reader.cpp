// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/io/text_reader.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <limits>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr std::size_t kLongestLine = std::size_t{1} << 24;

// std::from_chars does not tell overflow from underflow.
double out_of_range(std::string_view word) {
  const std::size_t exponent = word.find_first_of("eE");
  const std::size_t digit = word.find_first_of("123456789");
  const std::size_t point = word.find('.');
  const bool is_small =
      exponent != std::string_view::npos ? word[exponent + 1] == '-' : digit > point;
  const double size = is_small ? 0.0 : std::numeric_limits<double>::infinity();
  return word.front() == '-' ? -size : size;
}

}  // namespace

bool TextReader::next_line(std::string_view* line) {
  std::size_t searched = 0;
  auto found = bytes_.peek(1);
  if (found.empty()) return false;
  ++line_;
  while (true) {
    const void* const end = std::memchr(found.data() + searched, end_, found.size() - searched);
    const char* const text = reinterpret_cast<const char*>(found.data());
    if (end != nullptr) {
      *line = {text, static_cast<std::size_t>(static_cast<const char*>(end) - text)};
      bytes_.skip(line->size() + 1);
      break;
    }
    searched = found.size();
    if (searched > kLongestLine) {
      throw_invalid(where() + " is longer than 16 MiB; this is not a text file");
    }
    found = bytes_.peek(std::max<std::size_t>(2 * searched, 256));
    if (found.size() == searched) {
      *line = {reinterpret_cast<const char*>(found.data()), searched};
      bytes_.skip(searched);
      break;
    }
  }
  if (line->ends_with('\r')) line->remove_suffix(1);
  return true;
}

bool TextReader::skip_line() {
  std::string_view line;
  return next_line(&line);
}

void TextReader::parse(std::string_view line, std::string_view separators,
                       std::vector<double>* values) const {
  values->clear();
  while (true) {
    const std::string_view word = take_word(&line, separators);
    if (word.empty()) return;
    double number = 0.0;
    if (!to_number(word, &number)) {
      throw_invalid(where() + ": found " + in_quotes(word) + "; a number is needed");
    }
    values->push_back(number);
  }
}

std::string_view take_word(std::string_view* line, std::string_view separators) {
  const auto is_separator = [&](char c) { return separators.find(c) != std::string_view::npos; };
  const auto begin = std::find_if_not(line->begin(), line->end(), is_separator);
  const auto end = std::find_if(begin, line->end(), is_separator);
  const std::string_view word(begin, end);
  *line = std::string_view(end, line->end());
  return word;
}

bool to_number(std::string_view word, double* number) {
  if (word.starts_with('+') && !word.starts_with("+-")) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, *number);
  if (error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) *number = out_of_range({word.data(), rest});
  const std::string_view more(rest, end);
  if (more.empty()) return true;
  // Written by Microsoft's C library.
  if (more.starts_with("#INF")) {
    *number *= std::numeric_limits<double>::infinity();
  } else if (more.starts_with("#IND") || more.starts_with("#QNAN") || more.starts_with("#SNAN")) {
    *number = std::numeric_limits<double>::quiet_NaN();
  } else {
    return false;
  }
  return true;
}

bool to_count(std::string_view word, std::uint64_t* count) {
  const char* const end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, *count);
  return error == std::errc() && rest == end && *count >> 63 == 0;
}

std::string in_quotes(std::string_view text) {
  constexpr std::size_t kLongest = 40;
  std::string result = "'";
  for (const char c : text.substr(0, kLongest)) result += c >= ' ' && c <= '~' ? c : '?';
  return result + (text.size() > kLongest ? "...'" : "'");
}

}  // namespace prefilter
