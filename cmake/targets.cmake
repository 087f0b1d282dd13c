# One library per floor, rooms as its folders; one test program per floor (more where a dependency is slow to load).

set(VOXTONE_FLOORS base optics io calibration halftone slicer scattering farm cli)
if(NOT VOXTONE_HAS_calibration)
  list(REMOVE_ITEM VOXTONE_FLOORS calibration)
endif()

add_library(voxtone_flags INTERFACE)
# An include is spelled as the tree is: "optics/layered/phase.h".
target_include_directories(voxtone_flags INTERFACE ${PROJECT_SOURCE_DIR})
# -ffp-contract=off: the same bits with and without fused multiply-add, so that a result does not depend on the machine.
# -ffile-prefix-map: no path of the machine that built it in a program; the compiler cache names files from the build on.
file(RELATIVE_PATH root_from_build ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR}/)
target_compile_options(voxtone_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off
                                               "-ffile-prefix-map=${PROJECT_SOURCE_DIR}/="
                                               "-ffile-prefix-map=${root_from_build}=")
# Libraries that a program does not use are not loaded: OpenImageIO's 262 alone cost 0.4 s of a processor at every start.
target_link_options(voxtone_flags INTERFACE -Wl,--as-needed)
if(VOXTONE_SANITIZE)
  # The check of virtual tables asks the kernel what memory is readable; in a guarded reader the sandbox refuses, and
  # every object looks broken. Those of null, alignment and sizes of objects double the time of compilation; what they
  # would find is mostly the address sanitizer's, too. TBB's headers hold fences that the thread sanitizer does not see,
  # and a warning says so: base/parallel.h does without TBB under it.
  target_compile_options(voxtone_flags INTERFACE -fsanitize=${VOXTONE_SANITIZE} -fno-sanitize=vptr,null,alignment,object-size -fno-omit-frame-pointer -g1 -Wno-tsan)
  target_link_options(voxtone_flags INTERFACE -fsanitize=${VOXTONE_SANITIZE})
endif()

# voxtone_add_floor(<floor> PUBLIC <library>... PRIVATE <library>...)  ->  target voxtone_<floor>, alias voxtone::<floor>
# A static library, or with VOXTONE_SHARED a shared one, whose ABI holds for 0.2.x; its rooms are added by voxtone_add_rooms and link what the floor links.
# An installed tree has its headers below include/voxtone, and both are looked in: users write <voxtone/optics/...>.
function(voxtone_add_floor floor)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  if(VOXTONE_SHARED)
    add_library(voxtone_${floor} SHARED)
  else()
    add_library(voxtone_${floor} STATIC)
  endif()
  add_library(voxtone::${floor} ALIAS voxtone_${floor})
  target_include_directories(voxtone_${floor} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                             "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR};${CMAKE_INSTALL_INCLUDEDIR}/voxtone>")
  target_compile_features(voxtone_${floor} PUBLIC cxx_std_20)
  target_link_libraries(voxtone_${floor} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:voxtone_flags>)
  set_target_properties(voxtone_${floor} PROPERTIES EXPORT_NAME ${floor} POSITION_INDEPENDENT_CODE ON
                        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  set_property(GLOBAL APPEND PROPERTY VOXTONE_LIBRARIES voxtone_${floor})
endfunction()

# voxtone_want(<target> <program or module>...): it builds those of them that this build has.
function(voxtone_want target)
  foreach(helper IN LISTS ARGN)
    if(TARGET ${helper})
      add_dependencies(${target} ${helper})
    endif()
  endforeach()
endfunction()

# voxtone_add_rooms(<floor> <room>... [LIGHT | PARSES] [ALONE <room>/<name>...] [WITHOUT <room>/<name>...])
# The sources in these folders of the caller go into the floor's library. With VOXTONE_UNITY they are one unit of compilation,
# for what they share is parsed and instantiated once: rooms that lie side by side, as many as compile in half a minute; a
# name of an unnamed namespace is theirs together. LIGHT: nothing in them runs long, so it is optimised less (-O1), which takes
# two thirds of the time to compile. PARSES: they read, decide and call what computes (-O2). ALONE: files that are a unit of
# their own (Highway compiles such a file once for each width of vectors by including it again; templates over types of the
# file's own warn elsewhere). WITHOUT: another target's.
function(voxtone_add_rooms floor)
  cmake_parse_arguments(ARG "LIGHT;PARSES" "" "ALONE;WITHOUT" ${ARGN})
  set(rooms ${ARG_UNPARSED_ARGUMENTS})
  list(GET rooms 0 first)
  set(sources "")
  foreach(room IN LISTS rooms)
    file(GLOB of_room CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${room}/*.cpp)
    list(APPEND sources ${of_room})
  endforeach()
  list(TRANSFORM ARG_ALONE APPEND ".cpp")
  list(TRANSFORM ARG_WITHOUT APPEND ".cpp")
  list(REMOVE_ITEM sources ${ARG_WITHOUT})
  set(target voxtone_${floor}_${first})
  add_library(${target} OBJECT ${sources})
  target_link_libraries(${target} PRIVATE voxtone_flags $<TARGET_PROPERTY:voxtone_${floor},LINK_LIBRARIES>)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON UNITY_BUILD ${VOXTONE_UNITY} UNITY_BUILD_BATCH_SIZE 0)
  set_source_files_properties(${ARG_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  if(ARG_LIGHT)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
  elseif(ARG_PARSES)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O2>)
  endif()
  target_sources(voxtone_${floor} PRIVATE $<TARGET_OBJECTS:${target}>)
endfunction()

# voxtone_add_generated(<target> <name> <definition>...)
# A source of the target that cmake/write_<name>.cmake makes at every build; it is compiled where it has changed.
function(voxtone_add_generated target name)
  set(file ${PROJECT_BINARY_DIR}/generated/${name}.cpp)
  if(NOT TARGET ${name})
    add_custom_target(${name} BYPRODUCTS ${file} VERBATIM
                      COMMAND ${CMAKE_COMMAND} -DROOT=${PROJECT_SOURCE_DIR} -DOUTPUT=${file} ${ARGN}
                              -P ${PROJECT_SOURCE_DIR}/cmake/write_${name}.cmake
                      COMMENT "Looking what this build is made of: ${name}")
  endif()
  set_source_files_properties(${file} TARGET_DIRECTORY ${target} PROPERTIES GENERATED ON SKIP_UNITY_BUILD_INCLUSION ON)
  target_sources(${target} PRIVATE ${file})
  add_dependencies(${target} ${name})
endfunction()

# The Debian package of a helper program or module; `core` is voxtone itself.
set(VOXTONE_PACKAGE_OF_voxtone-read-pictures pictures)
set(VOXTONE_PACKAGE_OF_voxtone-photographs pictures)
set(VOXTONE_PACKAGE_OF_voxtone-read-drawings drawings)
set(VOXTONE_PACKAGE_OF_voxtone-calibrate calibrate)
set(VOXTONE_PACKAGE_OF_voxtone-vdb vdb)
set(VOXTONE_PACKAGE_OF_voxtone-layer-surfaces vdb)
function(voxtone_install_helper name kind)
  set(package core)
  if(DEFINED VOXTONE_PACKAGE_OF_${name})
    set(package ${VOXTONE_PACKAGE_OF_${name}})
  endif()
  install(TARGETS ${name} ${kind} DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/voxtone COMPONENT program)
  install(TARGETS ${name} ${kind} DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/voxtone COMPONENT ${package} EXCLUDE_FROM_ALL)
endfunction()

# voxtone_add_helper(<name> <file>...)
# A program that `voxtone` runs when it is needed (io/files/helper_program.h): it loads libraries that most runs do without.
set(VOXTONE_BUILT_HELPERS ${PROJECT_BINARY_DIR}/bin)
function(voxtone_add_helper name)
  add_executable(${name} ${ARGN})
  target_link_libraries(${name} PRIVATE voxtone_flags)
  set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${VOXTONE_BUILT_HELPERS})
  voxtone_install_helper(${name} RUNTIME)
endfunction()

# voxtone_add_module(<name> <file>...)
# <name>.so, loaded when it is needed (io/files/module_function.h). It holds copies of our code, which stay its own.
function(voxtone_add_module name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE voxtone_flags)
  target_link_options(${name} PRIVATE -Wl,--exclude-libs,ALL)
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX .so LIBRARY_OUTPUT_DIRECTORY ${VOXTONE_BUILT_HELPERS})
  voxtone_install_helper(${name} LIBRARY)
endfunction()

# voxtone_places: where the tree and its build lie (tests/places.h), for tests and benchmarks. No other source is compiled
# with a path of this machine: in a second folder the compiler cache answers for all but this one.
function(voxtone_add_places)
  add_library(voxtone_places STATIC ${PROJECT_SOURCE_DIR}/tests/places.cpp)
  target_link_libraries(voxtone_places PRIVATE voxtone_flags)
  target_compile_definitions(voxtone_places PRIVATE VOXTONE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" VOXTONE_BUILD_DIR="${PROJECT_BINARY_DIR}"
                                                    VOXTONE_HELPERS="${VOXTONE_BUILT_HELPERS}")
endfunction()

# voxtone_add_test(<name> [SLOW] [TOGETHER] LABELS <label>... LIBRARIES <target>... SOURCES <file>...)
# Catch2 tests, one ctest per TEST_CASE; TOGETHER: one for all of them, where they share what takes long to make, or are linked
# with many libraries (OpenCV, OpenImageIO: 0.3 s of a processor at each start). Labels: unit (below half a second each), slow, statistical, corpus, app. SLOW: cases
# tagged [slow] take longer, and have the label `slow` instead. The target unit_tests builds all that is labelled unit.
# A test one of whose libraries is missing is left out, and said to be: in its place stands a target that is never built.
function(voxtone_add_test name)
  cmake_parse_arguments(ARG "SLOW;TOGETHER" "" "LABELS;LIBRARIES;SOURCES" ${ARGN})
  foreach(library IN LISTS ARG_LIBRARIES)
    if(NOT TARGET ${library})
      message(STATUS "voxtone without ${name}: no ${library}")
      file(TOUCH ${CMAKE_CURRENT_BINARY_DIR}/left_out.cpp)
      add_library(${name} OBJECT EXCLUDE_FROM_ALL ${CMAKE_CURRENT_BINARY_DIR}/left_out.cpp)
      return()
    endif()
  endforeach()
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE voxtone_flags voxtone_catch_main ${ARG_LIBRARIES})
  target_precompile_headers(${name} REUSE_FROM voxtone_test_headers)
  target_compile_options(${name} PRIVATE -pthread $<$<CONFIG:Release>:-O1>)  # -pthread: some of Debian 13's libraries bring it
  if(ARG_LIBRARIES MATCHES "voxtone::(io|calibration|slicer|scattering|farm)")
    voxtone_want(${name} voxtone-read voxtone-read-pictures voxtone-read-drawings voxtone-photographs voxtone-vdb voxtone-layer-surfaces)
  endif()
  # CTest starts the most costly first; what it measures itself it forgets of names with spaces.
  set(cost 20)
  if("unit" IN_LIST ARG_LABELS)
    add_dependencies(unit_tests ${name})
    set(cost 0)
  endif()
  if(ARG_TOGETHER)
    if(ARG_SLOW)
      add_test(NAME ${name}_slow COMMAND ${name} "[slow]" ${no_tests_fail})
      set_tests_properties(${name}_slow PROPERTIES LABELS slow COST 20 SKIP_RETURN_CODE 77)
      set(quick "~[slow]")
    endif()
    add_test(NAME ${name} COMMAND ${name} ${quick} ${no_tests_fail})
    set_tests_properties(${name} PROPERTIES LABELS "${ARG_LABELS}" COST ${cost} SKIP_RETURN_CODE 77)
    return()
  endif()
  if(ARG_SLOW)
    catch_discover_tests(${name} EXTRA_ARGS ${no_tests_fail} TEST_SPEC "[slow]" TEST_PREFIX "${name}: " PROPERTIES LABELS slow COST 10 SKIP_RETURN_CODE 77)
    set(quick TEST_SPEC "~[slow]")
  endif()
  catch_discover_tests(${name} EXTRA_ARGS ${no_tests_fail} ${quick} TEST_PREFIX "${name}: " PROPERTIES LABELS "${ARG_LABELS}" COST ${cost} SKIP_RETURN_CODE 77)
endfunction()
