# Headers of Debian packages that need not be installed. The development packages of VTK, GDAL and valijson bring
# several hundred packages along (Java, MariaDB, MPI, Qt), of which a program that includes some headers needs none.

# Sets RESULT to a folder with the files of PACKAGE: Debian's own package, verified and unpacked by apt and dpkg-deb.
function(apothem_debian_headers package result)
  set(folder ${PROJECT_BINARY_DIR}/debian/${package})
  set(${result} ${folder} PARENT_SCOPE)
  if(IS_DIRECTORY ${folder})
    return()
  endif()
  message(STATUS "${package} is not installed: its headers are taken from Debian's package")
  set(download ${folder}.download)
  file(REMOVE_RECURSE ${download})
  file(MAKE_DIRECTORY ${download}/unpacked)
  execute_process(COMMAND apt-get download ${package} WORKING_DIRECTORY ${download}
                  RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT failed)
    file(GLOB archive ${download}/*.deb)
    execute_process(COMMAND dpkg-deb -x ${archive} ${download}/unpacked
                    RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
  endif()
  if(failed)
    message(FATAL_ERROR "${package} is neither installed nor can its headers be downloaded (${failed}):\n${output}\n"
                        "Run 'apt-get update' and try again, or install ${package}.")
  endif()
  file(RENAME ${download}/unpacked ${folder})
  file(REMOVE_RECURSE ${download})
endfunction()

# VTK: the modules that read and write its XML files.
set(APOTHEM_VTK_MODULES CommonCore CommonDataModel CommonExecutionModel IOXML IOXMLParser)
find_package(VTK QUIET COMPONENTS ${APOTHEM_VTK_MODULES})
if(NOT VTK_FOUND)
  apothem_debian_headers(libvtk9-dev folder)
  file(GLOB headers ${folder}/usr/include/vtk-*)
  cmake_path(GET headers FILENAME version)
  string(REPLACE "vtk-" "" version "${version}")
  set(VTK_LIBRARIES)
  foreach(module ${APOTHEM_VTK_MODULES})
    find_library(APOTHEM_VTK_${module} libvtk${module}-${version}.so.1 REQUIRED)
    mark_as_advanced(APOTHEM_VTK_${module})
    list(APPEND VTK_LIBRARIES ${APOTHEM_VTK_${module}})
  endforeach()
  set(VTK_INCLUDE_DIRS ${headers})
endif()

# GDAL: nothing is linked with it, see lib/scene/gdal.hpp.
find_package(GDAL QUIET)
if(NOT GDAL_FOUND)
  apothem_debian_headers(libgdal-dev folder)
  set(GDAL_INCLUDE_DIRS ${folder}/usr/include/gdal)
  file(GLOB_RECURSE GDAL_LIBRARY ${folder}/usr/lib/libgdal.so)
endif()

# valijson: headers with which the tests hold scenes against the schema.
if(APOTHEM_TESTS)
  find_path(VALIJSON_INCLUDE valijson/validator.hpp)
  if(NOT VALIJSON_INCLUDE)
    apothem_debian_headers(libvalijson-dev folder)
    find_path(VALIJSON_INCLUDE valijson/validator.hpp PATHS ${folder}/usr/include REQUIRED)
  endif()
endif()
