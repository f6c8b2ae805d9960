// SPDX-License-Identifier: GPL-3.0-or-later

// Sums of shares of a few texels, wherever they are, whose squares a system minimizes too.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

#include "prefilter/base/image.h"
#include "prefilter/base/lanes.h"
#include "prefilter/base/progress.h"

namespace prefilter {

struct TexelLink {
  static constexpr int kMostTexels = 8;
  std::array<std::ptrdiff_t, kMostTexels> texels;  // as NinePointSystem::at has them
  std::array<float, kMostTexels> shares;
  int count = 0;
  float weight = 0.0F;  // of the square
};

/// The sum of the squares of links, as a form: what each texel has with itself and with others.
class LinkForm {
 public:
  LinkForm() = default;
  /// Leaves out links that read a texel that is not part of the system.
  LinkForm(const std::vector<TexelLink>& links, const std::function<bool(std::ptrdiff_t)>& is_part,
           const Progress& progress);

  bool empty() const { return texels_.empty(); }

  struct Texel {
    std::ptrdiff_t at = 0;
    float own = 0.0F;       // with itself
    std::size_t first = 0;  // of its entries, up to that of the next texel
  };
  struct Entry {
    std::ptrdiff_t at;
    float value;
  };
  /// In order of `at`, with one more behind the last.
  const std::vector<Texel>& texels() const { return texels_; }
  /// Those of a texel that texels() has at `k`, with the others.
  const Entry* begin(std::size_t k) const { return entries_.data() + texels_[k].first; }
  const Entry* end(std::size_t k) const { return entries_.data() + texels_[k + 1].first; }
  std::size_t entry_count() const { return entries_.size(); }

  /// The value for each channel of texels in the order of `at`.
  std::array<double, kMaxChannels> value(
      const std::function<const LaneValues&(std::ptrdiff_t)>& texel) const;

 private:
  std::vector<Texel> texels_;
  std::vector<Entry> entries_;
};

}  // namespace prefilter
