#include "prefilter/blocks/block_layout.h"

#include <algorithm>
#include <iterator>

#include "prefilter/base/error.h"

namespace prefilter {
namespace {

constexpr BlockLayout kLayouts[] = {
    {BlockFormat::kBc1, "bc1", 4, 4, 8, false},
    {BlockFormat::kBc3, "bc3", 4, 4, 16, false},
    {BlockFormat::kBc4, "bc4", 4, 4, 8, false},
    {BlockFormat::kBc5, "bc5", 4, 4, 16, false},
};

}  // namespace

const BlockLayout& layout_of(BlockFormat format) {
  return *std::find_if(std::begin(kLayouts), std::end(kLayouts),
                       [format](const BlockLayout& one) { return one.format == format; });
}

const BlockLayout& layout_named(const std::string& name) {
  const auto* const found =
      std::find_if(std::begin(kLayouts), std::end(kLayouts),
                   [&name](const BlockLayout& one) { return name == one.name; });
  if (found != std::end(kLayouts)) return *found;
  std::string names;
  for (const BlockLayout& one : kLayouts)
    names += (names.empty() ? "" : ", ") + std::string(one.name);
  throw_invalid("format: '" + name + "' is not one of " + names);
}

}  // namespace prefilter
