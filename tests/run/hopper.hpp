// A scene in which bodies come and go.
#pragma once

#include <string>

namespace apothem::test {

// Stones that fall through a gap between two ramps and out of the world; new ones come from above.
inline std::string hopper(const std::string& outside, const std::string& more = "",
                          const std::string& mesh = "") {
  return R"({ "gravity": [0, -10], "materials": { "rock": { "density": 2000, "young": 2e6, "poisson": 0.2 } },
    "contact": { "normal_stiffness": 1e6, "friction": { "coefficient": 0.3, "tangential_stiffness": 8e5 },
                 "damping": { "model": "viscous", "ratio": 0.2 } },
    "bodies": [
      { "name": "left", "material": "rock", "motion": "fixed", "polygon": [[-3, 0], [-0.7, 0], [-2, 1.3], [-3, 1.3]] },
      { "name": "right", "material": "rock", "motion": "fixed", "polygon": [[0.7, 0], [3, 0], [3, 1.3], [2, 1.3]] } ],
    "fill": [ { "name": "stone", "material": "rock", "region": [[-1.5, 1.3], [1.5, 1.3], [1.5, 3], [-1.5, 3]],
                "shapes": [ { "quadrilateral": {} }, { "cross": {} } ], "diameter": 0.28, "count": 12,
                "repeat": { "times": 3, "every": 0.3 })" +
         mesh + R"( } ],
    "world": { "box": [[-4, -1], [4, 6]], "outside": ")" +
         outside +
         R"(" }, "regions": { "above": { "polygon": [[-3, 0], [3, 0], [3, 6], [-3, 6]] } },)" +
         more +
         R"( "time": { "end": 3 }, "output": { "frames": 6, "history": { "interval": 0.05 } } })";
}

inline const std::string kStops =
    R"("stop": [ { "name": "emptied", "region": "above", "count_below": 1, "after": 1 },
                 { "name": "stuck", "region": "above", "no_exit_for": 0.8, "kinetic_per_body": 0.1 } ],
       "measure": [ { "name": "left", "quantity": "above.count", "take": "last" }, { "name": "out", "stopped_by": "emptied" },
                    { "name": "t", "quantity": "time" } ],)";

}  // namespace apothem::test
