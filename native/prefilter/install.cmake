# SPDX-License-Identifier: GPL-3.0-or-later

# What cmake --install leaves: the archive, public headers, what find_package(prefilter) reads, and all license texts.
include(CMakePackageConfigHelpers)
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/prefilter)

install(TARGETS prefilter EXPORT prefilterTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/native/include/prefilter DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT prefilterTargets NAMESPACE prefilter:: DESTINATION ${package_folder})
# Before 1.0 a new minor version may have other functions.
write_basic_package_version_file(prefilterConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES prefilterConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/prefilterConfigVersion.cmake
        DESTINATION ${package_folder})

install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
foreach(name IN LISTS linked_names)
  string(TOUPPER ${name} upper)
  file(GLOB texts ${PREFILTER_${upper}_SOURCE}/LICENSE* ${PREFILTER_${upper}_SOURCE}/NOTICE*)
  install(FILES ${texts} DESTINATION ${CMAKE_INSTALL_DOCDIR}/${name})
endforeach()
