// SPDX-License-Identifier: GPL-3.0-or-later

// Goes before sources with SSE code on processors without it: they get the vectors of SIMDe, which
// follow x86-64 bit for bit, and no others.
#pragma once

#define SIMDE_ENABLE_NATIVE_ALIASES
#include <simde/x86/sse4.1.h>

// SIMDe rounds to the nearest whatever the mode is.
#undef _mm_cvtps_epi32
#define _mm_cvtps_epi32(value) \
  _mm_cvttps_epi32(simde_x_mm_round_ps((value), SIMDE_MM_FROUND_CUR_DIRECTION, 0))

// SIMDe wants constants as counts.
#undef _mm_slli_epi16
#undef _mm_slli_epi32
#undef _mm_srli_epi16
#undef _mm_srli_epi32
#define _mm_slli_epi16(value, count) _mm_sll_epi16((value), _mm_cvtsi32_si128(count))
#define _mm_slli_epi32(value, count) _mm_sll_epi32((value), _mm_cvtsi32_si128(count))
#define _mm_srli_epi16(value, count) _mm_srl_epi16((value), _mm_cvtsi32_si128(count))
#define _mm_srli_epi32(value, count) _mm_srl_epi32((value), _mm_cvtsi32_si128(count))

#define _MM_ROUND_NEAREST SIMDE_MM_ROUND_NEAREST
#define _MM_ROUND_DOWN SIMDE_MM_ROUND_DOWN
#define _MM_ROUND_UP SIMDE_MM_ROUND_UP
#define _MM_ROUND_TOWARD_ZERO SIMDE_MM_ROUND_TOWARD_ZERO

// What sources ask for.
#undef __ARM_NEON
#define __SSE2__ 1
#define __SSE4_1__ 1
