// SPDX-License-Identifier: GPL-3.0-or-later

// What the numbers that a file keeps for each point mean.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "prefilter/points/point_source.h"

namespace prefilter {

enum class ScalarType {
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble
};

/// In bytes.
std::size_t size_of(ScalarType type);

/// The number at an address of any alignment; `is_swapped`: of the other endianness.
double load_scalar(ScalarType type, bool is_swapped, const std::byte* bytes);

/// What makes bytes of colors of 16 bits.
inline constexpr double kDeepColorScale = 255.0 / 65535.0;

struct ScanField {
  std::string name;
  ScalarType type = ScalarType::kFloat;
  // Of the value among the numbers of a point (for text), and in its record, in bytes.
  std::size_t index = 0;
  std::size_t offset = 0;
};

/// Turns points as they lie in a file into batches. Positions are x, y, z; normals are nx, ny, nz;
/// weights are named confidence, each as field_name has it. All others are attributes. Colors of 16
/// bits become bytes.
class PointFields {
 public:
  PointFields() = default;
  /// Throws Error where x, y or z is missing, or two fields have the same name; `name` is the
  /// file's.
  PointFields(const std::vector<ScanField>& fields, const std::string& name);

  bool has_normals() const { return has_normals_; }
  bool is_double() const { return is_double_; }
  const std::vector<PointAttribute>& attributes() const { return attributes_; }

  /// Colors of 16 bits of which only the lower 8 are used are bytes already. To be told before
  /// points are read, where find_color_scale has nothing to read.
  bool has_deep_colors() const { return has_deep_colors_; }
  void set_color_scale(double scale) { color_scale_ = scale; }

  /// Gives a batch the room for so many points.
  void resize(std::size_t count, PointBatch* batch) const;
  /// The numbers of one point, as they are numbered by the fields' indices.
  void put_values(const double* values, std::size_t point, PointBatch* batch) const;
  /// Points as records of `stride` bytes.
  void put_records(const std::byte* records, std::size_t stride, bool is_swapped, std::size_t first,
                   std::size_t count, PointBatch* batch) const;

 private:
  enum class Role { kPosition, kNormal, kWeight, kAttribute };
  struct Column {
    ScanField field;
    Role role = Role::kAttribute;
    std::size_t place = 0;  // the axis, or the number of the attribute
    bool is_deep = false;   // a color of 16 bits
  };

  void add(const ScanField& field);
  float to_byte(double value) const;
  void put_attribute(const Column& column, const std::byte* from, std::size_t stride,
                     bool is_swapped, std::size_t point, std::size_t count,
                     PointBatch* batch) const;

  std::vector<Column> columns_;
  std::vector<PointAttribute> attributes_;
  bool has_normals_ = false;
  bool has_weights_ = false;
  bool is_double_ = false;
  bool has_deep_colors_ = false;
  double color_scale_ = kDeepColorScale;
};

/// Finds out by the first million of points with a color how many bits of 16 these have; `fields`
/// are those of the source, which then is at its first point.
void find_color_scale(PointSource* source, PointFields* fields);

}  // namespace prefilter
