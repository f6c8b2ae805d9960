# SPDX-License-Identifier: GPL-3.0-or-later

# Builds for another system by the clang that zig brings, with that system's headers and libraries.
#
# PREFILTER_PLATFORM   Blender's name of it: linux-x64, linux-arm64, windows-x64 or macos-arm64
# PREFILTER_ZIG        the folder of the programs zig-cc, zig-c++, zig-ar and zig-ranlib; scripts/package makes it
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES PREFILTER_PLATFORM PREFILTER_ZIG)

# The oldest systems that Blender 4.2 runs on.
if(PREFILTER_PLATFORM STREQUAL "linux-x64")
  set(CMAKE_SYSTEM_NAME Linux)
  set(CMAKE_SYSTEM_PROCESSOR x86_64)
  set(triple x86_64-linux-gnu.2.28)
elseif(PREFILTER_PLATFORM STREQUAL "linux-arm64")
  set(CMAKE_SYSTEM_NAME Linux)
  set(CMAKE_SYSTEM_PROCESSOR aarch64)
  set(triple aarch64-linux-gnu.2.28)
  find_program(emulator qemu-aarch64 NO_CMAKE_FIND_ROOT_PATH)
elseif(PREFILTER_PLATFORM STREQUAL "windows-x64")
  set(CMAKE_SYSTEM_NAME Windows)
  set(CMAKE_SYSTEM_PROCESSOR x86_64)
  set(triple x86_64-windows-gnu)
  find_program(emulator NAMES wine64 wine PATHS /usr/lib/wine NO_CMAKE_FIND_ROOT_PATH)
elseif(PREFILTER_PLATFORM STREQUAL "macos-arm64")
  set(CMAKE_SYSTEM_NAME Darwin)
  set(CMAKE_SYSTEM_PROCESSOR arm64)
  set(triple aarch64-macos.11.0)
  set(CMAKE_OSX_SYSROOT "")
  set(CMAKE_OSX_DEPLOYMENT_TARGET "")
else()
  message(FATAL_ERROR "PREFILTER_PLATFORM: found '${PREFILTER_PLATFORM}'; allowed are linux-x64, linux-arm64, "
                      "windows-x64 and macos-arm64")
endif()

set(CMAKE_C_COMPILER ${PREFILTER_ZIG}/zig-cc)
set(CMAKE_CXX_COMPILER ${PREFILTER_ZIG}/zig-c++)
set(CMAKE_AR ${PREFILTER_ZIG}/zig-ar)
set(CMAKE_RANLIB ${PREFILTER_ZIG}/zig-ranlib)
set(CMAKE_C_COMPILER_TARGET ${triple})
set(CMAKE_CXX_COMPILER_TARGET ${triple})
# zig keeps them, unlike gcc and clang, and has a register less.
set(CMAKE_C_FLAGS_INIT -fomit-frame-pointer)
set(CMAKE_CXX_FLAGS_INIT -fomit-frame-pointer)
if(emulator)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${emulator})
endif()
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
