// The helper program: constructs straight skeletons with CGAL, one after the other.

#include <stdexcept>

#include "geometry/skeleton/helper_side.hpp"
#include "geometry/skeleton/skeleton_program.hpp"

namespace {

using namespace apothem;

void construct(const std::vector<double>& request, const SendNumbers& send) {
  size_t at = 0;
  const auto take = [&] { return request.at(at++); };
  if (take() != kSkeletonRequest) throw std::runtime_error("a request of another version");
  const bool exact = take() != 0;
  while (at < request.size()) {
    Rings polygon(static_cast<size_t>(take()));
    for (std::vector<Vec2>& ring : polygon) {
      ring.resize(static_cast<size_t>(take()));
      for (Vec2& v : ring) {
        v.x() = take();
        v.y() = take();
      }
    }
    SkeletonMessage message = cgal_skeleton(polygon, exact);
    message.insert(message.begin(), static_cast<double>(message.size()));
    send(message);
  }
}

}  // namespace

int main(int argc, char** argv) { serve_request(argc, argv, construct); }
