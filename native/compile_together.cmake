# SPDX-License-Identifier: GPL-3.0-or-later

# compile_together TARGET COUNT: compiles files of a folder COUNT at a time, as half of what each takes is in headers.
# Names in nameless namespaces are to differ within a folder, then. Each file compiles by itself, too, as it does with
# CMAKE_UNITY_BUILD=OFF; files with options of their own always do.
function(compile_together target count)
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    get_source_file_property(is_alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    if(NOT options AND NOT definitions AND NOT is_alone AND source MATCHES "([a-z_]+)/[a-z0-9_]+\\.cpp$")
      set(folder ${CMAKE_MATCH_1})
      math(EXPR files "${files_of_${folder}} + 0")
      math(EXPR group "${files} / ${count}")
      math(EXPR files_of_${folder} "${files} + 1")
      set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
    endif()
  endforeach()
  if(NOT DEFINED CMAKE_UNITY_BUILD)
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON)
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD_MODE GROUP)
  # It warns of a class with a member of a nameless namespace wherever that is not in the unit's own file.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()
