// SPDX-License-Identifier: GPL-3.0-or-later

// One pass through the scans of a file; each scan has its own header.
#include "prefilter/points/scan/ptx_points.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/io/text_reader.h"
#include "prefilter/points/scan/point_fields.h"

namespace prefilter {
namespace {

constexpr std::size_t kPlainPtxNumbers = 4;    // numbers per point: x, y, z, intensity
constexpr std::size_t kColoredPtxNumbers = 7;  // and red, green, blue

class PtxPoints final : public PointSource {
 public:
  explicit PtxPoints(const std::string& path) : text_(path) {
    rewind();
    if (next_scan() && left_ > 0) {
      next_line();
      if (values_.size() != kPlainPtxNumbers && values_.size() != kColoredPtxNumbers) {
        throw_invalid(text_.where() + ": found " + std::to_string(values_.size()) +
                      " numbers; x, y, z, an intensity and no or three colors are needed");
      }
      width_ = values_.size();
    }
    std::vector<ScanField> fields;
    for (const char* name : {"x", "y", "z"}) {
      fields.push_back({name, ScalarType::kDouble, fields.size(), 0});
    }
    fields.push_back({"intensity", ScalarType::kFloat, fields.size(), 0});
    for (const char* name : {"red", "green", "blue"}) {
      if (fields.size() < width_) fields.push_back({name, ScalarType::kUint8, fields.size(), 0});
    }
    fields_ = PointFields(fields, text_.name());
    rewind();
  }

  // Unknown, as grid cells may have no point.
  std::optional<std::size_t> count() const override { return std::nullopt; }
  bool has_normals() const override { return false; }
  const std::vector<PointAttribute>& attributes() const override { return fields_.attributes(); }
  bool is_double() const override { return true; }

  void rewind() override {
    text_.go_to({});
    left_ = 0;
  }

  bool read(std::size_t most, PointBatch* batch) override {
    fields_.resize(0, batch);
    std::vector<Vector3> viewpoints;
    std::size_t size = 0;
    while (size < most && (left_ > 0 || next_scan())) {
      if (left_ == 0) continue;
      next_line();
      --left_;
      if (values_.size() != width_) {
        throw_invalid(text_.where() + ": found " + std::to_string(values_.size()) + " numbers; " +
                      std::to_string(width_) + " are needed, as before");
      }
      if (values_[0] == 0.0 && values_[1] == 0.0 && values_[2] == 0.0) continue;
      transform();
      fields_.resize(size + 1, batch);
      fields_.put_values(values_.data(), size, batch);
      viewpoints.push_back(matrix_[3]);
      ++size;
    }
    batch->viewpoints = std::move(viewpoints);
    return size > 0;
  }

 private:
  void next_line() {
    std::string_view line;
    if (!text_.next_line(&line)) {
      throw_invalid(text_.where() + ": the file ends before its last scan does");
    }
    text_.parse(line, kBlanks, &values_);
  }

  void read_head(std::size_t count, const char* what) {
    next_line();
    if (values_.size() != count) {
      throw_invalid(text_.where() + ": found " + std::to_string(values_.size()) + " numbers; " +
                    what);
    }
  }

  std::uint64_t read_count(const char* what) {
    read_head(1, what);
    constexpr double kMaxCount = 1e9;
    if (!(values_[0] >= 0.0 && values_[0] <= kMaxCount && std::floor(values_[0]) == values_[0])) {
      throw_invalid(text_.where() + ": no whole number from 0 to 1e9; " + what);
    }
    return static_cast<std::uint64_t>(values_[0]);
  }

  // Reads the header of the next scan; false at the end of the file. Empty lines may precede the
  // end.
  bool next_scan() {
    TextPlace begin = text_.place();
    std::string_view line;
    while (true) {
      if (!text_.next_line(&line)) return false;
      if (!take_word(&line).empty()) break;
      begin = text_.place();
    }
    text_.go_to(begin);
    const std::uint64_t columns = read_count("the number of columns of a scan is needed");
    left_ = columns * read_count("the number of rows of a scan is needed");
    // A line takes at least four digits with separators; the last line may lack its end.
    if (left_ > (text_.bytes().remaining() + 1) / (2 * kPlainPtxNumbers)) {
      throw_invalid(text_.where() + ": a scan of " + std::to_string(left_) + " lines; " +
                    std::to_string(text_.bytes().remaining()) + " bytes follow");
    }
    for (int k = 0; k < 4; ++k) read_head(3, "the scanner's place and its axes are needed");
    for (Vector3& row : matrix_) {
      read_head(4, "a row of the scan's matrix is needed");
      row = {values_[0], values_[1], values_[2]};
    }
    return true;
  }

  void transform() {
    Vector3 transformed = matrix_[3];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t a = 0; a < 3; ++a) transformed[a] += values_[r] * matrix_[r][a];
    }
    for (std::size_t a = 0; a < 3; ++a) values_[a] = transformed[a];
  }

  TextReader text_;
  PointFields fields_;
  std::size_t width_ = kPlainPtxNumbers;
  std::vector<double> values_;
  // The current scan: the first three columns of its matrix, whose last row is the scanner's
  // position, and the number of unread lines.
  std::array<Vector3, 4> matrix_{};
  std::uint64_t left_ = 0;
};

}  // namespace

std::unique_ptr<PointSource> open_ptx_points(const std::string& path) {
  return std::make_unique<PtxPoints>(path);
}

}  // namespace prefilter
