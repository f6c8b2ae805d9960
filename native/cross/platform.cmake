# SPDX-License-Identifier: GPL-3.0-or-later

# read_platform(NAME): sets platform_<key> for each string of that table in scripts/platforms.toml; platform_names to the
# names of all.
function(read_platform wanted)
  file(STRINGS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../scripts/platforms.toml lines)
  set(names)
  set(name)
  foreach(line IN LISTS lines)
    if(line MATCHES "^\\[(.+)\\]$")
      set(name ${CMAKE_MATCH_1})
      list(APPEND names ${name})
    elseif(name STREQUAL wanted AND line MATCHES "^([a-z0-9]+) = \"(.*)\"$")
      set(platform_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}" PARENT_SCOPE)
    endif()
  endforeach()
  set(platform_names ${names} PARENT_SCOPE)
endfunction()
