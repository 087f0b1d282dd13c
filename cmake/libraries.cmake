# What voxtone is linked with: the one list, for building it (cmake/dependencies.cmake) and for programs that link its static
# libraries (cmake/voxtone-config.cmake.in). The includer says what voxtone_find(<package> <argument>...) is.
# The order matters: TBB before OpenVDB and Ceres (their own TBB searches clash).
voxtone_find(TBB CONFIG)
voxtone_find(Eigen3 3.4 CONFIG)
voxtone_find(Ceres 2.1 CONFIG)
voxtone_find(CGAL 5.5 CONFIG)
include(CGAL_Eigen3_support)
voxtone_find(embree 3.13 CONFIG)
voxtone_find(fmt CONFIG)
voxtone_find(nlohmann_json CONFIG)
voxtone_find(assimp CONFIG)
voxtone_find(PNG)
voxtone_find(TIFF)
voxtone_find(ZLIB)
voxtone_find(hwy CONFIG)
voxtone_find(OpenCV 4.6 COMPONENTS core imgproc calib3d aruco mcc)
voxtone_find(PkgConfig)
pkg_check_modules(OIIO REQUIRED IMPORTED_TARGET OpenImageIO)
pkg_check_modules(OPENEXR REQUIRED IMPORTED_TARGET OpenEXR)
pkg_check_modules(LIBZIP REQUIRED IMPORTED_TARGET libzip)
pkg_check_modules(LCMS2 REQUIRED IMPORTED_TARGET lcms2)

# FindOpenVDB sets BUILD_SHARED_LIBS in its caller's scope; the block keeps that in.
block()
  list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
  find_package(OpenVDB 10.0 REQUIRED COMPONENTS openvdb)
endblock()
