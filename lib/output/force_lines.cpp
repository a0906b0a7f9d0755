#include "lib/output/force_lines.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

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

vtkNew<vtkUnstructuredGrid> force_chains(const Model& model, const FrameContents& frame) {
  vtkNew<vtkPoints> points = double_points();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> chain = integers("chain"), a = integers("body_a"), b = integers("body_b");
  vtkNew<vtkDoubleArray> normal = doubles("normal_force", 1);
  vtkNew<vtkDoubleArray> tangential = doubles("tangential_force", 1);
  const auto add_point = [&](const Vec2& world) {
    return points->InsertNextPoint(world.x(), world.y(), 0);
  };
  const auto free_centre = [&](BodyIndex body) -> std::optional<Vec2> {
    const bool rigid = body < static_cast<BodyIndex>(model.bodies.size());
    if (rigid && model.bodies[body].motion != Motion::free) return {};
    return motion_of(model, frame.state, body, {}, frame.node_mass).place;
  };
  int number = 0;  // of the contact
  for (const ContactRecord& c : frame.contacts) {
    const auto add_line = [&](vtkIdType first, vtkIdType second) {
      cells->InsertNextCell({first, second});
      chain->InsertNextValue(number);
      a->InsertNextValue(c.a);
      b->InsertNextValue(c.b);
      normal->InsertNextValue((c.normal + c.damping).norm());
      tangential->InsertNextValue(c.tangential.norm());
    };
    const std::optional<Vec2> from = free_centre(c.a), to = free_centre(c.b);
    const vtkIdType first = from ? add_point(*from) : -1;
    const vtkIdType middle = add_point(c.point + model.origin);
    if (from) add_line(first, middle);
    if (to) add_line(middle, add_point(*to));
    ++number;
  }
  return grid_of(points, VTK_LINE, cells, {chain, a, b, normal, tangential});
}

vtkNew<vtkUnstructuredGrid> roses(const Model& model, const FrameContents& frame) {
  vtkNew<vtkPoints> points = double_points();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> of_region = integers("region");
  vtkNew<vtkDoubleArray> frequency = doubles("frequency", 1);
  vtkNew<vtkDoubleArray> force = doubles("mean_force", 1);
  for (size_t r = 0; r < model.regions.size(); ++r) {
    const Region& region = model.regions[r];
    Box box;
    for (const std::vector<Vec2>& part : region.parts) box.include(box_of(part));
    const Vec2 middle = Vec2((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2) + model.origin;
    const double unit = std::sqrt(region.area) / 4;
    const RoseCounts rose = rose_of(region, frame.contacts);
    const vtkIdType first = points->GetNumberOfPoints();
    for (size_t s = 0; s < kSectors; ++s) {
      for (const size_t end : {s, s + 1}) {
        const auto [sine, cosine] = sine_cosine(2 * M_PI * static_cast<double>(end) / kSectors);
        const double radius = unit * rose.frequency(s);
        points->InsertNextPoint(middle.x() + radius * cosine, middle.y() + radius * sine, 0);
        frequency->InsertNextValue(rose.frequency(s));
        force->InsertNextValue(rose.mean_force(s));
      }
    }
    constexpr auto kPoints = static_cast<vtkIdType>(2 * kSectors);
    for (vtkIdType i = 0; i < kPoints; ++i) {
      cells->InsertNextCell({first + i, first + (i + 1) % kPoints});
      of_region->InsertNextValue(static_cast<int>(r));
    }
  }
  vtkNew<vtkUnstructuredGrid> grid = grid_of(points, VTK_LINE, cells, {of_region});
  grid->GetPointData()->AddArray(frequency);
  grid->GetPointData()->AddArray(force);
  return grid;
}

}  // namespace apothem
