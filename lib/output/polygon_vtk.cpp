#include "lib/output/polygon_vtk.hpp"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkPointData.h>
#include <vtkPoints.h>

#include <algorithm>

#include "geometry/skeleton/node_places.hpp"
#include "lib/output/convex_cells.hpp"
#include "lib/output/files.hpp"
#include "lib/output/vtk_grid.hpp"

namespace apothem {
namespace {

std::string faces(const Polygon& polygon, const Skeleton& skeleton, double reference) {
  const CutFaces cut = cut_faces(skeleton, reference);
  const NodePlaces places(polygon, cut.nodes);
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points = double_points();
  vtkNew<vtkDoubleArray> height = doubles("roof_height", 1);
  vtkNew<vtkDoubleArray> phi = doubles("phi", 1);
  for (int i = 0; i < static_cast<int>(cut.nodes.size()); ++i) {
    const Vec2 p = places[i];
    points->InsertNextPoint(p.x(), p.y(), 0);
    height->InsertNextValue(cut.nodes[i].height);
    phi->InsertNextValue(std::min(1.0, cut.nodes[i].height / reference));
  }
  grid->SetPoints(points);
  vtkNew<vtkIntArray> edge = integers("edge");
  vtkNew<vtkIntArray> plateau = integers("plateau");
  for (const CutFaces::Part& part : cut.parts) {
    std::vector<Vec2> ring;
    ring.reserve(part.nodes.size());
    for (const int i : part.nodes) ring.push_back(cut.nodes[i].point);
    for (const std::vector<int>& cell : convex_cells(ring)) {
      std::vector<vtkIdType> nodes;
      nodes.reserve(cell.size());
      for (const int corner : cell) nodes.push_back(part.nodes[corner]);
      grid->InsertNextCell(VTK_POLYGON, static_cast<vtkIdType>(nodes.size()), nodes.data());
      edge->InsertNextValue(polygon.input_edge(part.edge));
      plateau->InsertNextValue(part.above ? 1 : 0);
    }
  }
  grid->GetPointData()->AddArray(height);
  grid->GetPointData()->AddArray(phi);
  grid->GetCellData()->AddArray(edge);
  grid->GetCellData()->AddArray(plateau);
  return xml(grid);
}

std::string singular_parts(const Polygon& polygon, const SingularArea& singular) {
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points = double_points();
  grid->SetPoints(points);
  const auto add = [&](int type, const auto& corners, const std::vector<std::vector<int>>& cells) {
    const vtkIdType first = points->GetNumberOfPoints();
    for (const Vec2& corner : corners) {
      const Vec2 p = polygon.origin() + corner;
      points->InsertNextPoint(p.x(), p.y(), 0);
    }
    for (const std::vector<int>& cell : cells) {
      std::vector<vtkIdType> nodes;
      nodes.reserve(cell.size());
      for (const int corner : cell) nodes.push_back(first + corner);
      grid->InsertNextCell(type, static_cast<vtkIdType>(nodes.size()), nodes.data());
    }
  };
  for (const PolygonWithHoles& part : singular.polygons) {
    const Rings rings = rings_of(part);
    std::vector<Vec2> corners;
    for (const std::vector<Vec2>& ring : rings) {
      corners.insert(corners.end(), ring.begin(), ring.end());
    }
    add(VTK_POLYGON, corners, convex_cells(rings));
  }
  for (const std::array<Vec2, 2>& ends : singular.segments) add(VTK_LINE, ends, {{0, 1}});
  for (const Vec2& point : singular.points) add(VTK_VERTEX, std::array{point}, {{0}});
  return xml(grid);
}

}  // namespace

void write_polygon_vtk(const std::string& folder, const Polygon& polygon, const Skeleton& skeleton,
                       const SingularArea& singular, double reference) {
  const std::string roof = faces(polygon, skeleton, reference);
  const std::string area = singular_parts(polygon, singular);
  create_folder(folder);
  write_file(folder + "/faces.vtu", roof);
  write_file(folder + "/singular_area.vtu", area);
}

void write_mesh(const std::string& file, const PolygonMesh& mesh) {
  vtkNew<vtkPoints> points = double_points();
  for (const Vec2& p : mesh.points) points->InsertNextPoint(p.x(), p.y(), 0);
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkIntArray> index = integers("cell");
  vtkNew<vtkIntArray> part = integers("part");
  vtkNew<vtkDoubleArray> area = doubles("area", 1);
  for (size_t i = 0; i < mesh.cells.size(); ++i) {
    const std::vector<Vec2> ring = cell_ring(mesh, mesh.cells[i]);
    const double of_cell = area_moments(Polygon(ring)).area;
    const std::vector<std::vector<int>> parts = convex_cells(ring);
    for (size_t k = 0; k < parts.size(); ++k) {
      index->InsertNextValue(static_cast<int>(i));
      part->InsertNextValue(static_cast<int>(k));
      area->InsertNextValue(of_cell);
      cells->InsertNextCell(static_cast<int>(parts[k].size()));
      for (const int corner : parts[k]) cells->InsertCellPoint(mesh.cells[i][corner]);
    }
  }
  write_file(file, xml(grid_of(points, VTK_POLYGON, cells, {index, part, area})));
}

}  // namespace apothem
