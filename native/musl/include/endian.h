// SPDX-License-Identifier: GPL-3.0-or-later

// Where the system has none, numbers have their lowest byte first.
#if __has_include_next(<endian.h>)
#include_next <endian.h>
#endif
