# Headers are included by their paths from the root of the source tree; installed ones as "apothem/ROOM/NAME.hpp"
# (install_headers.cmake).

# A library of the package: apothem::NAME, with what every one of them needs.
function(apothem_library name)
  add_library(apothem_${name} STATIC ${ARGN})
  add_library(apothem::${name} ALIAS apothem_${name})
  set_target_properties(apothem_${name} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(apothem_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(apothem_${name} PUBLIC cxx_std_20)
  target_compile_definitions(apothem_${name} PUBLIC ${APOTHEM_EIGEN})
  target_link_libraries(apothem_${name} PRIVATE $<BUILD_INTERFACE:apothem_options>)
endfunction()

# A library of another build folder of the same sources.
function(imported_library name folder)
  add_library(${name} STATIC IMPORTED GLOBAL)
  set_target_properties(${name} PROPERTIES IMPORTED_LOCATION ${APOTHEM_OBJECTS_FROM}/${folder}/lib${name}.a)
endfunction()

# Links the libraries before all else, so that inline functions are theirs: with sanitizers, where what another build
# folder gives has none.
function(link_libraries_first target)
  foreach(library apothem_geometry apothem_mechanics apothem_files)
    target_link_libraries(${target} PRIVATE -Wl,--whole-archive $<TARGET_FILE:${library}> -Wl,--no-whole-archive)
  endforeach()
endfunction()

# What the sources must know of the build: the version, and where shipped data are.
set(APOTHEM_GENERATED ${PROJECT_BINARY_DIR}/generated)
file(RELATIVE_PATH APOTHEM_DATA_FROM_PROGRAM
     ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_DATADIR}/apothem)
configure_file(${PROJECT_SOURCE_DIR}/cmake/version.hpp.in ${APOTHEM_GENERATED}/version.hpp @ONLY)

# GDAL is not linked but loaded when a drawing is read, see lib/scene/gdal.hpp: by the name under which
# a linked program would look for it, which is where the link of the development package leads.
set(GDAL_SONAME ${GDAL_LIBRARY})
if(IS_SYMLINK ${GDAL_LIBRARY})
  file(READ_SYMLINK ${GDAL_LIBRARY} GDAL_SONAME)
endif()
cmake_path(GET GDAL_SONAME FILENAME GDAL_SONAME)
string(REPLACE ".so." "" GDAL_PACKAGE ${GDAL_SONAME})  # Debian's name of it
configure_file(${PROJECT_SOURCE_DIR}/cmake/gdal_library.hpp.in ${APOTHEM_GENERATED}/gdal_library.hpp @ONLY)
