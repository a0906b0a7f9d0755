// Contact of outlines inside saturated regions. The potential is constant inside the offset curve
// of a collar (docs/theory.md, Contact). The edges and faces concerned follow from the places where
// edges cross offset curves, and from one winding number for each closed line, which usually is
// that of the last search.
#pragma once

#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/surface/outline_surfaces.hpp"

namespace apothem {

/// An edge of one outline inside the saturated region of a body.
struct SaturatedEdge {
  int edge;
  BodyIndex body;     ///< the body with the saturated region
  double sum, first;  ///< INT W du and INT W u du, with the winding number W of the offset curve
  double swept;       ///< contribution to the area inside both, m^2
};

/// A face whose side of the offset curve lies in another body.
struct SaturatedFace {
  int face;
  BodyIndex body;                ///< the other body
  CollarMoments<double> moment;  ///< terms that collar_piece leaves out
  double swept;                  ///< contribution to the area inside both, m^2
};

class SaturatedRegions {
 public:
  explicit SaturatedRegions(const OutlineSurfaces& outlines) : outlines_(outlines) {}

  /// Sets the pairs of bodies after a search; each body of a pair provides the edges in turn. A
  /// body that may touch itself is a pair with itself. Its outline encloses its own offset curve
  /// once by nature, and this does not count.
  void set_pairs(std::span<const BoxPair> pairs);
  /// Removes the crossings.
  void begin() { crossings_.clear(); }
  void add(const EdgeFace& pair, const CollarCrossings<double>& crossings) {
    for (int i = 0; i < crossings.count; ++i) {
      crossings_.push_back({pair.edge, pair.face, crossings.list[static_cast<size_t>(i)]});
    }
  }
  /// Finds the edges and faces at the present positions of the outlines. The crossings of all
  /// candidates must have been added.
  void evaluate();

  /// The results in ascending order of the pairs of bodies (the body of the edges first), then
  /// along the closed lines.
  [[nodiscard]] const std::vector<SaturatedEdge>& edges() const { return edges_; }
  [[nodiscard]] const std::vector<SaturatedFace>& faces() const { return faces_; }

 private:
  struct Crossing {
    int edge, face;
    CollarCrossing<double> crossing;
  };
  /// One vertex of a closed line and its winding number: a vertex of an outline in an offset curve,
  /// or of an offset curve in an outline.
  struct Base {
    int loop, vertex;
    int winding;
    bool of_offset_curve;
    bool settled;  ///< true if the winding number holds until the next search
  };
  /// The edges of one body, the faces of another one, and the range of their bases: first those of
  /// the loops of the edges.
  struct EdgeFacePair {
    BodyIndex edges, faces;
    size_t first, end;
  };

  void add_pair(BodyIndex edges, BodyIndex faces);
  [[nodiscard]] Base base_of(int loop, BodyIndex other, bool of_offset_curve) const;
  void settle(Base& base, BodyIndex other) const;
  [[nodiscard]] int winding(const Vec2& place, int loop, BodyIndex other, bool of_offset_curve,
                            bool* clear = nullptr) const;
  void find_edges(const EdgeFacePair& pair, std::span<const Crossing> crossings);
  void find_faces(const EdgeFacePair& pair, std::span<Crossing> crossings);

  const OutlineSurfaces& outlines_;
  std::vector<EdgeFacePair> pairs_;  ///< pairs, ascending
  std::vector<Base> bases_;
  bool quiet_ = true;  ///< true if all bases are settled and none of them is inside
  std::vector<Crossing> crossings_;
  std::vector<int> first_crossing_;  ///< first crossing of each edge or face, or -1
  std::vector<SaturatedEdge> edges_;
  std::vector<SaturatedFace> faces_;
};

}  // namespace apothem
