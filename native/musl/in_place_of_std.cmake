# SPDX-License-Identifier: GPL-3.0-or-later

# in_place_of_std TARGET [HEADER...]: the sources of another linked library call musl's functions in place of the C
# library's. HEADER is precompiled with what says so: one that many of the sources read.
function(in_place_of_std target)
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/in_place)
  if(CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE -include in_place_of_std.h)
  else()
    target_precompile_headers(${target} PRIVATE <in_place_of_std.h> ${ARGN})
  endif()
endfunction()
