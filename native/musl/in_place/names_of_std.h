// SPDX-License-Identifier: GPL-3.0-or-later

// Gives the names back that in_place_of_std.h replaces: for our own code in one unit with a
// library's.
#undef acos
#undef atan
#undef atan2
#undef cbrt
#undef cos
#undef cosf
#undef exp
#undef exp2
#undef expf
#undef log
#undef log2
#undef logf
#undef pow
#undef powf
#undef sin
#undef sinf
#undef tan
