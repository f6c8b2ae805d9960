// SPDX-License-Identifier: GPL-3.0-or-later

// Meaning of the numbers that a file stores for each point.
#pragma once

#include <cstddef>
#include <optional>
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

/// Size in bytes.
std::size_t size_of(ScalarType type);

/// Loads a number from an unaligned address; `is_swapped` reverses its bytes.
double load_scalar(ScalarType type, bool is_swapped, const std::byte* bytes);

/// Factor from 16-bit colors to bytes.
inline constexpr double kDeepColorScale = 255.0 / 65535.0;

struct ScanField {
  std::string name;
  ScalarType type = ScalarType::kFloat;
  // Index among the numbers of a point (in text), and offset in its record in bytes.
  std::size_t index = 0;
  std::size_t offset = 0;
};

/// Converts points from a file's layout to batches. x, y, z are positions, nx, ny, nz normals and
/// confidence weights, after renaming by field_name; all other fields are attributes. 16-bit colors
/// become bytes.
class PointFields {
 public:
  PointFields() = default;
  /// Throws Error if x, y or z is missing, or two fields have the same name; `name` is the file's.
  PointFields(const std::vector<ScanField>& fields, const std::string& name);

  bool has_normals() const { return has_normals_; }
  bool is_double() const { return is_double_; }
  const std::vector<PointAttribute>& attributes() const { return attributes_; }

  /// Some files store bytes in 16-bit colors. Their scale must be set before reading if
  /// find_color_scale cannot determine it.
  bool has_deep_colors() const { return has_deep_colors_; }
  void set_color_scale(double scale) { color_scale_ = scale; }

  /// Allocates a batch for this many points.
  void resize(std::size_t count, PointBatch* batch) const;
  /// Stores the numbers of one point, ordered by the fields' indices.
  void put_values(const double* values, std::size_t point, PointBatch* batch) const;
  /// Stores points from records of `stride` bytes.
  void put_records(const std::byte* records, std::size_t stride, bool is_swapped, std::size_t first,
                   std::size_t count, PointBatch* batch) const;

 private:
  enum class Role { kPosition, kNormal, kWeight, kAttribute };
  struct Column {
    ScanField field;
    Role role = Role::kAttribute;
    std::size_t component = 0;  // axis, or index of the attribute
    bool is_deep = false;       // a 16-bit color
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

/// Index of the attribute with this name, or nothing.
std::optional<std::size_t> attribute_index(const std::vector<PointAttribute>& attributes,
                                           const std::string& name);

/// Determines whether 16-bit colors use all bits, from the first million points with a color.
/// `fields` are those of the source, which is rewound.
void find_color_scale(PointSource* source, PointFields* fields);

}  // namespace prefilter
