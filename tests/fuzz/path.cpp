// A path's CSV file: what is read has points, a turn for each or none, and nothing that is no
// number.
#include <cmath>

#include "fuzz/harness.hpp"
#include "problems/config/problem_readers.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright::fuzz {

void fuzz_path(std::string_view input) {
  is_read([&] {
    const TestCase path = parse_path(input, "path.csv", {});
    require(path.points_m.size() >= 2, "a path without a move");
    require(path.turns.empty() || path.turns.size() == path.points_m.size(),
            "turns of some points only");
    for (const Eigen::Vector3d& point_m : path.points_m) {
      require(point_m.allFinite(), "a point that is no number");
    }
    for (const Eigen::Quaterniond& turn : path.turns) {
      require(std::abs(turn.norm() - 1) < 1e-6, "a turn that is no rotation");
    }
    require(path.continuous || !find_fault(path), "points with a fault");
  });
}

}  // namespace armwright::fuzz
