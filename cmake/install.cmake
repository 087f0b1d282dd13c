# Two components: `program` (voxtone, its helpers, manual, completion, data) and `development` (libraries, headers). Those
# of cmake/package.cmake are for CPack alone.
get_property(libraries GLOBAL PROPERTY VOXTONE_LIBRARIES)
install(TARGETS ${libraries} EXPORT voxtone-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
# Of headers those of cmake/public_headers.txt, and what they include.
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS cmake/public_headers.txt)
file(STRINGS cmake/public_headers.txt to_read REGEX "^[a-z]")
set(public_headers "")
while(to_read)
  list(POP_FRONT to_read header)
  if(NOT header IN_LIST public_headers)
    list(APPEND public_headers ${header})
    file(STRINGS ${header} includes REGEX "^#include \"[a-z_]+/")
    list(TRANSFORM includes REPLACE "^#include \"([^\"]+)\".*" "\\1")
    list(APPEND to_read ${includes})
  endif()
endwhile()
list(FILTER public_headers EXCLUDE REGEX "^hwy/")
foreach(header IN LISTS public_headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES ${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/voxtone/${folder} COMPONENT development)
endforeach()
foreach(component "program" "core;EXCLUDE_FROM_ALL")
  install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/voxtone COMPONENT ${component} PATTERN completion EXCLUDE)
endforeach()
install(EXPORT voxtone-targets NAMESPACE voxtone:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/voxtone COMPONENT development)

include(CMakePackageConfigHelpers)
list(TRANSFORM libraries REPLACE "^voxtone_" "" OUTPUT_VARIABLE VOXTONE_BUILT_FLOORS)
configure_package_config_file(cmake/voxtone-config.cmake.in voxtone-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/voxtone)
write_basic_package_version_file(voxtone-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/voxtone-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/voxtone-config-version.cmake
              cmake/libraries.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/voxtone COMPONENT development)
