// The lower envelope of linear functions over a polygon, for any number type: its faces, its
// highest points, and the volume under it. Each face is computed by clipping, independently of the
// others. There is no topology that round-off could make inconsistent, and the results depend
// continuously on the functions.
//
// Polygons here are rings of points in counter-clockwise order. INT stands for an integral.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/polygon/cyclic.hpp"

namespace apothem::lower_envelope {

/// A point or a vector of the plane.
template <class Real>
using Vec = Eigen::Matrix<Real, 2, 1>;

/// The z component of the cross product a x b.
template <class Real>
Real cross(const Vec<Real>& a, const Vec<Real>& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// A linear function of the plane: gradient . x + height. Its zeros form a line, such as that of an
/// edge.
template <class Real>
struct Line {
  Vec<Real> gradient;  ///< gradient of the function
  Real height;         ///< value at the origin
  /// Value at the point x.
  Real operator()(const Vec<Real>& x) const { return gradient.dot(x) + height; }
};

/// The part of the polygon where side(x) >= 0 if `closed`, otherwise where side(x) > 0, in the
/// memory of `inside`.
template <class Real>
void clip_into(const std::vector<Vec<Real>>& polygon, const Line<Real>& side, bool closed,
               std::vector<Vec<Real>>& inside) {
  inside.clear();
  if (polygon.empty()) return;
  inside.reserve(polygon.size() + 2);
  const auto keep = [&](const Real& d) { return d > 0 || (closed && d == 0); };
  const Vec<Real>* p = &polygon.back();
  Real dp = side(*p);
  for (const Vec<Real>& q : polygon) {
    const Real dq = side(q);
    if (keep(dp) != keep(dq)) inside.push_back(*p + (q - *p) * (dp / (dp - dq)));
    if (keep(dq)) inside.push_back(q);
    p = &q;
    dp = dq;
  }
}
/// The same in memory of its own.
template <class Real>
std::vector<Vec<Real>> clip(const std::vector<Vec<Real>>& polygon, const Line<Real>& side,
                            bool closed) {
  std::vector<Vec<Real>> inside;
  clip_into(polygon, side, closed, inside);
  return inside;
}

/// Memory of faces, kept between calls.
template <class Real>
struct Memory {
  std::vector<Vec<Real>> face, part;
};

/// The part of the polygon where line e is the lowest of all lines, in `memory`. Both faces at a
/// bisector compute it with the same bits, and of two equal lines only the first one has a face, so
/// no area counts twice.
template <class Real>
const std::vector<Vec<Real>>& face_into(const std::vector<Vec<Real>>& polygon,
                                        const std::vector<Line<Real>>& lines, size_t e,
                                        Memory<Real>& memory) {
  memory.face = polygon;
  for (size_t j = 1; j < lines.size() && !memory.face.empty(); ++j) {
    const size_t k = (e + j) % lines.size();
    clip_into(memory.face,
              {lines[k].gradient - lines[e].gradient, lines[k].height - lines[e].height}, k > e,
              memory.part);
    memory.face.swap(memory.part);
  }
  return memory.face;
}

/// INT f dA over a polygon for a linear function f, by a fan of triangles.
template <class Real>
Real area_integral(const std::vector<Vec<Real>>& polygon, const Line<Real>& f) {
  Real sum = 0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const Vec<Real>&p = polygon[0], &q = polygon[i - 1], &r = polygon[i];
    sum += cross<Real>(q - p, r - p) * (f(p) + f(q) + f(r)) / 6;
  }
  return sum;
}

/// INT min_i lines[i] dA over a polygon. A limit of the integrand is one more line.
template <class Real>
Real volume_under(const std::vector<Line<Real>>& lines, const std::vector<Vec<Real>>& polygon,
                  Memory<Real>& memory) {
  Real volume = 0;
  for (size_t e = 0; e < lines.size(); ++e) {
    volume += area_integral(face_into(polygon, lines, e, memory), lines[e]);
  }
  return volume;
}

/// The part of a ring inside a convex polygon. If the ring is not convex, the part may consist of
/// several pieces that are connected by edges; these edges cancel in every integral.
template <class Real>
std::vector<Vec<Real>> inside(std::vector<Vec<Real>> part, const std::vector<Vec<Real>>& convex) {
  for (size_t i = 0; i < convex.size() && !part.empty(); ++i) {
    const Vec<Real>& p = convex[i];
    const Vec<Real> e = after(convex, i) - p;
    const Vec<Real> normal(-e.y(), e.x());
    part = clip<Real>(part, {normal, -normal.dot(p)}, true);
  }
  return part;
}

/// A polygon that counts with the sign +1 or -1 in a sum of polygons.
template <class Real>
struct SignedRing {
  std::vector<Vec<Real>> ring;  ///< counter-clockwise
  int sign;                     ///< +1 or -1
};

/// Triangles whose signed sum is the given polygon, which need not be convex.
template <class Real>
std::vector<SignedRing<Real>> fan(const std::vector<Vec<Real>>& polygon) {
  std::vector<SignedRing<Real>> triangles;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const Vec<Real>&a = polygon[0], &b = polygon[i - 1], &c = polygon[i];
    const Real twice = cross<Real>(b - a, c - a);
    if (twice > 0) triangles.push_back({{a, b, c}, 1});
    if (twice < 0) triangles.push_back({{a, c, b}, -1});
  }
  return triangles;
}

/// The smallest and the largest coordinates of a polygon, which has a corner.
template <class Real>
struct Bounds {
  explicit Bounds(const std::vector<Vec<Real>>& polygon) : low(polygon[0]), high(polygon[0]) {
    for (const Vec<Real>& p : polygon) {
      for (int i = 0; i < 2; ++i) {
        if (p[i] < low[i]) low[i] = p[i];
        if (p[i] > high[i]) high[i] = p[i];
      }
    }
  }
  /// True if these two polygons have no area in common.
  [[nodiscard]] bool apart(const Bounds& other) const {
    return high[0] < other.low[0] || other.high[0] < low[0] || high[1] < other.low[1] ||
           other.high[1] < low[1];
  }
  Vec<Real> low, high;
};

/// INT phi dA over the signed sum of convex polygons `parts`. phi is given by its faces, which are
/// polygons, and by the linear function of each face. If `capped`, phi is limited to 1.
template <class Real>
Real volume_under_faces(const std::vector<std::vector<Vec<Real>>>& faces,
                        const std::vector<Line<Real>>& planes, bool capped,
                        const std::vector<SignedRing<Real>>& parts) {
  const Line<Real> one{Vec<Real>(0, 0), 1};
  Real volume = 0;
  const std::vector<Bounds<Real>> of_faces(faces.begin(), faces.end());
  for (const SignedRing<Real>& part : parts) {
    const Bounds<Real> of_part(part.ring);
    for (size_t e = 0; e < faces.size(); ++e) {
      if (of_part.apart(of_faces[e])) continue;
      const std::vector<Vec<Real>> face = inside(faces[e], part.ring);
      const Line<Real>& plane = planes[e];
      if (!capped) {
        volume += part.sign * area_integral(face, plane);
        continue;
      }
      volume +=
          part.sign * (area_integral(clip(face, {-plane.gradient, 1 - plane.height}, true), plane) +
                       area_integral(clip(face, {plane.gradient, plane.height - 1}, false), one));
    }
  }
  return volume;
}

/// A corner of a face of the envelope.
template <class Real>
struct Corner {
  Vec<Real> point;  ///< position
  Real height;      ///< value of the envelope there
};

/// The corners of all faces of the envelope over a polygon. The maximum of the envelope is at one
/// of them.
template <class Real>
std::vector<Corner<Real>> corners(const std::vector<Line<Real>>& lines,
                                  const std::vector<Vec<Real>>& polygon) {
  std::vector<Corner<Real>> result;
  Memory<Real> memory;
  for (size_t e = 0; e < lines.size(); ++e) {
    for (const Vec<Real>& point : face_into(polygon, lines, e, memory)) {
      result.push_back({point, lines[e](point)});
    }
  }
  return result;
}

}  // namespace apothem::lower_envelope
