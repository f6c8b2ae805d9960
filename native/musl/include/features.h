// SPDX-License-Identifier: GPL-3.0-or-later

// musl's own headers ask for it; not all systems have one.
#if __has_include_next(<features.h>)
#include_next <features.h>
#endif
