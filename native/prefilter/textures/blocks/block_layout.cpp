// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/block_layout.h"

#include <algorithm>
#include <iterator>

#include "prefilter/base/names.h"

namespace prefilter {
namespace {

constexpr BlockLayout kLayouts[] = {
    {BlockFormat::kBc1, "bc1", 4, 4, 8, false},
    {BlockFormat::kBc1Rgb, "bc1-rgb", 4, 4, 8, false},
    {BlockFormat::kBc3, "bc3", 4, 4, 16, false},
    {BlockFormat::kBc4, "bc4", 4, 4, 8, false},
    {BlockFormat::kBc5, "bc5", 4, 4, 16, false},
    {BlockFormat::kBc6h, "bc6h", 4, 4, 16, true},
    {BlockFormat::kBc7, "bc7", 4, 4, 16, false},
    {BlockFormat::kEtc2Rgb, "etc2-rgb", 4, 4, 8, false},
    {BlockFormat::kEtc2Rgba, "etc2-rgba", 4, 4, 16, false},
    {BlockFormat::kEacR11, "eac-r11", 4, 4, 8, false},
    {BlockFormat::kEacRg11, "eac-rg11", 4, 4, 16, false},
    {BlockFormat::kAstc4x4, "astc-4x4", 4, 4, 16, false},
    {BlockFormat::kAstc6x6, "astc-6x6", 6, 6, 16, false},
    {BlockFormat::kAstc8x8, "astc-8x8", 8, 8, 16, false},
    {BlockFormat::kAstc4x4Hdr, "astc-4x4-hdr", 4, 4, 16, true},
    {BlockFormat::kAstc6x6Hdr, "astc-6x6-hdr", 6, 6, 16, true},
    {BlockFormat::kUastc, "uastc", 4, 4, 16, false},
};

}  // namespace

std::span<const BlockLayout> block_layouts() { return kLayouts; }

const BlockLayout& layout_of(BlockFormat format) {
  return *std::find_if(std::begin(kLayouts), std::end(kLayouts),
                       [format](const BlockLayout& one) { return one.format == format; });
}

const BlockLayout& layout_named(const std::string& name) {
  return element_named("format", name, kLayouts, &BlockLayout::name);
}

}  // namespace prefilter
