# From which commit a program was built, as a source file: cmake -DROOT=.. -DOUTPUT=.. -P write_build_commit.cmake
# Empty where the sources came without their history. Written anew only where it would be another one.
set(commit "")
find_program(GIT git)
if(GIT AND EXISTS ${ROOT}/.git)
  execute_process(COMMAND ${GIT} -C ${ROOT} rev-list --count HEAD OUTPUT_VARIABLE count
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  execute_process(COMMAND ${GIT} -C ${ROOT} describe --always --dirty --exclude=* --abbrev=10 OUTPUT_VARIABLE name
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed_too)
  if(NOT failed AND NOT failed_too)
    set(commit "commit ${count}, ${name}")
  endif()
endif()
include(${CMAKE_CURRENT_LIST_DIR}/write_if_changed.cmake)
write_if_changed(${OUTPUT} "extern const char voxtone_build_commit[];\nconst char voxtone_build_commit[] = \"${commit}\";\n")
