# SPDX-License-Identifier: GPL-3.0-or-later

# Makes the folder PACKAGE hold the FILES of the folder SOURCE, and of what else is there only the native module: a
# file or folder of an earlier layout could still be imported.
file(GLOB_RECURSE present LIST_DIRECTORIES true RELATIVE ${PACKAGE} ${PACKAGE}/*)
foreach(path IN LISTS present)
  set(wanted FALSE)
  foreach(file IN LISTS FILES)
    string(FIND "${file}/" "${path}/" position)
    if(position EQUAL 0)
      set(wanted TRUE)
    endif()
  endforeach()
  if(NOT wanted AND NOT path MATCHES "^_native[^/]*\\.(so|pyd)$")
    file(REMOVE_RECURSE ${PACKAGE}/${path})
  endif()
endforeach()
foreach(file IN LISTS FILES)
  configure_file(${SOURCE}/${file} ${PACKAGE}/${file} COPYONLY)
endforeach()
