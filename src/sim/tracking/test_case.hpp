// Test cases: the points that the arm's tip has to reach, one after the other. A generated case is
// a pure function of the name of its set ("train/1", "validation/1", "test/2") and its number; sets
// can also be files.
//
// Generation (thesis section 5.3.6): start at the sphere's centre; point 1 on the surface in a
// random direction; point 2 opposite; then for k = 3..n a uniformly random direction at distance
// ds_k from the point before, redrawn until the point lies inside the sphere. ds_1 = r, ds_k = 2r
// (s_min / 2r)^((k-2)/(n-2)).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace armwright {

struct TestCase {
  std::vector<Eigen::Vector3d> points_m;  // the first is the start, at rest; at least two
  // How the tool is turned at each point, its frame in the world; none: as the task says.
  std::vector<Eigen::Quaterniond> turns = {};
  // The points are not stopped at: the target is at point k after k control periods.
  bool continuous = false;
};

struct WorkspaceSphere {
  Eigen::Vector3d centre_m{1.4, 0.0, 0.9};
  double radius_m = 0.8;
  double shortest_move_m = 0.05;  // s_min
  int points = 25;                // n, the start not counted
  // Unit vector: the disc across it instead, for arms that move in a plane.
  std::optional<Eigen::Vector3d> normal = std::nullopt;

  double calc_move_m(int k) const;  // ds_k, k = 1..n
};

TestCase make_test_case(std::string_view set_name, std::uint64_t number,
                        const WorkspaceSphere& sphere);

// A named, ordered collection of test cases: endless when generated, finite when read from a file.
class TestSet {
 public:
  static TestSet make_generated(std::string name, const WorkspaceSphere& sphere);
  // JSON {"cases": [[[x,y,z], ...], ...]} in metres or CSV with the header case,point,x_m,y_m,z_m.
  // The name is "file:" and the content hash. Error{bad_data} names file, case and point.
  static TestSet load(const std::filesystem::path& file);
  // Endless, and every case is the same.
  static TestSet make_repeated(std::string name, TestCase the_case);
  static TestSet make_from_cases(std::vector<TestCase> cases);

  const std::string& name() const { return name_; }
  std::optional<std::uint64_t> size() const;       // nothing: endless
  TestCase make_case(std::uint64_t number) const;  // number < size()

 private:
  TestSet(std::string name, const WorkspaceSphere& sphere);
  std::string name_;
  WorkspaceSphere sphere_;
  std::shared_ptr<const std::vector<TestCase>> cases_;  // null: generated
  bool repeated_ = false;
};

std::string to_json(std::span<const TestCase> cases);
std::string to_csv(std::span<const TestCase> cases);

// SHA-256 over the coordinates' bits: equal for equal cases whatever file or generator they came
// from.
std::string calc_content_hash(std::span<const TestCase> cases);

}  // namespace armwright
