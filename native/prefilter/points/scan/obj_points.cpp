// SPDX-License-Identifier: GPL-3.0-or-later

// Vertices and normals are read by two cursors on the same file.
#include "prefilter/points/scan/obj_points.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/io/text_reader.h"
#include "prefilter/points/scan/point_fields.h"
#include "prefilter/points/scan/text_columns.h"

namespace prefilter {
namespace {

constexpr std::string_view kVertex = "v";
constexpr std::string_view kNormal = "vn";
constexpr std::size_t kColoredVertexNumbers = 6;
constexpr std::uint64_t kSampledVertices = 4096;

// Cursor over the lines of a file that begin with a keyword.
class KeywordLines {
 public:
  KeywordLines(const std::string& path, std::string_view keyword)
      : text_(path), keyword_(keyword) {}

  void rewind() { text_.go_to({}); }
  const std::string& name() const { return text_.name(); }
  std::string where() const { return text_.where(); }

  // Moves to the next such line; false at the end of the file.
  bool skip() {
    while (text_.next_line(&line_)) {
      if (take_word(&line_) == keyword_) return true;
    }
    return false;
  }

  // Parses the numbers of the next line, which must exist.
  void next(std::vector<double>* values) {
    if (!skip()) throw_invalid(name() + ": has changed while it was read");
    text_.parse(line_.substr(0, line_.find('#')), kBlanks, values);
  }

 private:
  TextReader text_;
  std::string_view keyword_;
  std::string_view line_;
};

class ObjPoints final : public PointSource {
 public:
  explicit ObjPoints(const std::string& path) : vertices_(path, kVertex), normals_(path, kNormal) {
    while (vertices_.skip()) ++count_;
    if (count_ == 0) throw_invalid(vertices_.name() + ": has no vertex, which is a line 'v x y z'");
    std::uint64_t normals = 0;
    while (normals <= count_ && normals_.skip()) ++normals;
    has_normals_ = normals == count_;
    rewind();
    analyze_vertices();
    rewind();
  }

  std::optional<std::size_t> count() const override { return static_cast<std::size_t>(count_); }
  bool has_normals() const override { return has_normals_; }
  const std::vector<PointAttribute>& attributes() const override { return fields_.attributes(); }
  bool is_double() const override { return fields_.is_double(); }

  void rewind() override {
    vertices_.rewind();
    normals_.rewind();
    done_ = 0;
  }

  bool read(std::size_t most, PointBatch* batch) override {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, count_ - done_));
    fields_.resize(count, batch);
    if (has_normals_) batch->normals.resize(count);
    for (std::size_t point = 0; point < count; ++point) {
      vertices_.next(&values_);
      check_width(vertices_, width_);
      for (std::size_t c = 3; c < values_.size(); ++c) values_[c] *= color_scale_;
      fields_.put_values(values_.data(), point, batch);
      if (has_normals_) put_normal(point, batch);
    }
    done_ += count;
    return count > 0;
  }

 private:
  void check_width(const KeywordLines& lines, std::size_t width) const {
    if (values_.size() == width) return;
    throw_invalid(lines.where() + ": found " + std::to_string(values_.size()) + " numbers; " +
                  std::to_string(width) + " are needed" + (width > 3 ? ", as before" : ""));
  }

  void put_normal(std::size_t point, PointBatch* batch) {
    normals_.next(&values_);
    check_width(normals_, 3);
    for (std::size_t a = 0; a < 3; ++a) {
      batch->normals[point][a] = static_cast<float>(values_[a]);
    }
  }

  void analyze_vertices() {
    std::vector<TextColumn> columns;
    for (std::uint64_t k = 0; k < std::min(count_, kSampledVertices); ++k) {
      vertices_.next(&values_);
      if (k == 0) {
        width_ = values_.size();
        if (width_ != 3 && width_ != 4 && width_ != kColoredVertexNumbers) {
          throw_invalid(vertices_.where() + ": found " + std::to_string(width_) +
                        " numbers; x, y and z, and none, one or a color after them, are needed");
        }
        columns.resize(width_);
      }
      check_width(vertices_, width_);
      for (std::size_t c = 0; c < width_; ++c) columns[c].include(values_[c]);
    }
    bool is_double = false;
    for (std::size_t a = 0; a < 3; ++a) is_double = is_double || columns[a].is_double;
    std::vector<ScanField> fields;
    for (const char* name : {"x", "y", "z"}) {
      const ScalarType type = is_double ? ScalarType::kDouble : ScalarType::kFloat;
      fields.push_back({name, type, fields.size(), 0});
    }
    // Programs write byte colors divided by 255; some write the bytes themselves.
    for (const char* name : {"red", "green", "blue"}) {
      if (width_ < kColoredVertexNumbers) break;
      if (columns[fields.size()].high > 1.0) color_scale_ = 1.0;
      fields.push_back({name, ScalarType::kUint8, fields.size(), 0});
    }
    fields_ = PointFields(fields, vertices_.name());
  }

  KeywordLines vertices_;
  KeywordLines normals_;
  PointFields fields_;
  std::uint64_t count_ = 0;
  std::uint64_t done_ = 0;
  bool has_normals_ = false;
  std::size_t width_ = 0;       // numbers per vertex
  double color_scale_ = 255.0;  // for the numbers after x, y and z
  std::vector<double> values_;
};

}  // namespace

std::unique_ptr<PointSource> open_obj_points(const std::string& path) {
  return std::make_unique<ObjPoints>(path);
}

}  // namespace prefilter
