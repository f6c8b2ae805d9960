// SPDX-License-Identifier: GPL-3.0-or-later

// The grammar of SVG 1.1, section 8.3.9, and its error rule: everything before the first error is
// drawn.
#include "prefilter/shapes/path_data.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <numbers>

#include "prefilter/base/elementary.h"
#include "prefilter/base/io/text_reader.h"

namespace prefilter {
namespace {

constexpr std::string_view kCommands = "MmZzLlHhVvCcSsQqTtAa";

bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

constexpr std::array<bool, 256> kIsCommand = [] {
  std::array<bool, 256> is{};
  for (const char letter : kCommands) is[static_cast<unsigned char>(letter)] = true;
  return is;
}();
bool is_command(char c) { return kIsCommand[static_cast<unsigned char>(c)]; }

// Integers of up to this many digits are exact in a double, and so are the powers of ten.
constexpr std::size_t kExactDigits = 15;
constexpr std::array<double, kExactDigits + 1> kPowersOfTen = [] {
  std::array<double, kExactDigits + 1> powers{1.0};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = 10.0 * powers[i - 1];
  return powers;
}();

// The remaining text.
class Cursor {
 public:
  explicit Cursor(std::string_view text) : text_(text) {}

  bool empty() const { return text_.empty(); }
  char front() const { return text_.front(); }
  void skip(std::size_t count) { text_.remove_prefix(count); }
  void skip_blanks() { skip(run(0, is_blank)); }
  void skip_separator() {
    skip_blanks();
    if (empty() || front() != ',') return;
    skip(1);
    skip_blanks();
  }
  // Reads the longest number: a sign, digits with a decimal point, an exponent.
  bool take_number(double* number) {
    std::size_t end = !empty() && (front() == '+' || front() == '-') ? 1 : 0;
    std::uint64_t digits = 0;
    const std::size_t whole = take_digits(end, &digits);
    std::size_t fraction = 0;
    end += whole;
    if (end < text_.size() && text_[end] == '.') {
      fraction = take_digits(end + 1, &digits);
      end += 1 + fraction;
    }
    if (whole + fraction == 0) return false;
    const std::size_t exponent = exponent_size(end);
    if (exponent == 0 && whole + fraction <= kExactDigits) {
      // Both are exact, so the quotient is correctly rounded.
      const double size = static_cast<double>(digits) / kPowersOfTen[fraction];
      *number = front() == '-' ? -size : size;
    } else {
      end += exponent;
      to_number(text_.substr(0, end), number);
      if (!std::isfinite(*number)) return false;
    }
    skip(end);
    return true;
  }
  bool take_flag(bool* flag) {
    if (empty() || (front() != '0' && front() != '1')) return false;
    *flag = front() == '1';
    skip(1);
    return true;
  }

 private:
  template <typename Is>
  std::size_t run(std::size_t begin, const Is& is) const {
    std::size_t end = begin;
    while (end < text_.size() && is(text_[end])) ++end;
    return end - begin;
  }

  // Counts the digits from a position on, and appends them to a number.
  std::size_t take_digits(std::size_t begin, std::uint64_t* digits) const {
    std::size_t end = begin;
    for (; end < text_.size() && is_digit(text_[end]); ++end) {
      *digits = 10 * *digits + static_cast<std::uint64_t>(text_[end] - '0');
    }
    return end - begin;
  }

  // Length of the exponent at a position, including its letter; 0 if there is none.
  std::size_t exponent_size(std::size_t begin) const {
    if (begin == text_.size() || (text_[begin] != 'e' && text_[begin] != 'E')) return 0;
    std::size_t end = begin + 1;
    if (end < text_.size() && (text_[end] == '+' || text_[end] == '-')) ++end;
    const std::size_t digits = run(end, is_digit);
    return digits > 0 ? end + digits - begin : 0;
  }

  std::string_view text_;
};

// Converts path commands to steps.
class PathPen {
 public:
  PathPen(std::size_t most, PathSteps* steps) : most_(most), steps_(steps) {}

  // Draws a command as often as its arguments repeat. Returns whether all of them are valid.
  bool draw(char letter, std::string_view text) {
    const bool is_relative = letter >= 'a';
    const char name = is_relative ? letter : static_cast<char>(letter + ('a' - 'A'));
    if (!has_begun_ && name != 'm') return false;
    has_begun_ = true;
    if (name == 'a') return arcs(is_relative, text);
    if (name == 'z') {
      add('Z', {});
      at_ = begin_;
      mirrored_kind_ = ' ';
      return std::all_of(text.begin(), text.end(), is_blank);
    }
    return segments(name, is_relative, text);
  }

  bool has_too_many() const { return has_too_many_; }

 private:
  static std::size_t argument_count(char name) {
    switch (name) {
      case 'h':
      case 'v':
        return 1;
      case 'c':
        return 6;
      case 's':
      case 'q':
        return 4;
      default:
        return 2;
    }
  }

  void add(char letter, std::initializer_list<Point2> points) {
    if (steps_->letters.size() >= most_) {
      has_too_many_ = true;
      return;
    }
    steps_->letters.push_back(letter);
    for (const Point2& point : points) {
      steps_->numbers.push_back(point.x);
      steps_->numbers.push_back(point.y);
    }
  }

  void conic_to(const Point2& control, double weight, const Point2& end) {
    add('W', {});
    if (has_too_many_) return;
    for (const double number : {control.x, control.y, weight, end.x, end.y}) {
      steps_->numbers.push_back(number);
    }
  }

  bool segments(char name, bool is_relative, std::string_view text) {
    Cursor cursor(text);
    cursor.skip_blanks();
    const std::size_t count = argument_count(name);
    std::array<double, 6> numbers;
    std::size_t read_count = 0;
    bool is_any = false;
    while (!has_too_many_ && cursor.take_number(&numbers[read_count])) {
      cursor.skip_separator();
      if (++read_count < count) continue;
      segment(name, is_relative, numbers);
      if (name == 'm') name = 'l';
      read_count = 0;
      is_any = true;
    }
    return is_any && read_count == 0 && cursor.empty();
  }

  void segment(char name, bool is_relative, const std::array<double, 6>& numbers) {
    const Point2 from = is_relative ? at_ : Point2{};
    const auto point = [&](std::size_t i) -> Point2 {
      return {from.x + numbers[2 * i], from.y + numbers[2 * i + 1]};
    };
    Point2 end;
    char kind = ' ';
    Point2 control;
    switch (name) {
      case 'h':
        end = {from.x + numbers[0], at_.y};
        break;
      case 'v':
        end = {at_.x, from.y + numbers[0]};
        break;
      case 'c':
      case 's': {
        const Point2 first = name == 'c' ? point(0) : mirror('c');
        kind = 'c';
        control = point(name == 'c' ? 1 : 0);
        end = point(name == 'c' ? 2 : 1);
        add('C', {first, control, end});
        break;
      }
      case 'q':
      case 't':
        kind = 'q';
        control = name == 'q' ? point(0) : mirror('q');
        end = point(name == 'q' ? 1 : 0);
        add('Q', {control, end});
        break;
      default:
        end = point(0);
        break;
    }
    if (name == 'm') {
      add('M', {end});
      begin_ = end;
    } else if (kind == ' ') {
      add('L', {end});
    }
    mirrored_kind_ = kind;
    mirrored_ = control;
    at_ = end;
  }

  // The reflected control point of the previous curve if it is of the same kind, otherwise the
  // current point.
  Point2 mirror(char kind) const {
    if (mirrored_kind_ != kind) return at_;
    return {2.0 * at_.x - mirrored_.x, 2.0 * at_.y - mirrored_.y};
  }

  bool arcs(bool is_relative, std::string_view text) {
    mirrored_kind_ = ' ';
    Cursor cursor(text);
    cursor.skip_blanks();
    bool is_any = false;
    while (!has_too_many_ && !cursor.empty()) {
      std::array<double, 5> numbers;
      bool is_large = false;
      bool is_positive = false;
      const auto take = [&](std::size_t i) {
        const bool is_number = cursor.take_number(&numbers[i]);
        cursor.skip_separator();
        return is_number;
      };
      const auto take_flag = [&](bool* flag) {
        const bool is_flag = cursor.take_flag(flag);
        cursor.skip_separator();
        return is_flag;
      };
      if (!take(0) || !take(1) || !take(2) || !take_flag(&is_large) || !take_flag(&is_positive) ||
          !take(3) || !take(4)) {
        return false;
      }
      const Point2 to{numbers[3], numbers[4]};
      const Point2 end = is_relative ? at_ + to : to;
      arc_to({numbers[0], numbers[1]}, numbers[2], is_large, is_positive, end);
      at_ = end;
      is_any = true;
    }
    return is_any;
  }

  void arc_to(const Point2& radii, double rotation, bool is_large, bool is_positive,
              const Point2& end);

  std::size_t most_;
  PathSteps* steps_;
  bool has_begun_ = false;
  bool has_too_many_ = false;
  Point2 at_;
  Point2 begin_;
  char mirrored_kind_ = ' ';  // kind of the previous curve, if its control point may be reflected
  Point2 mirrored_;
};

void PathPen::arc_to(const Point2& radii, double rotation, bool is_large, bool is_positive,
                     const Point2& end) {
  double rx = std::abs(radii.x);
  double ry = std::abs(radii.y);
  const Point2 start = at_;
  if (start == end) return;
  if (rx == 0.0 || ry == 0.0) {
    add('L', {end});
    return;
  }
  const double angle = rotation * (std::numbers::pi / 180.0);
  const double cos = elementary::cos(angle);
  const double sin = elementary::sin(angle);
  const Point2 half = 0.5 * (start - end);
  // The start in the coordinates in which the ellipse is a unit circle and the chord's middle is
  // the origin.
  double x = (cos * half.x + sin * half.y) / rx;
  double y = (cos * half.y - sin * half.x) / ry;
  double squared = x * x + y * y;
  if (squared > 1.0) {
    const double size = std::sqrt(squared);
    rx *= size;
    ry *= size;
    x /= size;
    y /= size;
    squared = 1.0;
  }
  // The inverse of a smaller squared half chord overflows.
  constexpr double kMinSquared = 1e-300;
  if (!(squared >= kMinSquared && squared <= 1.0) || !std::isfinite(rx * ry)) {
    add('L', {end});
    return;
  }
  double toward_center = std::sqrt((1.0 - squared) / squared);
  if (is_large == is_positive) toward_center = -toward_center;
  const Point2 center{toward_center * y, -toward_center * x};
  const double first = elementary::atan2(y - center.y, x - center.x);
  double turn = elementary::atan2(-y - center.y, -x - center.x) - first;
  if (is_positive && turn <= 0.0) {
    turn += 2.0 * std::numbers::pi;
  } else if (!is_positive && turn >= 0.0) {
    turn -= 2.0 * std::numbers::pi;
  }
  const Point2 middle = 0.5 * (start + end);
  const auto placed = [&](double u, double v) -> Point2 {
    u = rx * (u + center.x);
    v = ry * (v + center.y);
    return {middle.x + cos * u - sin * v, middle.y + sin * u + cos * v};
  };
  const double quarters = std::ceil(std::abs(turn) / (std::numbers::pi / 2.0) - 1e-9);
  const int count = std::max(1, static_cast<int>(quarters));
  const double weight = elementary::cos(turn / count / 2.0);
  for (int k = 0; k < count; ++k) {
    const double peak = first + turn * (k + 0.5) / count;
    const double after = first + turn * (k + 1) / count;
    const Point2 control = placed(elementary::cos(peak) / weight, elementary::sin(peak) / weight);
    conic_to(control, weight,
             k == count - 1 ? end : placed(elementary::cos(after), elementary::sin(after)));
  }
}

// Parameters in (0, 1) at which the derivative of a coordinate is 0; returns their number.
int turns_of(std::span<const double> values, double weight, std::array<double, 2>* turns) {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  const double d0 = values[1] - values[0];
  const double d1 = values[2] - values[1];
  if (values.size() == 4) {
    const double d2 = values[3] - values[2];
    a = d0 - 2.0 * d1 + d2;
    b = 2.0 * (d1 - d0);
    c = d0;
  } else {
    // Derivative of a quotient of two quadratics; the weights at the ends are 1.
    const double d2 = values[2] - values[0];
    a = (weight - 1.0) * d2;
    b = d2 - 2.0 * weight * d0;
    c = weight * d0;
  }
  // The sum of the roots is -b / a, and their product c / a.
  const double discriminant = b * b - 4.0 * a * c;
  if (discriminant < 0.0) return 0;
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  const auto keep = [&](double above, double below) {
    const double t = above / below;
    if (below != 0.0 && t > 0.0 && t < 1.0) (*turns)[count++] = t;
  };
  keep(q, a);
  keep(c, q);
  return count;
}

double value_at(std::span<const double> values, double weight, double t) {
  const double s = 1.0 - t;
  if (values.size() == 4) {
    const std::array<double, 4> shares = {s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t};
    return shares[0] * values[0] + shares[1] * values[1] + shares[2] * values[2] +
           shares[3] * values[3];
  }
  const std::array<double, 3> shares = {s * s, 2.0 * weight * s * t, t * t};
  return (shares[0] * values[0] + shares[1] * values[1] + shares[2] * values[2]) /
         (shares[0] + shares[1] + shares[2]);
}

// Extends a box by the ends and extrema of curves.
class DrawnBox {
 public:
  void add(char letter, std::span<const double> numbers, bool is_drawn_from) {
    if (letter == 'Z') {
      at_ = begin_;
      return;
    }
    const Point2 end{numbers[numbers.size() - 2], numbers[numbers.size() - 1]};
    if (letter == 'M') begin_ = end;
    if (letter != 'M' || is_drawn_from) box_.include(end);
    if (letter == 'Q' || letter == 'C' || letter == 'W') add_extremes(letter, numbers);
    at_ = end;
  }
  const Box2& box() const { return box_; }

 private:
  void add_extremes(char letter, std::span<const double> numbers) {
    const double weight = letter == 'W' ? numbers[2] : 1.0;
    const std::size_t count = letter == 'C' ? 4 : 3;
    std::array<double, 4> x{at_.x};
    std::array<double, 4> y{at_.y};
    for (std::size_t i = 1; i < count; ++i) {
      // A conic's weight precedes its end point.
      const std::size_t place = 2 * (i - 1) + (letter == 'W' && i == 2 ? 1 : 0);
      x[i] = numbers[place];
      y[i] = numbers[place + 1];
    }
    const auto along_x = std::span<const double>(x).first(count);
    const auto along_y = std::span<const double>(y).first(count);
    for (const auto& along : {along_x, along_y}) {
      // A curve whose control points are between its ends is between them, too.
      const auto [low, high] = std::minmax(along.front(), along.back());
      if (std::all_of(along.begin(), along.end(),
                      [least = low, most = high](double v) { return v >= least && v <= most; })) {
        continue;
      }
      std::array<double, 2> turns;
      const int turn_count = turns_of(along, weight, &turns);
      for (int i = 0; i < turn_count; ++i) {
        box_.include({value_at(along_x, weight, turns[i]), value_at(along_y, weight, turns[i])});
      }
    }
  }

  Box2 box_;
  Point2 at_;
  Point2 begin_;
};

}  // namespace

int number_count(char letter) {
  switch (letter) {
    case 'M':
    case 'L':
      return 2;
    case 'Q':
      return 4;
    case 'W':
      return 5;
    case 'C':
      return 6;
    case 'Z':
      return 0;
    default:
      return -1;
  }
}

PathOutcome read_path_data(std::string_view text, std::size_t most, PathSteps* steps) {
  PathPen pen(most, steps);
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty()) {
    const char letter = text.front();
    if (!is_command(letter)) return PathOutcome::kBroken;
    text.remove_prefix(1);
    const auto at = std::find_if(text.begin(), text.end(), is_command);
    const auto end = static_cast<std::size_t>(at - text.begin());
    const bool is_valid = pen.draw(letter, text.substr(0, end));
    if (pen.has_too_many()) return PathOutcome::kTooMany;
    if (!is_valid) return PathOutcome::kBroken;
    text.remove_prefix(end);
  }
  return PathOutcome::kWhole;
}

bool read_numbers(std::string_view text, std::vector<double>* numbers) {
  Cursor cursor(text);
  cursor.skip_blanks();
  double number = 0.0;
  while (cursor.take_number(&number)) {
    numbers->push_back(number);
    cursor.skip_separator();
  }
  return cursor.empty();
}

Box2 drawn_box(std::string_view letters, std::span<const double> numbers) {
  DrawnBox drawn;
  std::size_t at = 0;
  for (std::size_t i = 0; i < letters.size(); ++i) {
    const auto count = static_cast<std::size_t>(number_count(letters[i]));
    const bool is_drawn_from = i + 1 < letters.size() && letters[i + 1] != 'M';
    drawn.add(letters[i], numbers.subspan(at, count), is_drawn_from);
    at += count;
  }
  return drawn.box();
}

}  // namespace prefilter
