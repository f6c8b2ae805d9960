// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/build_table.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "prefilter/base/error.h"
#include "prefilter/base/parallel.h"
#include "prefilter/sampling/tables/certify.h"
#include "prefilter/sampling/tables/exchange_search.h"
#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {
namespace {

// Coefficients are rounded to multiples of its inverse: weights, about 1, are used as floats, and
// files become shorter.
constexpr double kCoefficientSteps = 1e9;

// Limit of a proof, in nodes times candidates per subdomain: about two minutes on two threads.
constexpr std::int64_t kMaxCertifyWork = 6'500'000'000;
constexpr double kSearchProgress = 0.1;  // share of the progress before proofs

TableSection empty_section(const TableShape& shape, int levels) {
  TableSection section;
  section.levels = levels;
  section.slices = levels == 1 ? 1 : shape.slices;
  const std::size_t subdomains =
      static_cast<std::size_t>(section.slices) * shape.subdomains_of_slice();
  section.texels.resize(subdomains * shape.texels);
  section.coefficients.resize(subdomains * shape.texels * shape.terms());
  section.errors.resize(subdomains);
  section.trilinear_errors.resize(subdomains);
  return section;
}

// Missing texels of a small set remain the cell's own, with weights of 0.
void store(const SubdomainSystem& system, const FittedSet& set, const TableShape& shape, int index,
           TableSection* section) {
  section->errors[index] = std::max(system.filter_error(set), 0.0);
  section->trilinear_errors[index] = system.trilinear_error;
  const std::size_t first = static_cast<std::size_t>(index) * shape.texels;
  const auto polynomials = static_cast<std::size_t>(system.polynomials());
  const auto terms = static_cast<std::size_t>(shape.terms());
  for (std::size_t i = 0; i < set.members.size(); ++i) {
    section->texels[first + i] = system.texels[set.members[i]];
    double* const coefficients = section->coefficients.data() + (first + i) * terms;
    std::fill_n(coefficients, terms, 0.0);
    for (std::size_t p = 0; p < polynomials; ++p) {
      for (std::size_t q = 0; q < terms; ++q) {
        coefficients[q] += set.weights[i * polynomials + p] * system.basis.coefficients[p][q];
      }
    }
    for (std::size_t q = 0; q < terms; ++q) {
      coefficients[q] = std::round(coefficients[q] * kCoefficientSteps) / kCoefficientSteps;
    }
  }
}

}  // namespace

SamplingTable build_sampling_table(const BuildTableOptions& options) {
  const TableShape& shape = options.shape;
  check_shape(shape);
  SamplingTable table;
  table.shape = shape;
  std::vector<std::pair<int, int>> subdomains;  // section, index
  for (int levels = 3; levels >= 1; --levels) {
    TableSection& section = table.sections[3 - levels];
    section = empty_section(shape, levels);
    for (std::size_t index = 0; index < section.errors.size(); ++index) {
      subdomains.emplace_back(3 - levels, static_cast<int>(index));
    }
  }
  std::vector<FittedSet> sets(subdomains.size());
  parallel_for(static_cast<std::int64_t>(subdomains.size()),
               options.run.part(0.0, options.certify ? kSearchProgress : 1.0), [&](std::int64_t i) {
                 const auto [number, index] = subdomains[i];
                 TableSection& section = table.sections[number];
                 const SubdomainSystem system(shape, section, index);
                 if (section.levels == 3 && system.candidates() < shape.texels) {
                   throw_invalid("texels: found " + std::to_string(shape.texels) + "; a part has " +
                                 std::to_string(system.candidates()) + " candidates only");
                 }
                 const int texels = std::min(shape.texels, system.candidates());
                 sets[i] = find_set(system, texels, Run());
                 store(system, sets[i], shape, index, &section);
               });
  if (!options.certify) return table;
  const auto count = static_cast<double>(subdomains.size());
  for (std::size_t i = 0; i < subdomains.size(); ++i) {
    const auto [number, index] = subdomains[i];
    TableSection& section = table.sections[number];
    const SubdomainSystem system(shape, section, index);
    const auto done = static_cast<double>(i);
    const Run run = options.run.part(kSearchProgress, 1.0).part(done / count, (done + 1.0) / count);
    const CertifiedSet certified =
        certify_set(system, sets[i], {kMaxCertifyWork / system.candidates(), run});
    store(system, certified.set, shape, index, &section);
    section.gaps.push_back(certified.gap);
  }
  return table;
}

double error_ratio(const TableSection& section) {
  const auto sum = [](const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
  };
  // Relative to the domain's volume, at most 1/8, and filters of about 1.
  constexpr double kNoError = 1e-12;
  const double error = sum(section.errors);
  const double trilinear = sum(section.trilinear_errors);
  if (trilinear > kNoError) return error / trilinear;
  return error > kNoError ? std::numeric_limits<double>::infinity() : 0.0;
}

}  // namespace prefilter
