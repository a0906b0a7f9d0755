# The target apothem_docs: the site of docs/, with the reference of the public headers and of the Python
# module. Beside it, the tests of the documents.
find_package(Doxygen QUIET)
find_program(APOTHEM_SPHINX sphinx-build DOC "Sphinx, for the site")
find_path(APOTHEM_MATHJAX MathJax.js PATHS /usr/share/javascript/mathjax NO_DEFAULT_PATH
          DOC "MathJax 2, for the site")
find_package(Python3 COMPONENTS Interpreter)
if(NOT Python3_FOUND)
  return()
endif()
set(docs ${PROJECT_SOURCE_DIR}/docs)
if(DOXYGEN_FOUND AND APOTHEM_SPHINX AND APOTHEM_MATHJAX)
  if(APOTHEM_PYTHON)
    set(module --module ${PROJECT_BINARY_DIR}/python)
  endif()
  add_custom_target(apothem_docs
    COMMAND ${Python3_EXECUTABLE} ${docs}/site/build.py --out ${PROJECT_BINARY_DIR}/docs
            --version ${PROJECT_VERSION} --sphinx ${APOTHEM_SPHINX} --mathjax ${APOTHEM_MATHJAX} ${module}
    COMMENT "Site of the documents: ${PROJECT_BINARY_DIR}/docs/html/index.html")
  if(APOTHEM_PYTHON)
    add_dependencies(apothem_docs apothem_python)
  endif()
endif()
# The sanitizers look at code, not at pages.
if(NOT APOTHEM_TESTS OR CMAKE_BUILD_TYPE STREQUAL "Sanitize")
  return()
endif()
set(tests ${PROJECT_SOURCE_DIR}/tests/docs)
add_test(NAME docs.pages COMMAND ${Python3_EXECUTABLE} ${tests}/check_pages.py
         --program $<TARGET_FILE:apothem_program>)
add_test(NAME docs.get_started COMMAND ${Python3_EXECUTABLE} ${tests}/walk_through.py ${docs}/get-started.md
         --program $<TARGET_FILE:apothem_program>)
set_tests_properties(docs.get_started PROPERTIES TIMEOUT 600)
add_test(NAME docs.scene_reference COMMAND ${Python3_EXECUTABLE} ${docs}/scene_reference.py --check)
foreach(script check_pages walk_through)
  add_test(NAME docs.${script} COMMAND ${Python3_EXECUTABLE} ${tests}/test_${script}.py)
endforeach()
