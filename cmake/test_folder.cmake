# Tests write thousands of small files and remove them at once, which takes a disk longer than the tests take themselves.
# They stand in memory, where there is room for 4 GB and where programs may be run.
execute_process(
  COMMAND sh -c "f=$(mktemp /dev/shm/apothem-XXXXXX) || exit 1; printf '#!/bin/sh\\n' >$f; chmod +x $f
                 $f && [ $(df -Pk /dev/shm | awk 'NR == 2 { print $4 }') -gt 4000000 ]; code=$?; rm -f $f; exit $code"
  RESULT_VARIABLE no_room OUTPUT_QUIET ERROR_QUIET)
if(NOT no_room)
  get_property(tests DIRECTORY PROPERTY TESTS)
  set_property(TEST ${tests} APPEND PROPERTY ENVIRONMENT_MODIFICATION TMPDIR=set:/dev/shm)
endif()
