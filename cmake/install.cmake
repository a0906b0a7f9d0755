include(CMakePackageConfigHelpers)
include(${CMAKE_CURRENT_LIST_DIR}/public_headers.cmake)

# What only those need who write programs with the library is the component "development".
install(TARGETS apothem_program RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(NOT APOTHEM_OBJECTS_FROM)
  install(TARGETS apothem_skeleton RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/apothem)
endif()
install(TARGETS apothem apothem_files apothem_mechanics apothem_geometry EXPORT apothem
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT development)
install(CODE "set(source \"${PROJECT_SOURCE_DIR}\")
set(folder \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}\")
set(headers \"${APOTHEM_PUBLIC_HEADERS}\")
include(\"${CMAKE_CURRENT_LIST_DIR}/install_headers.cmake\")" COMPONENT development)
install(DIRECTORY data/drawings data/figures data/polygons data/reference data/scenes data/studies DESTINATION ${CMAKE_INSTALL_DATADIR}/apothem)
install(FILES docs/scene.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/apothem)
install(FILES CITATION.cff DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME copyright)  # the name that Debian looks for

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/apothem)
install(EXPORT apothem NAMESPACE apothem:: FILE apothem-targets.cmake DESTINATION ${package_folder}
        COMPONENT development)
set(skeleton_program ${CMAKE_INSTALL_LIBEXECDIR}/apothem/apothem-skeleton)
configure_package_config_file(cmake/apothem-config.cmake.in ${PROJECT_BINARY_DIR}/apothem-config.cmake
                              INSTALL_DESTINATION ${package_folder} PATH_VARS skeleton_program)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/apothem-config-version.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/apothem-config.cmake ${PROJECT_BINARY_DIR}/apothem-config-version.cmake
              cmake/package_program.cpp
        DESTINATION ${package_folder} COMPONENT development)
