#include "prefilter/raster/paint.h"

namespace prefilter {

Paint Paint::transformed(const AffineMap2& map) const {
  Paint moved = *this;
  moved.to_shape = {map.linear(to_shape.x_axis), map.linear(to_shape.y_axis), map(to_shape.origin)};
  // The value at p is that which the old paint has where the map takes to p.
  const double determinant = cross(map.x_axis, map.y_axis);
  for (int c = 0; c < channels; ++c) {
    const double by_x = (map.y_axis.y * along_x[c] - map.x_axis.y * along_y[c]) / determinant;
    const double by_y = (map.x_axis.x * along_y[c] - map.y_axis.x * along_x[c]) / determinant;
    moved.along_x[c] = by_x;
    moved.along_y[c] = by_y;
    moved.constant[c] = constant[c] - by_x * map.origin.x - by_y * map.origin.y;
  }
  return moved;
}

}  // namespace prefilter
