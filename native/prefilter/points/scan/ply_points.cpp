// SPDX-License-Identifier: GPL-3.0-or-later

// Binary elements without lists are read as raw records, others row by row.
#include "prefilter/points/scan/ply_points.h"

#include <algorithm>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/points/scan/ply_file.h"
#include "prefilter/points/scan/splat_points.h"

namespace prefilter {
namespace {

std::size_t vertex_element(const PlyFile& file) {
  const std::size_t element = file.find("vertex");
  if (element == file.elements().size()) {
    throw_invalid(file.name() + ": there is no element 'vertex' in its header");
  }
  return element;
}

PointFields fields_of(const PlyElement& element, const std::string& name) {
  std::vector<ScanField> fields;
  std::size_t offset = 0;  // meaningless if there are lists
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (!property.count_type) fields.push_back({property.name, property.type, i, offset});
    offset += size_of(property.type);
  }
  return {fields, name};
}

// Warning about data after the announced points.
std::vector<std::string> warnings_of(const std::string& surplus) {
  if (surplus.empty()) return {};
  return {surplus + "; the rest was not read"};
}

class PlyPoints final : public PointSource {
 public:
  explicit PlyPoints(ByteReader bytes)
      : file_(std::move(bytes)),
        element_(vertex_element(file_)),
        fields_(fields_of(file_.elements()[element_], file_.name())),
        has_records_(!file_.is_text() && !file_.elements()[element_].has_lists()),
        end_(size()) {
    find_color_scale(this, &fields_);
    rewind();
  }

  std::optional<std::size_t> count() const override { return end_ - begin_; }
  bool has_normals() const override { return fields_.has_normals(); }
  const std::vector<PointAttribute>& attributes() const override { return fields_.attributes(); }
  bool is_double() const override { return fields_.is_double(); }
  std::vector<std::string> warnings() const override { return warnings_of(surplus_); }

  std::optional<std::size_t> rows() const override {
    return has_records_ ? std::optional(size()) : std::nullopt;
  }
  void choose_rows(std::size_t begin, std::size_t end) override {
    begin_ = begin;
    end_ = end;
    rewind();
  }

  void rewind() override {
    file_.go_to(element_);
    if (begin_ > 0) file_.skip_records(begin_);
  }

  bool read(std::size_t most, PointBatch* batch) override {
    const std::uint64_t left = file_.rows_left() - (size() - end_);
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(most, left));
    fields_.resize(count, batch);
    const std::size_t stride = file_.elements()[element_].row_size();
    for (std::size_t point = 0; point < count;) {
      if (has_records_) {
        const auto records = file_.read_records(count - point);
        const std::size_t some = records.size() / stride;
        fields_.put_records(records.data(), stride, file_.is_swapped(), point, some, batch);
        point += some;
      } else {
        file_.read_row();
        fields_.put_values(file_.scalars().data(), point, batch);
        ++point;
      }
    }
    if (file_.rows_left() == 0) surplus_ = file_.surplus();
    return count > 0;
  }

 private:
  std::size_t size() const { return static_cast<std::size_t>(file_.elements()[element_].count); }

  PlyFile file_;
  std::size_t element_;
  PointFields fields_;
  bool has_records_;
  std::string surplus_;
  std::size_t begin_ = 0;
  std::size_t end_;
};

}  // namespace

std::unique_ptr<PointSource> open_ply_points(const std::string& path) {
  return open_ply_points(ByteReader(path));
}

std::unique_ptr<PointSource> open_ply_points(ByteReader bytes) {
  return as_points_of_splats(std::make_unique<PlyPoints>(std::move(bytes)));
}

}  // namespace prefilter
