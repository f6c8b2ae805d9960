// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/sampling/tables/bordered_rows.h"

#include <algorithm>
#include <cmath>

#include "prefilter/sampling/tables/subdomain_system.h"

namespace prefilter {

BorderedRows::BorderedRows(const SubdomainSystem& system, std::span<const int> members,
                           std::size_t sides)
    : rows(members.size() + 1), columns(rows + sides), values(rows * columns) {
  const std::size_t border = members.size();
  for (std::size_t i = 0; i < border; ++i) {
    const double* const products = system.products_of(members[i]);
    for (std::size_t j = 0; j < border; ++j) at(i, j) = products[members[j]];
    at(i, border) = 1.0;
    at(border, i) = 1.0;
  }
}

bool BorderedRows::eliminate(double least) {
  for (std::size_t k = 0; k < rows; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < rows; ++i) {
      if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
    }
    if (!(std::abs(at(pivot, k)) > least)) return false;
    if (pivot != k) std::swap_ranges(&at(k, 0), &at(k, 0) + columns, &at(pivot, 0));
    const double scale = 1.0 / at(k, k);
    for (std::size_t j = k; j < columns; ++j) at(k, j) *= scale;
    for (std::size_t i = 0; i < rows; ++i) {
      const double factor = at(i, k);
      if (i == k || factor == 0.0) continue;
      for (std::size_t j = k; j < columns; ++j) at(i, j) -= factor * at(k, j);
    }
  }
  return true;
}

}  // namespace prefilter
