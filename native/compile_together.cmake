# SPDX-License-Identifier: GPL-3.0-or-later

# compile_together TARGET ROOT COUNT [ALWAYS]: compiles files of a folder COUNT at a time, as much of what each takes is in
# headers. ROOT is a folder that holds them all, and is searched for headers.
#
# Names in nameless namespaces are to differ within a folder, then. Each file compiles by itself, too, as it does with
# CMAKE_UNITY_BUILD=OFF unless ALWAYS is given; files with options of their own always do. CMake's own units name files by
# whole paths, so that ccache would find nothing of another checkout.
function(compile_together target root count)
  if(NOT "${ARGN}" STREQUAL ALWAYS AND DEFINED CMAKE_UNITY_BUILD AND NOT CMAKE_UNITY_BUILD)
    return()
  endif()
  # It warns of a class with a member of a nameless namespace wherever that is not in the unit's own file.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  get_target_property(sources ${target} SOURCES)
  get_target_property(here ${target} SOURCE_DIR)
  set(units)
  foreach(source IN LISTS sources)
    get_source_file_property(options ${source} COMPILE_OPTIONS)
    get_source_file_property(definitions ${source} COMPILE_DEFINITIONS)
    get_source_file_property(is_alone ${source} SKIP_UNITY_BUILD_INCLUSION)
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${here} OUTPUT_VARIABLE path)
    if(NOT options AND NOT definitions AND NOT is_alone AND path MATCHES "([a-z_]+)/[a-z0-9_]+\\.cpp$")
      set(folder ${CMAKE_MATCH_1})
      math(EXPR files "${files_of_${folder}} + 0")
      math(EXPR unit "${files} / ${count}")
      math(EXPR files_of_${folder} "${files} + 1")
      set(unit ${folder}_${unit})
      list(APPEND units ${unit})
      cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${root})
      string(APPEND text_of_${unit} "#include \"${path}\"\n")
      set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
    endif()
  endforeach()
  list(REMOVE_DUPLICATES units)
  foreach(unit IN LISTS units)
    set(file ${CMAKE_CURRENT_BINARY_DIR}/units/${unit}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${text_of_${unit}}")
    target_sources(${target} PRIVATE ${file})
  endforeach()
endfunction()
