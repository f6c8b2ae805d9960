// SPDX-License-Identifier: GPL-3.0-or-later

// Goes before SSE code of libsquish and of Convection Texture Tools, which uses the processor's
// estimate of a reciprocal: processors differ in it, and blocks are to be the same on all of them.
#pragma once

#include <xmmintrin.h>

#undef _mm_rcp_ps
#define _mm_rcp_ps(value) _mm_div_ps(_mm_set1_ps(1.0F), (value))
