# SPDX-License-Identifier: GPL-3.0-or-later

# Builds for another system by the clang that zig brings, with that system's headers and libraries.
#
# PREFILTER_PLATFORM   Blender's name of it: a table of scripts/platforms.toml
# PREFILTER_ZIG        the folder of the programs zig-cc, zig-c++, zig-ar and zig-ranlib; scripts/package makes it
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PREFILTER_PLATFORM PREFILTER_ZIG)

include(${CMAKE_CURRENT_LIST_DIR}/platform.cmake)
read_platform("${PREFILTER_PLATFORM}")
if(NOT platform_target)
  message(FATAL_ERROR "PREFILTER_PLATFORM: found '${PREFILTER_PLATFORM}'; allowed are ${platform_names}")
endif()
set(CMAKE_SYSTEM_NAME ${platform_system})
set(CMAKE_SYSTEM_PROCESSOR ${platform_processor})
if(platform_emulator)
  find_program(emulator NAMES ${platform_emulator} PATHS /usr/lib/wine NO_CMAKE_FIND_ROOT_PATH)
endif()
if(platform_system STREQUAL "Darwin")
  set(CMAKE_OSX_SYSROOT "")
  set(CMAKE_OSX_DEPLOYMENT_TARGET "")
endif()

set(CMAKE_C_COMPILER ${PREFILTER_ZIG}/zig-cc)
set(CMAKE_CXX_COMPILER ${PREFILTER_ZIG}/zig-c++)
set(CMAKE_AR ${PREFILTER_ZIG}/zig-ar)
set(CMAKE_RANLIB ${PREFILTER_ZIG}/zig-ranlib)
set(CMAKE_C_COMPILER_TARGET ${platform_target})
set(CMAKE_CXX_COMPILER_TARGET ${platform_target})
# zig keeps them, unlike gcc and clang, and has a register less.
set(CMAKE_C_FLAGS_INIT -fomit-frame-pointer)
set(CMAKE_CXX_FLAGS_INIT -fomit-frame-pointer)
# Zig takes a precompiled header for an object, which it cannot link.
set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
if(emulator)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${emulator})
endif()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
