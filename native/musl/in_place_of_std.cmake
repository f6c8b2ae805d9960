# SPDX-License-Identifier: GPL-3.0-or-later

# in_place_of_std TARGET [HEADER...]: the sources of another linked library call musl's functions in place of the C library's.
# HEADER is precompiled with them: one that many of the sources read.
function(in_place_of_std target)
  set(names ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/in_place_of_std.h)
  if(CMAKE_DISABLE_PRECOMPILE_HEADERS)
    target_compile_options(${target} PRIVATE -include ${names})
  else()
    target_precompile_headers(${target} PRIVATE ${names} ${ARGN})
  endif()
endfunction()
