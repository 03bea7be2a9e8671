// Test cases: the points that the arm's tip has to reach, one after the other. A case is generated
// from the name of its set ("train/1", "validation/1", "test/2") and its number alone, or read from
// a file.
//
// Generation (thesis section 5.3.6): start at the sphere's centre; point 1 on the surface in a
// random direction; point 2 opposite; then for k = 3..n a uniformly random direction at distance
// ds_k from the point before, redrawn until the point lies inside the sphere.
//   ds_1 = r,   ds_k = 2r (s_min / 2r)^((k-2)/(n-2))
//
// Bred cases belong to a set named "coevolved/ID". The number of a bred case is its genome: four
// keys of 15 bits, the first key in the lowest bits. Each key determines the directions of a
// quarter of the points. A child with keys of two parents therefore moves like one parent in some
// quarters and like the other parent in the rest. A direction is drawn again only if it leads out
// of the sphere, which depends on where the quarter starts. A bred case, too, depends on the name
// of its set and its number alone.
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

// Coordinates are in m, in the robot's base frame.
struct TestCase {
  std::vector<Eigen::Vector3d> points_m;  // the first one is the start, at rest; at least two
  // The tool's orientation at each point: its frame in the world. Empty: as the task says.
  std::vector<Eigen::Quaterniond> turns = {};
  // The joint positions at each point (rad or m, one per joint). Empty: inverse kinematics finds them.
  std::vector<std::vector<double>> joints = {};
  // True if the target does not stop at the points: it is at point k after k control periods.
  bool continuous = false;
};

// A reason why a case cannot be used.
struct CaseFault {
  std::size_t point;  // the point at which it shows
  std::string what;   // continues the sentence "case N, point P "
};

// Returns a fault if the case has fewer than two points, a coordinate that is not finite or too
// large to be in metres, or a point equal to its predecessor.
std::optional<CaseFault> find_fault(const TestCase& test_case);

struct WorkspaceSphere {
  Eigen::Vector3d centre_m{1.4, 0.0, 0.9};
  double radius_m = 0.8;          // r
  double shortest_move_m = 0.05;  // s_min
  int points = 25;                // n, without the start
  // If set, a unit vector: points lie in the disc perpendicular to it, for arms that move in a
  // plane.
  std::optional<Eigen::Vector3d> normal = std::nullopt;

  double calc_move_m(int k) const;  // ds_k, k = 1..n
};

// Returns a generated or bred case. Throws Error{usage} if the sphere's numbers are not usable.
TestCase make_test_case(std::string_view set_name, std::uint64_t number,
                        const WorkspaceSphere& sphere);

inline constexpr std::string_view kBredPrefix = "coevolved/";
inline constexpr int kGenomeKeys = 4;
inline constexpr int kGenomeKeyBits = 15;
inline constexpr std::uint64_t kGenomeKeyValues = std::uint64_t{1} << kGenomeKeyBits;

constexpr std::uint64_t get_key(std::uint64_t genome, int place) {
  return genome >> (kGenomeKeyBits * place) & (kGenomeKeyValues - 1);
}

constexpr std::uint64_t set_key(std::uint64_t genome, int place, std::uint64_t key) {
  const int shift = kGenomeKeyBits * place;
  return (genome & ~((kGenomeKeyValues - 1) << shift)) | key << shift;
}

// Returns the place of the key that determines point k = 1..n of a case.
constexpr int find_key_place(int k, int points) {
  return (k - 1) * kGenomeKeys / points;
}

// A named, ordered collection of test cases: endless if generated, finite if read from a file.
class TestSet {
 public:
  // Throws Error{usage} if the sphere's numbers are not usable.
  static TestSet make_generated(std::string name, const WorkspaceSphere& sphere);
  // Reads a file as read_test_cases() does. The set's name is "file:" and the content hash.
  static TestSet load(const std::filesystem::path& file);
  // Returns an endless set in which every case is the same.
  static TestSet make_repeated(std::string name, TestCase the_case);
  // Throws Error{bad_data} if there is no case, or if a case has a fault.
  static TestSet make_from_cases(std::vector<TestCase> cases);

  const std::string& name() const { return name_; }
  std::optional<std::uint64_t> size() const;  // empty: endless
  // Throws Error{usage} unless number < size().
  TestCase make_case(std::uint64_t number) const;

 private:
  TestSet(std::string name, const WorkspaceSphere& sphere);
  std::string name_;
  WorkspaceSphere sphere_;
  std::shared_ptr<const std::vector<TestCase>> cases_;  // null: generated
  bool repeated_ = false;
};

// Reads a file of at most 256 MiB: JSON {"cases": [[[x,y,z], ...], ...]}, or CSV with the header
// case,point,x_m,y_m,z_m, in m. A text that begins with '{' or '[' is JSON. Other top-level keys of
// the JSON are ignored. Throws Error{bad_data}, naming file, line (CSV), case and point, and
// Error{io} if the file cannot be read.
std::vector<TestCase> read_test_cases(const std::filesystem::path& file);
// Parses the same from a text; `name` stands for the file in messages.
std::vector<TestCase> parse_test_cases(std::string_view text, const std::string& name);

// Write the points of cases (without turns) in the formats that read_test_cases() reads.
std::string to_json(std::span<const TestCase> cases);
std::string to_csv(std::span<const TestCase> cases);

// Returns a SHA-256 over the bits of the coordinates. Equal cases have equal hashes, whatever file
// or generator they came from.
std::string calc_content_hash(std::span<const TestCase> cases);

}  // namespace armwright
