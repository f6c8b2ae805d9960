// SPDX-License-Identifier: GPL-3.0-or-later

// What the numbers that a file keeps for each point mean.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "prefilter/scan/point_source.h"

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

struct ScanField {
  std::string name;
  ScalarType type = ScalarType::kFloat;
  // Of the value among the numbers of a point (for text), and in its record, in bytes.
  std::size_t index = 0;
  std::size_t offset = 0;
};

/// Turns points as they lie in a file into batches. Positions are x, y, z; normals are nx, ny, nz,
/// or normal_x and so on; weights are named confidence. All others are attributes.
class PointFields {
 public:
  PointFields() = default;
  /// Throws Error where x, y or z is missing, or two fields have the same name; `name` is the
  /// file's.
  PointFields(const std::vector<ScanField>& fields, const std::string& name);

  bool has_normals() const { return has_normals_; }
  bool is_double() const { return is_double_; }
  const std::vector<PointAttribute>& attributes() const { return attributes_; }

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
  };

  std::vector<Column> columns_;
  std::vector<PointAttribute> attributes_;
  bool has_normals_ = false;
  bool has_weights_ = false;
  bool is_double_ = false;
};

}  // namespace prefilter
