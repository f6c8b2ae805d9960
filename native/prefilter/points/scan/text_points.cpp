// SPDX-License-Identifier: GPL-3.0-or-later

// Examines the first lines for separators, column names and column types.
#include "prefilter/points/scan/text_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/io/text_reader.h"
#include "prefilter/points/scan/point_fields.h"
#include "prefilter/points/scan/text_columns.h"

namespace prefilter {
namespace {

constexpr std::string_view kSeparators = " \t\r\v\f,;";
constexpr std::string_view kSeparatorsExceptComma = " \t\r\v\f;";  // without commas
constexpr std::size_t kSampledLines = 4096;
constexpr std::size_t kSampledBytes = 1 << 16;

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Whether a line has decimal commas: at least three words between other separators, each with at
// most one comma, which is between digits, and no decimal point. Also true for a line without
// commas.
bool has_decimal_commas(std::string_view line) {
  if (line.find('.') != std::string_view::npos) return false;
  int words = 0;
  for (std::string_view word = take_word(&line, kSeparatorsExceptComma); !word.empty();
       word = take_word(&line, kSeparatorsExceptComma)) {
    ++words;
    const std::size_t comma = word.find(',');
    if (comma == std::string_view::npos) continue;
    if (comma == 0 || comma + 1 == word.size() || !is_digit(word[comma - 1]) ||
        !is_digit(word[comma + 1]) || word.find(',', comma + 1) != std::string_view::npos) {
      return false;
    }
  }
  return words >= 3;
}

class TextPoints final : public PointSource {
 public:
  explicit TextPoints(const std::string& path) : text_(path) {
    analyze_bytes();
    analyze_lines();
    rewind();
  }

  // Unknown: a file may hold several clouds, each with its count.
  std::optional<std::size_t> count() const override { return std::nullopt; }
  bool has_normals() const override { return fields_.has_normals(); }
  const std::vector<PointAttribute>& attributes() const override { return fields_.attributes(); }
  bool is_double() const override { return fields_.is_double(); }

  void rewind() override {
    text_.go_to({begin_, 0});
    announced_ = 0;
    read_since_ = 0;
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
  // Parses the next line with a point; false at the end of the file.
  bool next_values() {
    std::string_view line;
    while (text_.next_line(&line)) {
      if (text_.line() == names_line_) continue;
      take_numbers(without_comment(line));
      if (values_.size() == 1) {
        take_count();
      } else if (!values_.empty()) {
        if (has_count_ && read_since_ == announced_) {
          throw_invalid(text_.where() + ": more points than the " + std::to_string(announced_) +
                        " that were announced");
        }
        ++read_since_;
        return true;
      }
    }
    check_count();
    return false;
  }

  static std::string_view without_comment(std::string_view line) {
    return line.substr(0, std::min(line.find('#'), line.find("//")));
  }

  void take_numbers(std::string_view line) {
    if (!has_decimal_commas_) return text_.parse(line, kSeparators, &values_);
    line_with_points_ = line;
    std::replace(line_with_points_.begin(), line_with_points_.end(), ',', '.');
    text_.parse(line_with_points_, kSeparatorsExceptComma, &values_);
  }

  void take_count() {
    check_count();
    if (!(values_[0] >= 0.0 && values_[0] < 9e15 && std::floor(values_[0]) == values_[0])) {
      throw_invalid(text_.where() +
                    ": found a single number that is not a count; a point needs x, y and z");
    }
    if (!has_count_ && read_since_ > 0) {
      throw_invalid(text_.where() + ": found 1 number; " + std::to_string(width_) +
                    " are needed, as before");
    }
    announced_ = static_cast<std::uint64_t>(values_[0]);
    read_since_ = 0;
    has_count_ = true;
  }

  void check_count() const {
    if (has_count_ && read_since_ < announced_) {
      throw_invalid(text_.where() + ": ends after " + std::to_string(read_since_) + " of the " +
                    std::to_string(announced_) + " points that were announced");
    }
  }

  // Determines the line ending, column names and decimal separator.
  void analyze_bytes() {
    const std::span<const std::byte> bytes = text_.bytes().peek(kSampledBytes);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
      throw_invalid(text_.name() + ": text in UTF-16; save it as UTF-8");
    }
    if (text.starts_with("\xEF\xBB\xBF")) begin_ = 3;
    if (text.find('\n') == std::string_view::npos && text.find('\r') != std::string_view::npos) {
      text_.set_line_end('\r');
    }
    rewind();
    find_names();
    find_decimal_commas();
    rewind();
  }

  // The first line, or a comment in it, may name the columns.
  void find_names() {
    std::string_view line;
    if (!text_.next_line(&line)) return;
    const std::size_t name = line.find_first_not_of("#/ \t");
    const bool is_comment = without_comment(line).empty() && name != std::string_view::npos;
    std::string_view rest = line;
    const std::string_view first = take_word(&rest, kSeparators);
    double number = 0.0;
    if (!is_comment && (first.empty() || to_number(first, &number))) return;
    std::vector<std::string> names = names_in(is_comment ? line.substr(name) : line);
    const auto has = [&](const char* axis) {
      return std::find(names.begin(), names.end(), axis) != names.end();
    };
    if (!has("x") || !has("y") || !has("z")) return;
    names_ = std::move(names);
    if (!is_comment) names_line_ = text_.line();
  }

  void find_decimal_commas() {
    constexpr int kLines = 64;
    bool has_commas = false;
    rewind();
    std::string_view line;
    for (int k = 0; k < kLines && text_.next_line(&line); ++k) {
      line = without_comment(line);
      std::string_view rest = line;
      take_word(&rest, kSeparators);
      // Skips empty lines and counts.
      if (text_.line() == names_line_ || take_word(&rest, kSeparators).empty()) continue;
      has_commas = has_commas || line.find(',') != std::string_view::npos;
      if (!has_decimal_commas(line)) return;
    }
    has_decimal_commas_ = has_commas;
  }

  void analyze_lines() {
    std::vector<TextColumn> columns;
    // Damage in later lines is reported on reading.
    for (std::size_t k = 0; k < kSampledLines && next_values(); ++k) {
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
    // A file without points still needs three columns.
    columns.resize(std::max<std::size_t>(columns.size(), 3));
    std::vector<ScanField> fields = named_fields(columns, names_);
    if (fields.empty()) fields = guessed_fields(columns);
    fields_ = PointFields(fields, text_.name());
  }

  TextReader text_;
  std::uint64_t begin_ = 0;       // after a byte order mark
  std::uint64_t names_line_ = 0;  // line with column names; 0 for none
  std::vector<std::string> names_;
  bool has_decimal_commas_ = false;
  std::string line_with_points_;  // the line with commas replaced
  PointFields fields_;
  std::size_t width_ = 0;
  std::vector<double> values_;
  // Number of points announced by a count, and read since.
  std::uint64_t announced_ = 0;
  std::uint64_t read_since_ = 0;
  bool has_count_ = false;
};

}  // namespace

std::unique_ptr<PointSource> open_text_points(const std::string& path) {
  return std::make_unique<TextPoints>(path);
}

}  // namespace prefilter
