# The target apothem_numbers: runs the commands that docs/numbers.json lists and says which numbers of
# the documents are stale. The target apothem_numbers_write replaces these, and all times.
find_package(Python3 COMPONENTS Interpreter)
if(NOT Python3_FOUND)
  return()
endif()
option(APOTHEM_NUMBERS_QUICK "apothem_numbers leaves out the commands that take minutes" OFF)
set(programs apothem_program)
if(TARGET apothem_tests)
  list(APPEND programs apothem_tests)
endif()
foreach(ending IN ITEMS "" _write)
  add_custom_target(apothem_numbers${ending}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/check_numbers.py --build ${PROJECT_BINARY_DIR}
            --tests ${PROJECT_BINARY_DIR} $<$<BOOL:${APOTHEM_NUMBERS_QUICK}>:--quick> $<$<BOOL:${ending}>:--write>
    DEPENDS ${programs} USES_TERMINAL COMMAND_EXPAND_LISTS)
endforeach()
# The target apothem_images makes the pictures of the documents anew; a test says which of them are stale.
add_custom_target(apothem_images
  COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/images/make.py $<TARGET_FILE:apothem_program>
  DEPENDS apothem_program USES_TERMINAL)
if(APOTHEM_TESTS AND CMAKE_BUILD_TYPE STREQUAL "Release")
  add_test(NAME docs.images
           COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/images/make.py $<TARGET_FILE:apothem_program> --check
                   fig-19 energy impact)
  set_tests_properties(docs.images PROPERTIES SKIP_RETURN_CODE 77)
  add_test(NAME docs.numbers COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/check_numbers.py --texts)
  add_test(NAME docs.check_numbers
           COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/tests/docs/test_check_numbers.py)
  # The values of the cheap commands, and of the scenes whose tests have run. Times are compared as ratios to the
  # machine's arithmetic; others use the machine, so a factor of 4 is
  # allowed, and no other test runs meanwhile. Two commands run at a time; those whose times are wrong then run again, alone.
  add_test(NAME docs.values
           COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/docs/check_numbers.py --build ${PROJECT_BINARY_DIR}
                   --tests ${PROJECT_BINARY_DIR} --scenes ${PROJECT_BINARY_DIR}/scenes --quick --times x4
                   --jobs 2 --brief)
  set_tests_properties(docs.values PROPERTIES FIXTURES_REQUIRED scenes RUN_SERIAL ON)
endif()
