// SPDX-License-Identifier: GPL-3.0-or-later

// Squared linear combinations of a few texels, as an additional term of a minimized form.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/run.h"

namespace prefilter {

struct TexelLink {
  static constexpr int kMaxLinkTexels = 8;
  std::array<std::ptrdiff_t, kMaxLinkTexels> texels;  // as in NinePointSystem::at
  std::array<float, kMaxLinkTexels> shares;
  int count = 0;
  float weight = 0.0F;  // of the squared combination
};

/// The sum of the squares of links as a quadratic form: a sparse symmetric matrix of texels.
class LinkForm {
 public:
  LinkForm() = default;
  /// Ignores links to texels that are not part of the system.
  LinkForm(const std::vector<TexelLink>& links, const std::function<bool(std::ptrdiff_t)>& is_part,
           const Run& run);

  bool empty() const { return texels_.empty(); }

  struct Texel {
    std::ptrdiff_t at = 0;
    float own = 0.0F;       // diagonal entry
    std::size_t first = 0;  // its first off-diagonal entry; they end where the next texel's begin
  };
  struct Entry {
    std::ptrdiff_t at;
    float value;
  };
  /// Sorted by `at`, with an additional end marker.
  const std::vector<Texel>& texels() const { return texels_; }
  /// The off-diagonal entries of texels()[k].
  const Entry* begin(std::size_t k) const { return entries_.data() + texels_[k].first; }
  const Entry* end(std::size_t k) const { return entries_.data() + texels_[k + 1].first; }
  std::size_t entry_count() const { return entries_.size(); }

  /// The value of the form for each channel; `texel(at)` returns texels.
  std::array<double, kMaxChannels> value(
      const std::function<const LaneValues&(std::ptrdiff_t)>& texel) const;

 private:
  std::vector<Texel> texels_;
  std::vector<Entry> entries_;
};

}  // namespace prefilter
