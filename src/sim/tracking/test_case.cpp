#include "sim/tracking/test_case.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/random.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// A move of length ds from a point on the surface ends inside with probability (1 - ds/2r) / 2.
// With the largest ratio, one point needs some thousand draws; with the published 0.05 m and 25
// points it needs about fourteen.
constexpr double kLargestRatio = 0.999;  // of one move to the one before
constexpr int kMostPoints = 1000;
// As a share of the coordinates' size. Shorter moves would be lost in the coordinates' rounding.
constexpr double kFinestMove = 1e-6;

[[noreturn]] void refuse(const std::string& message) {
  throw Error(ErrorKind::usage, "workspace sphere: " + message);
}

void check_sphere(const WorkspaceSphere& sphere) {
  const Eigen::Vector3d& c = sphere.centre_m;
  if (!std::isfinite(c.x()) || !std::isfinite(c.y()) || !std::isfinite(c.z())) {
    refuse(fmt::format("the centre is ({}, {}, {}) m; it must be finite", c.x(), c.y(), c.z()));
  }
  if (sphere.normal && !(std::abs(sphere.normal->norm() - 1) < 1e-9)) {
    refuse(fmt::format("the normal has the length {}; it must be a unit vector",
                       sphere.normal->norm()));
  }
  if (!(sphere.radius_m > 0) || !std::isfinite(sphere.radius_m)) {
    refuse(fmt::format("the radius is {} m; it must be finite and > 0", sphere.radius_m));
  }
  if (sphere.points < 3 || sphere.points > kMostPoints) {
    refuse(fmt::format("the number of points is {}; it must be from 3 to {}", sphere.points,
                       kMostPoints));
  }
  const double least_m = kFinestMove * (c.cwiseAbs().maxCoeff() + sphere.radius_m);
  const double most_m = 2 * sphere.radius_m * std::pow(kLargestRatio, sphere.points - 2);
  if (!(sphere.shortest_move_m >= least_m && sphere.shortest_move_m <= most_m)) {
    refuse(fmt::format(
        "the shortest move is {} m; it must be from {} to {} m for a radius of {} m and {} points "
        "(a longer one leaves almost no direction that stays inside)",
        sphere.shortest_move_m, least_m, most_m, sphere.radius_m, sphere.points));
  }
}

// Draws a uniformly random point on the unit sphere by rejection in the disc (Marsaglia 1972, Ann.
// Math. Statist. 43). The only function that it needs is the square root, which IEEE 754 rounds
// exactly. The bits are therefore the same with every mathematical library.
Eigen::Vector3d draw_direction(RandomStream& random) {
  while (true) {
    const double u = random.uniform(-1, 1);
    const double v = random.uniform(-1, 1);
    const double square = u * u + v * v;
    if (square < 1) {
      const double scale = 2 * std::sqrt(1 - square);
      return {u * scale, v * scale, 1 - 2 * square};
    }
  }
}

// Draws a uniformly random direction in the plane perpendicular to `normal`, by the same method.
Eigen::Vector3d draw_direction(RandomStream& random, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d first = normal.unitOrthogonal();
  const Eigen::Vector3d second = normal.cross(first);
  while (true) {
    const double u = random.uniform(-1, 1);
    const double v = random.uniform(-1, 1);
    const double square = u * u + v * v;
    if (square < 1 && square > 0) {
      return (u * first + v * second) / std::sqrt(square);
    }
  }
}

Eigen::Vector3d draw_direction(RandomStream& random, const WorkspaceSphere& sphere) {
  return sphere.normal ? draw_direction(random, *sphere.normal) : draw_direction(random);
}

bool lies_inside(const Eigen::Vector3d& point_m, const WorkspaceSphere& sphere) {
  const double x = point_m.x() - sphere.centre_m.x();
  const double y = point_m.y() - sphere.centre_m.y();
  const double z = point_m.z() - sphere.centre_m.z();
  return x * x + y * y + z * z <= sphere.radius_m * sphere.radius_m;
}

void append_little_endian(std::string& bytes, std::uint64_t word) {
  for (int shift = 0; shift < 64; shift += 8) {
    bytes.push_back(static_cast<char>(word >> shift & 0xFF));
  }
}

// Generates a case. `get_stream(k)` returns the random numbers for point k.
template <class GetStream>
TestCase make_case(const WorkspaceSphere& sphere, const GetStream& get_stream) {
  TestCase made;
  auto& points_m = made.points_m;
  points_m.reserve(static_cast<std::size_t>(sphere.points) + 1);
  points_m.push_back(sphere.centre_m);
  const Eigen::Vector3d first_m = sphere.radius_m * draw_direction(get_stream(1), sphere);
  points_m.push_back(sphere.centre_m + first_m);
  points_m.push_back(sphere.centre_m - first_m);
  for (int k = 3; k <= sphere.points; ++k) {
    const double move_m = sphere.calc_move_m(k);
    RandomStream& random = get_stream(k);
    Eigen::Vector3d next_m;
    do {
      next_m = points_m.back() + move_m * draw_direction(random, sphere);
    } while (!lies_inside(next_m, sphere));
    points_m.push_back(next_m);
  }
  return made;
}

}  // namespace

double WorkspaceSphere::calc_move_m(int k) const {
  if (k == 1) {
    return radius_m;
  }
  // The power of doubles differs in the last bit between libraries. The power of long doubles,
  // rounded to double, does not.
  const double exponent = static_cast<double>(k - 2) / (points - 2);
  const double ratio = shortest_move_m / (2 * radius_m);
  return 2 * radius_m * static_cast<double>(std::pow(static_cast<long double>(ratio), exponent));
}

TestCase make_test_case(std::string_view set_name, std::uint64_t number,
                        const WorkspaceSphere& sphere) {
  check_sphere(sphere);
  if (!set_name.starts_with(kBredPrefix)) {
    RandomStream random(set_name, number);
    return make_case(sphere, [&](int) -> RandomStream& { return random; });
  }
  std::optional<RandomStream> own;  // each point has one, so redrawing it does not affect others
  return make_case(sphere, [&](int k) -> RandomStream& {
    own.emplace(fmt::format("{}/{}", set_name, k),
                get_key(number, find_key_place(k, sphere.points)));
    return *own;
  });
}

TestSet::TestSet(std::string name, const WorkspaceSphere& sphere)
    : name_(std::move(name)), sphere_(sphere) {}

TestSet TestSet::make_generated(std::string name, const WorkspaceSphere& sphere) {
  check_sphere(sphere);
  return TestSet(std::move(name), sphere);
}

TestSet TestSet::load(const std::filesystem::path& file) {
  return make_from_cases(read_test_cases(file));
}

TestSet TestSet::make_from_cases(std::vector<TestCase> cases) {
  if (cases.empty()) {
    throw Error(ErrorKind::bad_data, "test cases: there is none; a set must hold at least one");
  }
  for (std::size_t i = 0; i < cases.size(); ++i) {
    if (const auto fault = find_fault(cases[i])) {
      throw Error(ErrorKind::bad_data,
                  fmt::format("test cases: case {}, point {} {}", i, fault->point, fault->what));
    }
  }
  TestSet set("file:" + calc_content_hash(cases).substr(0, 16), WorkspaceSphere{});
  set.cases_ = std::make_shared<const std::vector<TestCase>>(std::move(cases));
  return set;
}

TestSet TestSet::make_repeated(std::string name, TestCase the_case) {
  TestSet set(std::move(name), WorkspaceSphere{});
  set.cases_ = std::make_shared<const std::vector<TestCase>>(1, std::move(the_case));
  set.repeated_ = true;
  return set;
}

std::optional<std::uint64_t> TestSet::size() const {
  return cases_ && !repeated_ ? std::optional<std::uint64_t>(cases_->size()) : std::nullopt;
}

TestCase TestSet::make_case(std::uint64_t number) const {
  if (!cases_) {
    return make_test_case(name_, number, sphere_);
  }
  if (repeated_) {
    return cases_->front();
  }
  if (number >= cases_->size()) {
    throw Error(ErrorKind::usage,
                fmt::format("test set {} has {} cases, counted from 0; there is no case {}", name_,
                            cases_->size(), number));
  }
  return (*cases_)[number];
}

std::string to_json(std::span<const TestCase> cases) {
  std::string text = "{\"cases\": [";
  const char* case_separator = "\n";
  for (const TestCase& test_case : cases) {
    text += std::exchange(case_separator, ",\n");
    const char* point_separator = "[";
    for (const Eigen::Vector3d& p : test_case.points_m) {
      fmt::format_to(std::back_inserter(text), "{}[{}, {}, {}]",
                     std::exchange(point_separator, ", "), p.x(), p.y(), p.z());
    }
    text += "]";
  }
  return text + "\n]}\n";
}

std::string to_csv(std::span<const TestCase> cases) {
  std::string text = "case,point,x_m,y_m,z_m\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (std::size_t k = 0; k < cases[i].points_m.size(); ++k) {
      const Eigen::Vector3d& p = cases[i].points_m[k];
      fmt::format_to(std::back_inserter(text), "{},{},{},{},{}\n", i, k, p.x(), p.y(), p.z());
    }
  }
  return text;
}

std::string calc_content_hash(std::span<const TestCase> cases) {
  std::string bytes;
  append_little_endian(bytes, cases.size());
  for (const TestCase& test_case : cases) {
    append_little_endian(bytes, test_case.points_m.size());
    for (const Eigen::Vector3d& point_m : test_case.points_m) {
      for (const double coordinate_m : point_m) {
        append_little_endian(bytes, std::bit_cast<std::uint64_t>(coordinate_m));
      }
    }
    for (const Eigen::Quaterniond& turn : test_case.turns) {
      for (const double coefficient : turn.coeffs()) {
        append_little_endian(bytes, std::bit_cast<std::uint64_t>(coefficient));
      }
    }
    if (test_case.continuous) {
      bytes.push_back('c');
    }
  }
  return calc_sha256_hex(bytes);
}

}  // namespace armwright
