# The compiler cache, asked with paths from the root of the tree on, so that it answers for every clone; the second setting
# leaves the folder of the build out, the last lets it look through precompiled headers. GCC writes these with other bytes each
# time: what was compiled with one is found where the header itself came from the cache, as a second clone's does.
find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_ABSSTDERR=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()
# Not -Werror: what is compiled stays the command of a release, for which the cache may have an answer.
if(VOXTONE_WERROR)
  list(PREPEND CMAKE_CXX_COMPILER_LAUNCHER ${PROJECT_SOURCE_DIR}/cmake/warnings_are_errors)
endif()
include(cmake/libraries.cmake)

macro(voxtone_find)
  find_package(${ARGN} REQUIRED)
endmacro()
macro(voxtone_find_pkg target module)
  pkg_check_modules(${target} REQUIRED IMPORTED_TARGET ${module})
endmacro()
macro(voxtone_find_library name)
  find_library(VOXTONE_LIBRARY_${name} ${name} REQUIRED)
endmacro()
voxtone_floors_wanted(floors slicer io_codecs)
foreach(floor IN LISTS floors)
  cmake_language(CALL voxtone_libraries_of_${floor})
endforeach()
find_package(CLI11 CONFIG REQUIRED)

# Parts that a build may be without: those of packages.txt. Each leaves out its verbs, formats or tests, and says so.
set(VOXTONE_WITHOUT "" CACHE STRING "Parts to leave out although their libraries are there: pictures, drawings, vdb, calibration, tests")
set(voxtone_missing "")
macro(voxtone_find package)
  find_package(${package} ${ARGN} QUIET)
  if(NOT ${package}_FOUND)
    list(APPEND voxtone_missing ${package})
  endif()
endmacro()
macro(voxtone_find_pkg target module)
  pkg_check_modules(${target} QUIET IMPORTED_TARGET ${module})
  if(NOT ${target}_FOUND)
    list(APPEND voxtone_missing ${module})
  endif()
endmacro()
# voxtone_part(<part> <what goes with it>)  ->  VOXTONE_HAS_<part>; voxtone_missing says what was not found for it.
macro(voxtone_part part effect)
  if("${part}" IN_LIST VOXTONE_WITHOUT)
    list(APPEND voxtone_missing "asked for by VOXTONE_WITHOUT")
  endif()
  set(VOXTONE_HAS_${part} ON)
  if(voxtone_missing)
    set(VOXTONE_HAS_${part} OFF)
    list(JOIN voxtone_missing ", " named)
    message(STATUS "voxtone without ${part} (${named}): ${effect}; tools/install-packages ${part}")
    set(voxtone_missing "")
  endif()
endmacro()

cmake_language(CALL voxtone_libraries_of_io_openimageio)
voxtone_part(pictures "pictures other than PNG, JPEG and WebP are not read")

cmake_language(CALL voxtone_libraries_of_io_drawings)
voxtone_part(drawings "SVG drawings are not read")

# FindOpenVDB sets BUILD_SHARED_LIBS in its caller's scope; the block keeps that in.
block(PROPAGATE OpenVDB_FOUND)
  list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
  set(CMAKE_POLICY_DEFAULT_CMP0167 NEW)  # CMake 3.30: Boost is found by its own file
  find_package(OpenVDB 10.0 QUIET COMPONENTS openvdb)
endblock()
if(NOT OpenVDB_FOUND)
  list(APPEND voxtone_missing OpenVDB)
endif()
voxtone_part(vdb "no sparse VDB volumes, no surfaces of layered prints")

cmake_language(CALL voxtone_libraries_of_calibration)
if(NOT VOXTONE_HAS_pictures)
  list(APPEND voxtone_missing pictures)
endif()
voxtone_part(calibration "`voxtone calibrate` is left out")

if(BUILD_TESTING)
  voxtone_find(Catch2 CONFIG)  # 2.13, or 3 under its names: cmake/catch3
  voxtone_part(tests "no tests are built")
  set(BUILD_TESTING ${VOXTONE_HAS_tests})
endif()
if(BUILD_TESTING)
  include(Catch)
  # Each test that wants one of these, or a part that is missing, is left out and named (voxtone_add_test).
  find_package(valijson QUIET)  # proves data/schema
  find_package(assimp CONFIG QUIET)  # a second opinion on GLB, glTF and PLY files
  pkg_check_modules(LIB3MF QUIET IMPORTED_TARGET lib3MF)  # and on 3MF
endif()
if(VOXTONE_BENCHMARKS)
  find_package(benchmark QUIET)
  if(NOT benchmark_FOUND OR NOT VOXTONE_HAS_vdb OR NOT VOXTONE_HAS_calibration)
    message(STATUS "voxtone without benchmarks: they want every part and libbenchmark")
    set(VOXTONE_BENCHMARKS OFF)
  endif()
endif()
