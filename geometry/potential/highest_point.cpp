#include "geometry/potential/highest_point.hpp"

#include <algorithm>
#include <array>

namespace apothem {

Summit highest_point(const std::vector<Heights>& planes) {
  double largest = 0;
  for (const Heights& plane : planes) largest = std::max(largest, plane.cwiseAbs().maxCoeff());
  const double slack = 0x1p-51 * largest;
  Summit summit;
  for (size_t i = 0; i < planes.size(); ++i) {
    if (planes[i].dot(summit.place) >= summit.height - slack) continue;
    // The summit lies on plane i. It is the highest point of this plane at which no earlier plane
    // is below it.
    Eigen::Index corner;
    planes[i].maxCoeff(&corner);
    Heights place = Heights::Unit(corner);
    for (size_t j = 0; j < i; ++j) {
      const Heights side = planes[j] - planes[i];
      if (side.dot(place) >= -slack) continue;
      // The summit lies on the line side = 0, between its two crossings with the triangle's border.
      std::array<Heights, 2> ends;
      size_t count = 0;
      for (int k = 0; k < 3; ++k) {
        const int l = (k + 1) % 3;
        if ((side[k] < 0) == (side[l] < 0)) continue;
        const double fraction = side[k] / (side[k] - side[l]);
        ends[count++] = (1 - fraction) * Heights::Unit(k) + fraction * Heights::Unit(l);
      }
      if (count < 2) continue;
      double low = 0;
      double high = 1;
      for (size_t l = 0; l < j; ++l) {
        const Heights other = planes[l] - planes[i];
        const double first = other.dot(ends[0]) + slack;
        const double second = other.dot(ends[1]) + slack;
        if (first < 0) low = std::max(low, second > 0 ? first / (first - second) : 2);
        if (second < 0) high = std::min(high, first > 0 ? first / (first - second) : -1);
      }
      if (low > high) continue;
      const double best = planes[i].dot(ends[0]) > planes[i].dot(ends[1]) ? low : high;
      place = (1 - best) * ends[0] + best * ends[1];
    }
    summit = {place, std::min(summit.height, planes[i].dot(place))};
  }
  summit.height += 2 * slack;
  return summit;
}

}  // namespace apothem
