# Installs voxtone, then configures, builds and runs the example against it, which wants no OpenCV; asks for parts that are
# missing; and compiles every public header as it was installed.  -DBUILD= -DSOURCE= -DWORK= -DFLAGS=
function(must)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "failed: ${ARGV}")
  endif()
endfunction()
file(REMOVE_RECURSE ${WORK}/prefix)
must(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
set(how -G Ninja -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_BUILD_TYPE=Release -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON
        -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON "-DCMAKE_CXX_FLAGS=${FLAGS}")
must(${CMAKE_COMMAND} -S ${SOURCE} -B ${WORK}/build ${how})
must(${CMAKE_COMMAND} --build ${WORK}/build)
must(${WORK}/build/mix)
must(${CMAKE_COMMAND} -S ${SOURCE}/parts -B ${WORK}/parts ${how})

file(STRINGS ${SOURCE}/../../cmake/public_headers.txt headers REGEX "^[a-z]")
list(TRANSFORM headers REPLACE "(.+)" "#include <voxtone/\\1>")
list(JOIN headers "\n" text)
file(WRITE ${WORK}/headers.cpp "${text}\n")
must(c++ -std=c++20 -fsyntax-only -I${WORK}/prefix/include -I${WORK}/prefix/include/voxtone -I/usr/include/eigen3 ${WORK}/headers.cpp)
