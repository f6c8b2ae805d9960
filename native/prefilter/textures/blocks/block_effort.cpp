// SPDX-License-Identifier: GPL-3.0-or-later

#include "prefilter/textures/block_effort.h"

#include "prefilter/base/names.h"

namespace prefilter {
namespace {

constexpr Named<BlockEffort> kEfforts[] = {
    {"fast", BlockEffort::kFast}, {"normal", BlockEffort::kNormal}, {"best", BlockEffort::kBest}};

}  // namespace

BlockEffort block_effort_named(const std::string& name) {
  return value_named("effort", name, kEfforts);
}

}  // namespace prefilter
