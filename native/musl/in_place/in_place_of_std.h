// SPDX-License-Identifier: GPL-3.0-or-later

// Included ahead of linked libraries' own sources, so that they call the same elementary functions
// on all systems.
#pragma once

#include <math.h>

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#include <complex>
#include <random>
#include <valarray>
extern "C" {
#endif

double prefilter_acos(double x);
double prefilter_atan(double x);
double prefilter_atan2(double y, double x);
double prefilter_cbrt(double x);
double prefilter_cos(double x);
double prefilter_exp(double x);
double prefilter_exp2(double x);
double prefilter_log(double x);
double prefilter_log2(double x);
double prefilter_pow(double x, double y);
float prefilter_powf(float x, float y);
double prefilter_sin(double x);
double prefilter_tan(double x);

static inline float prefilter_cosf(float x) { return (float)prefilter_cos(x); }
static inline float prefilter_expf(float x) { return (float)prefilter_exp(x); }
static inline float prefilter_logf(float x) { return (float)prefilter_log(x); }
static inline float prefilter_sinf(float x) { return (float)prefilter_sin(x); }

#ifdef __cplusplus
}
namespace std {
using ::prefilter_acos;
using ::prefilter_atan;
using ::prefilter_atan2;
using ::prefilter_cbrt;
using ::prefilter_cos;
using ::prefilter_exp;
using ::prefilter_exp2;
using ::prefilter_log;
using ::prefilter_log2;
using ::prefilter_pow;
using ::prefilter_sin;
using ::prefilter_tan;
}  // namespace std
#endif

#define acos prefilter_acos
#define atan prefilter_atan
#define atan2 prefilter_atan2
#define cbrt prefilter_cbrt
#define cos prefilter_cos
#define cosf prefilter_cosf
#define exp prefilter_exp
#define exp2 prefilter_exp2
#define expf prefilter_expf
#define log prefilter_log
#define log2 prefilter_log2
#define logf prefilter_logf
#define pow prefilter_pow
#define powf prefilter_powf
#define sin prefilter_sin
#define sinf prefilter_sinf
#define tan prefilter_tan
