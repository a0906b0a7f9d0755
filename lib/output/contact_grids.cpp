#include "lib/output/contact_grids.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include "lib/model/patch_quantities.hpp"

namespace apothem {

vtkNew<vtkUnstructuredGrid> contact_patches(const Model& model,
                                            const std::vector<ContactRecord>& contacts) {
  vtkNew<vtkPoints> points = double_points();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> a = integers("body_a");
  vtkNew<vtkIntArray> b = integers("body_b");
  for (const ContactRecord& contact : contacts) {
    const Vec2 p = contact.point + model.origin;
    cells->InsertNextCell(1);
    cells->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), 0));
    a->InsertNextValue(contact.a);
    b->InsertNextValue(contact.b);
  }
  vtkNew<vtkUnstructuredGrid> grid = grid_of(points, VTK_VERTEX, cells);
  grid->GetPointData()->AddArray(a);
  grid->GetPointData()->AddArray(b);
  for (const PatchQuantity& quantity : kPatchQuantities) {
    if (!quantity.in_frames) continue;
    vtkNew<vtkDoubleArray> values = doubles(quantity.in_frames, quantity.is_vector ? 3 : 1);
    for (const ContactRecord& contact : contacts) {
      const Vec2 value = quantity.value(contact);
      if (quantity.is_vector) {
        values->InsertNextTuple3(value.x(), value.y(), 0);
      } else {
        values->InsertNextValue(value.x());
      }
    }
    grid->GetPointData()->AddArray(values);
  }
  return grid;
}

vtkNew<vtkUnstructuredGrid> contact_surfaces(const Model& model,
                                             const std::vector<SurfaceRecord>& surfaces) {
  vtkNew<vtkPoints> points = double_points();
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> body = integers("body");
  vtkNew<vtkDoubleArray> pressure = doubles("contact_pressure", 1);
  vtkNew<vtkDoubleArray> traction = doubles("tangential_traction", 1);
  for (const SurfaceRecord& surface : surfaces) {
    cells->InsertNextCell(2);
    for (const Vec2& end : {surface.from, surface.to}) {
      const Vec2 p = end + model.origin;
      cells->InsertCellPoint(points->InsertNextPoint(p.x(), p.y(), 0));
    }
    body->InsertNextValue(surface.body);
    pressure->InsertNextValue(surface.pressure);
    traction->InsertNextValue(surface.traction);
  }
  return grid_of(points, VTK_LINE, cells, {body, pressure, traction});
}

}  // namespace apothem
