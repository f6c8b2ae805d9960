#include "prefilter/outline/resolve.h"

#include "prefilter/outline/polygon_clipper.h"

namespace prefilter {

Outline resolve(const Outline& outline, FillRule rule, double tolerance) {
  return combine_polygons(flattened(outline, tolerance), rule, {}, rule, SetOperation::kUnion);
}

}  // namespace prefilter
