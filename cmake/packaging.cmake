# Debian packages, by "cpack -G DEB" in the build folder: apothem, and libapothem-dev with the headers, libraries and
# CMake package for those who write programs with it.
set(CPACK_PACKAGE_NAME apothem)
set(CPACK_PACKAGE_CONTACT "The Apothem developers <apothem@example.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL Unspecified development)  # the Python module is installed by cmake --install
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_NAME apothem)
set(CPACK_COMPONENT_UNSPECIFIED_DESCRIPTION
    "Polygonal bodies, rigid or of finite elements, that move and touch each other.\nThe method is that of doi:10.1007/s00466-020-01913-2.")
# Loaded or started only when they are needed: GDAL for drawings, gnuplot for curves, ffmpeg for films.
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_RECOMMENDS "gnuplot-nox | gnuplot, ${GDAL_PACKAGE}")
set(CPACK_DEBIAN_UNSPECIFIED_PACKAGE_SUGGESTS "ffmpeg, paraview")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libapothem-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "Headers, static libraries and CMake package of Apothem.")
set(needs "apothem (= ${PROJECT_VERSION})" libcairo2-dev libeigen3-dev libfmt-dev libgmp-dev libmpfr-dev libsleef-dev
          nlohmann-json3-dev zlib1g-dev)
if(VTK_FOUND)
  list(APPEND needs libvtk9-dev)  # where the build found it, the CMake package looks for it
endif()
list(JOIN needs ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
include(CPack)
