# SPDX-License-Identifier: GPL-3.0-or-later

# find_package(prefilter) reads this: the target prefilter::prefilter is the static library.
include(CMakeFindDependencyMacro)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/prefilterTargets.cmake)
