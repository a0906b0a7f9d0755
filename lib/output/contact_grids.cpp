#include "lib/output/contact_grids.hpp"

#include "lib/model/patch_quantities.hpp"

namespace apothem {

FrameGrid contact_patches(const Model& model, const std::vector<ContactRecord>& contacts) {
  FrameGrid grid{FrameGrid::Kind::points};
  GridArray a = GridArray::whole_numbers("body_a"), b = GridArray::whole_numbers("body_b");
  for (const ContactRecord& contact : contacts) {
    grid.add_cell({grid.add_point(contact.point + model.origin)});
    a.integers.push_back(contact.a);
    b.integers.push_back(contact.b);
  }
  grid.of_points = {std::move(a), std::move(b)};
  for (const PatchQuantity& quantity : kPatchQuantities) {
    if (!quantity.in_frames) continue;
    GridArray& values =
        grid.of_points.emplace_back(quantity.is_vector ? GridArray::vectors(quantity.in_frames)
                                                       : GridArray::numbers(quantity.in_frames));
    values.reserve(contacts.size());
    for (const ContactRecord& contact : contacts) {
      const Vec2 value = quantity.value(contact);
      quantity.is_vector ? values.add(value) : values.reals.push_back(value.x());
    }
  }
  return grid;
}

FrameGrid contact_surfaces(const Model& model, const std::vector<SurfaceRecord>& surfaces) {
  FrameGrid grid{FrameGrid::Kind::lines};
  GridArray body = GridArray::whole_numbers("body");
  GridArray pressure = GridArray::numbers("contact_pressure");
  GridArray traction = GridArray::numbers("tangential_traction");
  for (const SurfaceRecord& surface : surfaces) {
    const std::int32_t from = grid.add_point(surface.from + model.origin);
    grid.add_cell({from, grid.add_point(surface.to + model.origin)});
    body.integers.push_back(surface.body);
    pressure.reals.push_back(surface.pressure);
    traction.reals.push_back(surface.traction);
  }
  grid.of_cells = {std::move(body), std::move(pressure), std::move(traction)};
  return grid;
}

}  // namespace apothem
