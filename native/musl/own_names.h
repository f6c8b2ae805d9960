// SPDX-License-Identifier: GPL-3.0-or-later

// Names under which musl's functions are linked in, beside those of the C library at hand.
#pragma once

#include <math.h>

#define acos prefilter_acos
#define atan prefilter_atan
#define atan2 prefilter_atan2
#define cbrt prefilter_cbrt
#define cos prefilter_cos
#define exp prefilter_exp
#define exp2 prefilter_exp2
#define expm1 prefilter_expm1
#define log prefilter_log
#define log2 prefilter_log2
#define pow prefilter_pow
#define powf prefilter_powf
#define sin prefilter_sin
#define tan prefilter_tan

double acos(double);
double atan(double);
double atan2(double, double);
double cbrt(double);
double cos(double);
double exp(double);
double exp2(double);
double expm1(double);
double log(double);
double log2(double);
double pow(double, double);
float powf(float, float);
double sin(double);
double tan(double);

#define __cos prefilter_kernel_cos
#define __sin prefilter_kernel_sin
#define __tan prefilter_kernel_tan
#define __cosl prefilter_kernel_cosl
#define __sinl prefilter_kernel_sinl
#define __tanl prefilter_kernel_tanl
#define __rem_pio2 prefilter_rem_pio2
#define __rem_pio2_large prefilter_rem_pio2_large
#define __math_divzero prefilter_math_divzero
#define __math_divzerof prefilter_math_divzerof
#define __math_invalid prefilter_math_invalid
#define __math_invalidf prefilter_math_invalidf
#define __math_oflow prefilter_math_oflow
#define __math_oflowf prefilter_math_oflowf
#define __math_uflow prefilter_math_uflow
#define __math_uflowf prefilter_math_uflowf
#define __math_xflow prefilter_math_xflow
#define __math_xflowf prefilter_math_xflowf
#define __exp_data prefilter_exp_data
#define __exp2f_data prefilter_exp2f_data
#define __log_data prefilter_log_data
#define __log2_data prefilter_log2_data
#define __pow_log_data prefilter_pow_log_data
#define __powf_log2_data prefilter_powf_log2_data

// What musl's <features.h> has beside that of systems.
#define hidden __attribute__((__visibility__("hidden")))

// What one processor does in one step, all do in two.
#undef __FP_FAST_FMA
#undef __FP_FAST_FMAF
