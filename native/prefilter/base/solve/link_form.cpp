// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/base/solve/link_form.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "prefilter/base/cancel_check.h"

namespace prefilter {

namespace {

// A link's coefficient of a texel.
struct LinkCoefficient {
  std::ptrdiff_t at;
  std::uint32_t link;
  float share;
};

// The coefficients of all links whose texels are all part of the system, sorted by texel.
std::vector<LinkCoefficient> coefficients_of(const std::vector<TexelLink>& links,
                                             const std::function<bool(std::ptrdiff_t)>& is_part,
                                             CancelCheck* cancel_check) {
  std::vector<LinkCoefficient> uses;
  for (std::size_t i = 0; i < links.size(); ++i) {
    cancel_check->step();
    const TexelLink& link = links[i];
    if (!(link.weight > 0.0F) ||
        !std::all_of(link.texels.begin(), link.texels.begin() + link.count, is_part)) {
      continue;
    }
    for (int k = 0; k < link.count; ++k) {
      uses.push_back({link.texels[k], static_cast<std::uint32_t>(i), link.shares[k]});
    }
  }
  std::stable_sort(uses.begin(), uses.end(),
                   [cancel_check](const LinkCoefficient& a, const LinkCoefficient& b) {
                     cancel_check->step();
                     return a.at < b.at;
                   });
  return uses;
}

struct Product {
  std::ptrdiff_t at;
  double value;
};

// The products of a texel with every other texel, from its links.
void find_products(const std::vector<TexelLink>& links, std::span<const LinkCoefficient> uses,
                   std::vector<Product>* products) {
  products->clear();
  for (const LinkCoefficient& use : uses) {
    const TexelLink& link = links[use.link];
    const double share = static_cast<double>(link.weight) * use.share;
    for (int k = 0; k < link.count; ++k) {
      products->push_back({link.texels[k], share * link.shares[k]});
    }
  }
  std::stable_sort(products->begin(), products->end(),
                   [](const Product& a, const Product& b) { return a.at < b.at; });
}

}  // namespace

LinkForm::LinkForm(const std::vector<TexelLink>& links,
                   const std::function<bool(std::ptrdiff_t)>& is_part, const Run& run) {
  CancelCheck cancel_check(run);
  const std::vector<LinkCoefficient> uses = coefficients_of(links, is_part, &cancel_check);
  std::vector<Product> products;
  for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    cancel_check.step();
    while (end < uses.size() && uses[end].at == uses[begin].at) ++end;
    find_products(links, std::span(uses).subspan(begin, end - begin), &products);
    Texel texel{uses[begin].at, 0.0F, entries_.size()};
    for (std::size_t i = 0, next = 0; i < products.size(); i = next) {
      double sum = 0.0;
      for (next = i; next < products.size() && products[next].at == products[i].at; ++next) {
        sum += products[next].value;
      }
      if (products[i].at == texel.at) {
        texel.own = static_cast<float>(sum);
      } else {
        entries_.push_back({products[i].at, static_cast<float>(sum)});
      }
    }
    texels_.push_back(texel);
  }
  if (!texels_.empty()) {
    texels_.push_back({std::numeric_limits<std::ptrdiff_t>::max(), 0.0F, entries_.size()});
  }
  entries_.shrink_to_fit();
}

std::array<double, kMaxChannels> LinkForm::value(
    const std::function<const LaneValues&(std::ptrdiff_t)>& texel) const {
  std::array<double, kMaxChannels> sums{};
  for (std::size_t k = 0; k + 1 < texels_.size(); ++k) {
    const Lanes own = texel(texels_[k].at).v;
    std::array<double, kMaxChannels> products;
    for (int c = 0; c < kMaxChannels; ++c)
      products[c] = static_cast<double>(texels_[k].own) * own[c];
    for (const Entry* entry = begin(k); entry != end(k); ++entry) {
      const Lanes other = texel(entry->at).v;
      for (int c = 0; c < kMaxChannels; ++c) {
        products[c] += static_cast<double>(entry->value) * other[c];
      }
    }
    for (int c = 0; c < kMaxChannels; ++c) sums[c] += own[c] * products[c];
  }
  return sums;
}

}  // namespace prefilter
