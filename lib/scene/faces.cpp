#include "lib/scene/faces.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "lib/scene/gdal.hpp"

namespace apothem {
namespace {

using Line = std::vector<Vec2>;
using Face = std::vector<std::vector<Vec2>>;

Vec2 foot(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double t = (p - a).dot(along) / along.squaredNorm();
  return t <= 0 ? a : t >= 1 ? b : Vec2(a + t * along);
}

// Moves ends of lines to where they nearly meet another line.
class EndSnapper {
 public:
  EndSnapper(std::vector<Line>& lines, double tolerance) : lines_(lines), tolerance_(tolerance) {}

  void snap() {
    for (size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].size() < 2) continue;
      snap_end(i, lines_[i].front());
      snap_end(i, lines_[i].back());
    }
  }

 private:
  // A vertex is preferred to the inside of a segment, because a foot next to a vertex would leave
  // an edge shorter than the tolerance.
  void snap_end(size_t own, Vec2& end) {
    const Vec2* vertex = nullptr;
    double nearest = tolerance_;
    for (const Line& line : lines_) {
      for (const Vec2& v : line) {
        if (&v == &end || (v - end).norm() > nearest) continue;
        vertex = &v;
        nearest = (v - end).norm();
      }
    }
    if (vertex != nullptr) {
      end = *vertex;
      return;
    }
    for (size_t i = 0; i < lines_.size(); ++i) {
      Line& line = lines_[i];
      for (size_t k = 0; i != own && k + 1 < line.size(); ++k) {
        const Vec2 there = foot(end, line[k], line[k + 1]);
        if (!((there - end).norm() <= tolerance_)) continue;
        end = there;
        line.insert(line.begin() + static_cast<std::ptrdiff_t>(k) + 1, there);
        return;
      }
    }
  }

  std::vector<Line>& lines_;
  double tolerance_;
};

Face face_of(OGRGeometryH polygon) {
  Face face;
  for (int i = 0; i < gdal().OGR_G_GetGeometryCount(polygon); ++i) {
    OGRGeometryH ring = gdal().OGR_G_GetGeometryRef(polygon, i);
    auto& points = face.emplace_back();
    for (int k = 0; k < gdal().OGR_G_GetPointCount(ring); ++k) {
      points.emplace_back(gdal().OGR_G_GetX(ring, k), gdal().OGR_G_GetY(ring, k));
    }
  }
  return face;
}

}  // namespace

std::vector<Face> faces_between(std::vector<Line> lines, double tolerance) {
  if (!gdal().OGRGetGEOSVersion(nullptr, nullptr, nullptr)) {
    throw std::runtime_error(
        "lines are polygonized by GEOS, which this build of GDAL lacks; draw closed outlines");
  }
  EndSnapper(lines, tolerance).snap();
  const QuietGdal quiet;
  const Geometry all(gdal().OGR_G_CreateGeometry(wkbMultiLineString));
  for (const Line& line : lines) {
    const Geometry part(gdal().OGR_G_CreateGeometry(wkbLineString));
    for (const Vec2& v : line) gdal().OGR_G_AddPoint_2D(part.get(), v.x(), v.y());
    gdal().OGR_G_AddGeometry(all.get(), part.get());
  }
  // The union with themselves divides the lines where they cross.
  const Geometry divided(gdal().OGR_G_Union(all.get(), all.get()));
  const Geometry polygons(gdal().OGR_G_Polygonize(divided.get()));
  std::vector<Face> faces;
  for (int i = 0; polygons.get() && i < gdal().OGR_G_GetGeometryCount(polygons.get()); ++i) {
    faces.push_back(face_of(gdal().OGR_G_GetGeometryRef(polygons.get(), i)));
  }
  const auto lowest = [](const Face& face) {
    Box box;
    for (const Vec2& v : face[0]) box.include(v.x(), v.y());
    return std::pair(box.y0, box.x0);
  };
  std::stable_sort(faces.begin(), faces.end(),
                   [&](const Face& a, const Face& b) { return lowest(a) < lowest(b); });
  return faces;
}

}  // namespace apothem
