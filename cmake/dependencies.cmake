find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE_PROGRAM})
endif()

macro(voxtone_find)
  find_package(${ARGN} REQUIRED)
endmacro()
include(cmake/libraries.cmake)
find_package(CLI11 CONFIG REQUIRED)

if(BUILD_TESTING)
  find_package(Catch2 2.13 CONFIG REQUIRED)
  include(Catch)
  find_package(valijson REQUIRED)  # proves data/schema
  find_package(assimp CONFIG REQUIRED)  # a second opinion on GLB, glTF and PLY files
  pkg_check_modules(LIB3MF REQUIRED IMPORTED_TARGET lib3MF)  # and on 3MF
endif()
if(VOXTONE_BENCHMARKS)
  find_package(benchmark REQUIRED)
endif()
