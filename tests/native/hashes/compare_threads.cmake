# SPDX-License-Identifier: GPL-3.0-or-later

# Fails unless PROGRAM, a list of words, prints the same with one thread and with several.
foreach(threads 1 3)
  execute_process(COMMAND ${PROGRAM} ${threads} OUTPUT_VARIABLE hashes_of_${threads} RESULT_VARIABLE status)
  if(NOT status EQUAL 0 OR hashes_of_${threads} STREQUAL "")
    message(FATAL_ERROR "${PROGRAM} ${threads}: ${status}")
  endif()
endforeach()
if(NOT hashes_of_1 STREQUAL hashes_of_3)
  message(FATAL_ERROR "with one thread:\n${hashes_of_1}\nwith three:\n${hashes_of_3}")
endif()
