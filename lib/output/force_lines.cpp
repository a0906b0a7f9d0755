#include "lib/output/force_lines.hpp"

#include <array>
#include <cmath>

#include "lib/execution/elementary.hpp"
#include "lib/model/columns.hpp"

namespace apothem {
namespace {

constexpr size_t kSectors = 36;

// What a rose shows.
struct RoseCounts {
  std::array<double, kSectors> count{}, force{};
  double contacts = 0, all_force = 0;

  // Both bodies see the contact, from opposite sides.
  void add(const Vec2& normal) {
    const double size = normal.norm();
    for (const Vec2& n : {normal, Vec2(-normal)}) {
      const double turns = arc_tangent(n.y(), n.x()) / (2 * M_PI) + 1;
      const auto sector = static_cast<size_t>(turns * kSectors) % kSectors;
      count[sector] += 1;
      force[sector] += size;
    }
    contacts += 2;
    all_force += 2 * size;
  }
  [[nodiscard]] double frequency(size_t sector) const {
    return contacts > 0 ? count[sector] * kSectors / contacts : 0;
  }
  [[nodiscard]] double mean_force(size_t sector) const {
    return count[sector] > 0 ? force[sector] / count[sector] * contacts / all_force : 0;
  }
};

RoseCounts rose_of(const Region& region, const std::vector<ContactRecord>& contacts) {
  RoseCounts rose;
  for (const ContactRecord& c : contacts) {
    if (region.contains(c.point) && c.normal.norm() > 0) rose.add(c.normal);
  }
  return rose;
}

}  // namespace

FrameGrid force_chains(const Model& model, const FrameContents& frame) {
  FrameGrid grid{FrameGrid::Kind::lines};
  GridArray chain = GridArray::whole_numbers("chain");
  GridArray a = GridArray::whole_numbers("body_a"), b = GridArray::whole_numbers("body_b");
  GridArray normal = GridArray::numbers("normal_force");
  GridArray tangential = GridArray::numbers("tangential_force");
  const auto free_centre = [&](BodyIndex body) -> std::optional<Vec2> {
    const bool rigid = body < static_cast<BodyIndex>(model.bodies.size());
    if (rigid && model.bodies[body].motion != Motion::free) return {};
    return motion_of(model, frame.state, body, {}, frame.node_mass).place;
  };
  int number = 0;  // of the contact
  for (const ContactRecord& c : frame.contacts) {
    const auto add_line = [&](std::int32_t first, std::int32_t second) {
      grid.add_cell({first, second});
      chain.integers.push_back(number);
      a.integers.push_back(c.a);
      b.integers.push_back(c.b);
      normal.reals.push_back((c.normal + c.damping).norm());
      tangential.reals.push_back(c.tangential.norm());
    };
    const std::optional<Vec2> from = free_centre(c.a), to = free_centre(c.b);
    const std::int32_t first = from ? grid.add_point(*from) : -1;
    const std::int32_t middle = grid.add_point(c.point + model.origin);
    if (from) add_line(first, middle);
    if (to) add_line(middle, grid.add_point(*to));
    ++number;
  }
  grid.of_cells = {std::move(chain), std::move(a), std::move(b), std::move(normal),
                   std::move(tangential)};
  return grid;
}

FrameGrid roses(const Model& model, const FrameContents& frame) {
  FrameGrid grid{FrameGrid::Kind::lines};
  GridArray of_region = GridArray::whole_numbers("region");
  GridArray frequency = GridArray::numbers("frequency");
  GridArray force = GridArray::numbers("mean_force");
  for (size_t r = 0; r < model.regions.size(); ++r) {
    const Region& region = model.regions[r];
    Box box;
    for (const std::vector<Vec2>& part : region.parts) box.include(box_of(part));
    const Vec2 middle = Vec2((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2) + model.origin;
    const double unit = std::sqrt(region.area) / 4;
    const RoseCounts rose = rose_of(region, frame.contacts);
    const auto first = static_cast<std::int32_t>(grid.points.size());
    for (size_t s = 0; s < kSectors; ++s) {
      for (const size_t end : {s, s + 1}) {
        const auto [sine, cosine] = sine_cosine(2 * M_PI * static_cast<double>(end) / kSectors);
        const double radius = unit * rose.frequency(s);
        grid.add_point(Vec2(middle.x() + radius * cosine, middle.y() + radius * sine));
        frequency.reals.push_back(rose.frequency(s));
        force.reals.push_back(rose.mean_force(s));
      }
    }
    constexpr auto kPoints = static_cast<std::int32_t>(2 * kSectors);
    for (std::int32_t i = 0; i < kPoints; ++i) {
      grid.add_cell({first + i, first + (i + 1) % kPoints});
      of_region.integers.push_back(static_cast<std::int32_t>(r));
    }
  }
  grid.of_cells = {std::move(of_region)};
  grid.of_points = {std::move(frequency), std::move(force)};
  return grid;
}

}  // namespace apothem
