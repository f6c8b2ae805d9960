// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/sampling_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include "prefilter/base/error.h"
#include "prefilter/base/names.h"
#include "prefilter/base/text.h"
#include "prefilter/images/kernel.h"

namespace prefilter {
namespace {

constexpr int kMaxTexelOffset = 64;
constexpr double kSumTolerance = 1e-6;

[[noreturn]] void refuse(const TableSection& section, const std::string& what) {
  throw_invalid("table: section of " + std::to_string(section.levels) + " levels: " + what);
}

void check_section(const TableShape& shape, const TableSection& section, int levels) {
  if (section.levels != levels || section.slices != (levels == 1 ? 1 : shape.slices)) {
    refuse(section, "found " + std::to_string(section.slices) +
                        " slices, in the place of that of " + std::to_string(levels) + " levels");
  }
  const auto subdomains = static_cast<std::size_t>(section.slices) * shape.subdomains_of_slice();
  const auto texels = static_cast<std::size_t>(shape.texels);
  const auto terms = static_cast<std::size_t>(shape.terms());
  if (section.texels.size() != subdomains * texels ||
      section.coefficients.size() != subdomains * texels * terms) {
    refuse(section, "found " + std::to_string(section.texels.size()) + " texels and " +
                        std::to_string(section.coefficients.size()) + " coefficients; " +
                        std::to_string(subdomains * texels) + " and " +
                        std::to_string(subdomains * texels * terms) + " are needed");
  }
  if (section.errors.size() != subdomains || section.trilinear_errors.size() != subdomains ||
      (!section.gaps.empty() && section.gaps.size() != subdomains)) {
    refuse(section, "found " + std::to_string(section.errors.size()) + " and " +
                        std::to_string(section.trilinear_errors.size()) + " errors and " +
                        std::to_string(section.gaps.size()) + " gaps of " +
                        std::to_string(subdomains) + " subdomains");
  }
  for (const TexelOffset& texel : section.texels) {
    if (texel.finer < 0 || texel.finer >= levels || std::abs(texel.x) > kMaxTexelOffset ||
        std::abs(texel.y) > kMaxTexelOffset) {
      refuse(section, "a texel at " + std::to_string(texel.x) + ", " + std::to_string(texel.y) +
                          " of level " + std::to_string(texel.finer) + " is out of reach");
    }
  }
  for (std::size_t subdomain = 0; subdomain < subdomains; ++subdomain) {
    for (std::size_t term = 0; term < terms; ++term) {
      double sum = 0.0;
      for (std::size_t i = 0; i < texels; ++i) {
        sum += section.coefficients[(subdomain * texels + i) * terms + term];
      }
      if (!(std::abs(sum - (term == 0 ? 1.0 : 0.0)) <= kSumTolerance)) {
        refuse(section, "the weights of subdomain " + std::to_string(subdomain) +
                            " do not sum to 1 everywhere");
      }
    }
  }
}

}  // namespace

FoldedPlace fold_place(double x, double y) {
  FoldedPlace place{x, y, x > 0.5, y > 0.5, false};
  if (place.mirror_x) place.x = 1.0 - x;
  if (place.mirror_y) place.y = 1.0 - y;
  place.swapped = place.y > place.x;
  if (place.swapped) std::swap(place.x, place.y);
  return place;
}

TexelOffset unfold(const TexelOffset& offset, const FoldedPlace& place) {
  TexelOffset unfolded = offset;
  if (place.swapped) std::swap(unfolded.x, unfolded.y);
  const int last = (1 << offset.finer) - 1;
  if (place.mirror_x) unfolded.x = last - unfolded.x;
  if (place.mirror_y) unfolded.y = last - unfolded.y;
  return unfolded;
}

int subdomain_of(const TableShape& shape, const TableSection& section, double x, double y,
                 double f) {
  const int last = shape.columns() - 1;
  const int i = std::min(static_cast<int>(x * shape.grid), last);
  const int j = std::min(static_cast<int>(y * shape.grid), last);
  const int slice = std::min(static_cast<int>(f * section.slices), section.slices - 1);
  return slice * shape.subdomains_of_slice() + i * (i + 1) / 2 + j;
}

double weight_at(const double* coefficients, int degree, double x, double y, double f) {
  double value = coefficients[0] + coefficients[1] * x + coefficients[2] * y + coefficients[3] * f;
  if (degree == 2) {
    value += coefficients[4] * x * x + coefficients[5] * y * y + coefficients[6] * f * f +
             coefficients[7] * x * y + coefficients[8] * x * f + coefficients[9] * y * f;
  }
  return value;
}

void check_shape(const TableShape& shape) {
  const auto check = [](const char* name, int found, int low, int high) {
    if (found < low || found > high) {
      throw_invalid(std::string(name) + ": found " + std::to_string(found) +
                    "; a whole number from " + std::to_string(low) + " to " + std::to_string(high) +
                    " is needed");
    }
  };
  kernel_named(shape.filter);
  if (!shape.target.empty()) element_named("target", shape.target, kernels(), &Kernel::name);
  check("texels", shape.texels, kMinTexels, kMaxTexels);
  check("subdomains", shape.grid, 1, kMaxParts);
  check("subdomains", shape.slices, 1, kMaxParts);
  check("degree", shape.degree, 1, 2);
  if (!(shape.ramp_weight >= 0.0 && shape.ramp_weight <= kMaxRampWeight)) {
    throw_invalid("ramp_weight: found " + to_text(shape.ramp_weight) +
                  "; a number from 0 to 1000000 is needed");
  }
}

void check_table(const SamplingTable& table) {
  check_shape(table.shape);
  for (int levels = 1; levels <= 3; ++levels) {
    check_section(table.shape, table.section(levels), levels);
  }
}

}  // namespace prefilter
