#include "lib/scene/faces.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "geometry/spatial/boxes.hpp"
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

// Moves ends of lines to where they nearly meet another line. Only what is near an end is looked
// at, in the order of the lines, so that the result is that of looking at all.
class EndSnapper {
 public:
  EndSnapper(std::vector<Line> lines, double tolerance)
      : lines_(std::move(lines)), tolerance_(tolerance) {
    for (size_t i = 0; i < lines_.size(); ++i) {
      for (size_t k = 0; k < std::max<size_t>(lines_[i].size(), 2) - 1; ++k) {
        if (!lines_[i].empty()) segments_.push_back({i, k, {}});
      }
    }
    find_near();
  }

  std::vector<Line> snapped() {
    for (size_t i = 0; i < lines_.size(); ++i) {
      if (lines_[i].size() < 2) continue;
      snap_end(i, lines_[i].front(), near_[2 * i]);
      snap_end(i, lines_[i].back(), near_[2 * i + 1]);
    }
    return with_feet();
  }

 private:
  // From a vertex of a line to the next one. A line of one vertex has one that ends there.
  struct Segment {
    size_t line, from;
    std::vector<Vec2> feet;  // ends that lie on it, in the order of the line
  };

  [[nodiscard]] const Vec2& start(const Segment& s) const { return lines_[s.line][s.from]; }
  [[nodiscard]] const Vec2& end(const Segment& s) const {
    return lines_[s.line][std::min(s.from + 1, lines_[s.line].size() - 1)];
  }

  // The segments near each end. Both may move by the tolerance.
  void find_near() {
    std::vector<Box> boxes;
    double farthest = 0;
    for (const Segment& s : segments_) {
      const Box& box = boxes.emplace_back(box_of(start(s), end(s)));
      farthest = std::max(
          {farthest, std::abs(box.x0), std::abs(box.y0), std::abs(box.x1), std::abs(box.y1)});
    }
    const double reach = 2.01 * tolerance_ + 1e-12 * farthest;  // more than round-off
    for (Box& box : boxes) box = box.grown(reach);
    std::vector<BoxPair> pairs;
    BoxGrid().find_pairs(boxes, pairs);
    near_.resize(2 * lines_.size());
    const auto add = [&](size_t of, size_t other) {
      const size_t line = segments_[of].line, from = segments_[of].from;
      const auto look = [&](size_t end, const Vec2& v) {
        if (!apart({v.x(), v.y(), v.x(), v.y()}, boxes[other])) near_[end].push_back(other);
      };
      if (from == 0) look(2 * line, lines_[line].front());
      if (from + 2 >= lines_[line].size()) look(2 * line + 1, lines_[line].back());
    };
    auto pair = pairs.begin();
    for (size_t i = 0; i < segments_.size(); ++i) {
      add(i, i);
      for (; pair != pairs.end() && pair->first == static_cast<std::int32_t>(i); ++pair) {
        const auto other = static_cast<size_t>(pair->second);
        add(i, other);
        add(other, i);
      }
    }
  }

  // A vertex is preferred to the inside of a segment, because a foot next to a vertex would leave
  // an edge shorter than the tolerance.
  void snap_end(size_t own, Vec2& end_of_line, const std::vector<size_t>& near) {
    const Vec2* vertex = nullptr;
    double nearest = tolerance_;
    const auto look = [&](const Vec2& v) {
      if (&v == &end_of_line || (v - end_of_line).norm() > nearest) return;
      vertex = &v;
      nearest = (v - end_of_line).norm();
    };
    for (const size_t i : near) {
      look(start(segments_[i]));
      for (const Vec2& v : segments_[i].feet) look(v);
      look(end(segments_[i]));
    }
    if (vertex != nullptr) {
      end_of_line = *vertex;
      return;
    }
    for (const size_t i : near) {
      Segment& segment = segments_[i];
      std::vector<Vec2>& feet = segment.feet;
      for (size_t k = 0; segment.line != own && k <= feet.size(); ++k) {
        const Vec2 there = foot(end_of_line, k == 0 ? start(segment) : feet[k - 1],
                                k == feet.size() ? end(segment) : feet[k]);
        if (!((there - end_of_line).norm() <= tolerance_)) continue;
        end_of_line = there;
        feet.insert(feet.begin() + static_cast<std::ptrdiff_t>(k), there);
        return;
      }
    }
  }

  [[nodiscard]] std::vector<Line> with_feet() const {
    std::vector<Line> lines(lines_.size());
    for (const Segment& s : segments_) {
      Line& line = lines[s.line];
      line.push_back(start(s));
      line.insert(line.end(), s.feet.begin(), s.feet.end());
      if (s.from + 2 == lines_[s.line].size()) line.push_back(end(s));
    }
    return lines;
  }

  std::vector<Line> lines_;
  double tolerance_;
  std::vector<Segment> segments_;          // of all lines, one after the other
  std::vector<std::vector<size_t>> near_;  // of the two ends of each line: segments, ascending
};

Face face_of(OGRGeometryH polygon) {
  Face face;
  for (int i = 0; i < gdal().OGR_G_GetGeometryCount(polygon); ++i) {
    face.push_back(points_of(gdal().OGR_G_GetGeometryRef(polygon, i)));
  }
  return face;
}

}  // namespace

std::vector<Line> snap_ends(std::vector<Line> lines, double tolerance) {
  return EndSnapper(std::move(lines), tolerance).snapped();
}

std::vector<Face> faces_between(std::vector<Line> lines, double tolerance) {
  if (!gdal().OGRGetGEOSVersion(nullptr, nullptr, nullptr)) {
    throw std::runtime_error(
        "lines are polygonized by GEOS, which this build of GDAL lacks; draw closed outlines");
  }
  if (lines.empty()) return {};
  lines = snap_ends(std::move(lines), tolerance);
  const QuietGdal quiet;
  const Geometry all(gdal().OGR_G_CreateGeometry(wkbMultiLineString));
  for (const Line& line : lines) {
    const Geometry part(gdal().OGR_G_CreateGeometry(wkbLineString));
    for (const Vec2& v : line) gdal().OGR_G_AddPoint_2D(part.get(), v.x(), v.y());
    gdal().OGR_G_AddGeometry(all.get(), part.get());
  }
  // A union divides all lines where they cross. One of them suffices as its other side: with all
  // of them there it takes twice as long.
  const Geometry divided(gdal().OGR_G_Union(all.get(), gdal().OGR_G_GetGeometryRef(all.get(), 0)));
  const Geometry polygons(gdal().OGR_G_Polygonize(divided.get()));
  std::vector<Face> faces;
  for (int i = 0; polygons.get() && i < gdal().OGR_G_GetGeometryCount(polygons.get()); ++i) {
    faces.push_back(face_of(gdal().OGR_G_GetGeometryRef(polygons.get(), i)));
  }
  const auto lowest = [](const Face& face) {
    const Box box = box_of(face[0]);
    return std::pair(box.y0, box.x0);
  };
  std::ranges::stable_sort(faces,
                           [&](const Face& a, const Face& b) { return lowest(a) < lowest(b); });
  return faces;
}

}  // namespace apothem
