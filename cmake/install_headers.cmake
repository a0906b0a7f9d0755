# Installs the public headers as apothem/ROOM/NAME.hpp; within the source tree they include each other as
# "lib/ROOM/NAME.hpp" and "geometry/ROOM/NAME.hpp". `source`, `folder` and `headers` are set by install.cmake.
foreach(header ${headers})
  set(path ${source}/lib/${header})
  if(header MATCHES "^geometry/")
    set(path ${source}/${header})
  endif()
  file(READ ${path} text)
  string(REPLACE "#include \"lib/" "#include \"apothem/" text "${text}")
  string(REPLACE "#include \"geometry/" "#include \"apothem/geometry/" text "${text}")
  set(installed ${folder}/apothem/${header})
  file(WRITE $ENV{DESTDIR}${installed} "${text}")
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES ${installed})
endforeach()
