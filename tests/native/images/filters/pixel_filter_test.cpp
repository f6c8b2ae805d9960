// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/images/pixel_filter.h"

#include <gtest/gtest.h>

namespace prefilter {
namespace {

TEST(PixelFilters, HaveEveryKernelOnceForEveryUse) {
  std::size_t count = 0;
  for (const PixelFilter& filter : pixel_filters()) {
    if (filter.kernel == nullptr) continue;
    EXPECT_EQ(filter.kernel, &kernels()[count++]);
    EXPECT_EQ(filter.kernel->name(), filter.name);
    EXPECT_EQ(filter.kernel->radius(), filter.radius);
    for (const Named<FilterUse>& use : kFilterUses) EXPECT_TRUE(filter.is_for(use.value));
  }
  EXPECT_EQ(count, kernels().size());
}

TEST(PixelFilters, ForLevelsAndSamplesAreKernels) {
  for (const FilterUse use : {FilterUse::kMipmap, FilterUse::kSampling}) {
    for (const PixelFilter& filter : filters_for(use)) EXPECT_NE(filter.kernel, nullptr);
  }
}

}  // namespace
}  // namespace prefilter
