// SPDX-License-Identifier: GPL-3.0-or-later

// Steps of samples where they pass from one subdomain of a table to another.
#pragma once

#include "prefilter/sampling/sampling_table.h"

namespace prefilter {

/// The largest step of a sample of an image whose values are from 0 to 1, over all such images and
/// all borders of the section's subdomains: between two of them, between cells, and where the next
/// coarser level, of a section with a level more as far as there is one, becomes the cell's. For
/// weights of degree 2 over points of the borders, otherwise over all of them. Where the section
/// has three levels, integrals over the image are taken by the midpoint rule.
double largest_jump(const SamplingTable& table, int levels);

}  // namespace prefilter
