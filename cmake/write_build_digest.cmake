# What a build was made of, as a source file: cmake -DROOT=.. -DOUTPUT=.. -DTOOLCHAIN=.. -P write_build_digest.cmake
# The digest is of all sources that decide what a job makes, and of what compiled them. The file is written anew only
# where it would be another one.
file(GLOB_RECURSE sources LIST_DIRECTORIES false RELATIVE ${ROOT}
     ${ROOT}/base/*.h ${ROOT}/base/*.cpp ${ROOT}/optics/*.h ${ROOT}/optics/*.cpp ${ROOT}/halftone/*.h ${ROOT}/halftone/*.cpp
     ${ROOT}/io/*.h ${ROOT}/io/*.cpp ${ROOT}/slicer/*.h ${ROOT}/slicer/*.cpp ${ROOT}/data/*)
list(SORT sources)
set(all "${TOOLCHAIN}\n")
foreach(source IN LISTS sources)
  file(SHA256 ${ROOT}/${source} digest)
  string(APPEND all "${source} ${digest}\n")
endforeach()
string(SHA256 digest "${all}")
string(SUBSTRING ${digest} 0 16 digest)
include(${CMAKE_CURRENT_LIST_DIR}/write_if_changed.cmake)
write_if_changed(${OUTPUT} "extern const char voxtone_build_digest[];\nconst char voxtone_build_digest[] = \"${digest}\";\n")
