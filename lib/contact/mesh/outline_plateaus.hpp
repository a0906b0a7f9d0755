// Where outlines are deeper in each other than their collars: the potential is constant inside the
// top of a collar (docs/theory.md, Contact). Which edges and faces that concerns follows from the
// places where edges cross tops, and from one winding number for each closed line, which most often
// stays what it was at the last search.
#pragma once

#include <span>
#include <vector>

#include "geometry/spatial/boxes.hpp"
#include "lib/contact/mesh/edge_face.hpp"
#include "lib/contact/surface/outlines.hpp"

namespace apothem {

class OutlinePlateaus {
 public:
  /// An edge of one outline inside the top of a body.
  struct Edge {
    int edge;
    BodyIndex in;       ///< the body
    double sum, first;  ///< INT W du and INT W u du, with the winding number W of the top
    double swept;       ///< part of the area inside both, m^2
  };
  /// A face whose top lies in another body.
  struct Face {
    int face;
    BodyIndex in;                  ///< the body
    CollarMoments<double> moment;  ///< what collar_piece leaves out
    double swept;                  ///< part of the area inside both, m^2
  };

  explicit OutlinePlateaus(const Outlines& outlines) : outlines_(outlines) {}

  /// After a search: the pairs of bodies, both bodies of each being the one of the edges in turn. A
  /// body that touches itself is a pair with itself: an outline counts once less round a top of the
  /// same body, which lies inside it by nature.
  void take(std::span<const BoxPair> pairs);
  /// Forgets the crossings.
  void begin() { crossings_.clear(); }
  void add(const EdgeFace& pair, const CollarCrossings<double>& top) {
    for (int i = 0; i < top.count; ++i) {
      crossings_.push_back({pair.edge, pair.face, top.at[static_cast<size_t>(i)]});
    }
  }
  /// Finds edges and faces where the outlines are. The crossings must be those of all candidates.
  void evaluate();

  /// Ascending pairs of bodies (that of the edges first), then along closed lines.
  [[nodiscard]] const std::vector<Edge>& edges() const { return edges_; }
  [[nodiscard]] const std::vector<Face>& faces() const { return faces_; }

 private:
  struct Crossing {
    int edge, face;
    CollarCrossing<double> at;
  };
  /// One vertex of a closed line: of an outline in the top of a body, or of a top in an outline.
  struct Base {
    int loop, vertex;
    int winding;
    bool top;
    bool settled;  ///< until the next search
  };
  /// Edges of one body, faces of another, and their bases: first the loops of the edges.
  struct Pair {
    BodyIndex edges, faces;
    size_t first, end;
  };

  void add_pair(BodyIndex edges, BodyIndex faces);
  [[nodiscard]] Base base_of(int loop, BodyIndex other, bool top) const;
  void settle(Base& base, BodyIndex other) const;
  [[nodiscard]] int winding(const Vec2& place, int loop, BodyIndex other, bool top,
                            bool* clear = nullptr) const;
  void find_edges(const Pair& pair, std::span<const Crossing> crossings);
  void find_faces(const Pair& pair, std::span<Crossing> crossings);

  const Outlines& outlines_;
  std::vector<Pair> pairs_;  ///< ascending
  std::vector<Base> bases_;
  bool quiet_ = true;  ///< no base needs a look, and none is inside
  std::vector<Crossing> crossings_;
  std::vector<int> at_;  ///< first crossing of each edge or face, or -1
  std::vector<Edge> edges_;
  std::vector<Face> faces_;
};

}  // namespace apothem
