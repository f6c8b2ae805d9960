// SPDX-License-Identifier: GPL-3.0-or-later

// Each context of astcenc's fills the tables of all with the values that they have already, while
// others read them.
#include <astcenc_internal.h>

#define prepare_angular_tables fill_angular_tables
#include <astcenc_weight_align.cpp>
#undef prepare_angular_tables

void prepare_angular_tables() {
  [[maybe_unused]] static const bool are_filled = (fill_angular_tables(), true);
}
