# Writes a header with the page of the player as one string: PAGE with STYLE and SCRIPTS in it.
file(READ ${PAGE} page)
file(READ ${STYLE} style)
set(script "")
foreach(file ${SCRIPTS})
  file(READ ${file} part)
  string(APPEND script "${part}\n")
endforeach()
string(REPLACE "{{style}}" "${style}" page "${page}")
string(REPLACE "{{script}}" "${script}" page "${page}")
file(WRITE ${OUTPUT} "#pragma once\n#include <string_view>\n
namespace apothem {
inline constexpr std::string_view kPlayerPage = R\"page(${page})page\";
}\n")
