// SPDX-License-Identifier: GPL-3.0-or-later

#include "fuzz/targets.h"

namespace prefilter {
namespace {

constexpr FuzzTarget kTargets[] = {
    {"ply", read_ply},   {"pcd", read_pcd},         {"ptx", read_ptx},     {"obj", read_obj},
    {"text", read_text}, {"blocks", read_blocks},   {"etc1s", read_etc1s}, {"zstd", read_zstd},
    {"path", read_path}, {"drawn_path", draw_path},
};

}  // namespace

std::span<const FuzzTarget> fuzz_targets() { return kTargets; }

}  // namespace prefilter
