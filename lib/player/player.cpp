#include "lib/player/player.hpp"

#include <string_view>

#include "lib/output/html.hpp"
#include "lib/player/page_data.hpp"
#include "player_page.hpp"

namespace apothem {

std::string player_page(const RunFolder& run, const std::string& title,
                        const std::string& made_by) {
  const PageData data = page_data(record(run), read_plots(run), made_by);
  std::string page;
  std::string_view rest = kPlayerPage;
  const auto fill = [&](std::string_view mark, const std::string& text) {
    const size_t at = rest.find(mark);
    page += rest.substr(0, at);
    page += text;
    rest.remove_prefix(at + mark.size());
  };
  fill("{{title}}", escaped(title));
  fill("{{title}}", escaped(title));
  fill("{{description}}", data.description);
  fill("{{data}}", data.data);
  return page += rest;
}

}  // namespace apothem
