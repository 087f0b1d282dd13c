# Two components: `program` (voxtone, its helpers, manual, completion, data) and `development` (libraries, headers).
get_property(libraries GLOBAL PROPERTY VOXTONE_LIBRARIES)
install(TARGETS ${libraries} EXPORT voxtone-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(DIRECTORY base optics io calibration halftone slicer DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/voxtone COMPONENT development
        FILES_MATCHING PATTERN "*.h")
install(DIRECTORY data/ DESTINATION ${CMAKE_INSTALL_DATADIR}/voxtone COMPONENT program PATTERN completion EXCLUDE)
install(EXPORT voxtone-targets NAMESPACE voxtone:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/voxtone COMPONENT development)

include(CMakePackageConfigHelpers)
list(TRANSFORM libraries REPLACE "^voxtone_" "" OUTPUT_VARIABLE VOXTONE_BUILT_FLOORS)
configure_package_config_file(cmake/voxtone-config.cmake.in voxtone-config.cmake
                              INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/voxtone)
write_basic_package_version_file(voxtone-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/voxtone-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/voxtone-config-version.cmake
              cmake/libraries.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/voxtone COMPONENT development)
