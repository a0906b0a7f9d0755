#include "geometry/spatial/loops.hpp"
#include "lib/contact/contacts.hpp"

namespace apothem {

std::optional<EngulfedBody> find_engulfed(const OutlineSurfaces& o,
                                          const std::vector<std::uint8_t>& absent) {
  std::vector<Loops> loops;
  std::vector<double> reach;  // depth to which the potential of each body reaches, m
  std::vector<Box> boxes;
  for (const OutlineSurfaces::Body& body : o.bodies) {
    Loops& of_body = loops.emplace_back();
    reach.push_back(body.depth);
    for (int i = body.first, first = i; i < body.end; first = i) {
      std::vector<Vec2>& ring = of_body.rings.emplace_back();
      do {
        ring.push_back(o.point(i));
        of_body.box.include(o.x[i], o.y[i]);
      } while (o.next[i++] != first);
    }
    const bool there = absent.empty() || absent[boxes.size()] == 0;
    boxes.push_back(there ? of_body.box : Box());
  }
  std::vector<BoxPair> pairs;
  BoxGrid().find_pairs(boxes, pairs);
  for (const auto& [a, b] : pairs) {
    if (o.bodies[a].is_rigid() && o.bodies[b].is_rigid()) continue;
    if (const auto place = deep_vertex(loops[a], loops[b], reach[b]))
      return EngulfedBody{a, b, *place};
    if (const auto place = deep_vertex(loops[b], loops[a], reach[a]))
      return EngulfedBody{b, a, *place};
  }
  return {};
}

}  // namespace apothem
