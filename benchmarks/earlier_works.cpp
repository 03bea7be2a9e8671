// Computes the numbers by which the problems of earlier works (docs/earlier-works.md) are known to be
// right, and prints them beside their oracles as CSV: group, quantity, unit, oracle, armwright's number
// and the largest difference that the oracle's printed digits and the samples allow. The oracles were
// computed with numpy and scipy by other code, or published. The exit code is 1 if a number differs by
// more.

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "line_arm.hpp"
#include "problems/config/problem_loader.hpp"
#include "problems/motion/motion_problem.hpp"
#include "sim/dynamics/arm_equations.hpp"
#include "sim/motion/time_optimal.hpp"

namespace armwright {
namespace {

using std::numbers::pi;

constexpr double kDeg = pi / 180;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

int failures = 0;

void print(const char* group, const std::string& quantity, const char* unit, double oracle,
           double ours, double allowed) {
  const bool is_met = std::abs(ours - oracle) <= allowed;
  failures += is_met ? 0 : 1;
  fmt::print("{},\"{}\",{},{:.10g},{:.10g},{:.1e},{}\n", group, quantity, unit, oracle, ours,
             allowed, is_met ? "met" : "missed");
}

Evaluation evaluate(const LoadedProblem& loaded, const std::vector<double>& x) {
  return loaded.problem->evaluate(x, {.role = CaseRole::test, .set = "test/1", .numbers = {0}});
}

double get_metric(const LoadedProblem& loaded, const Evaluation& evaluation,
                  const std::string& name) {
  const auto& metrics = loaded.problem->description().metrics;
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    if (metrics[i].name == name) {
      return evaluation.metrics[i];
    }
  }
  throw std::logic_error(name);
}

void check_splines() {
  const char* const group = "time and jerk";
  const LoadedProblem loaded = load_problem("gasparetto");
  const auto print_motion = [&](const std::vector<double>& h, const char* what, double duration,
                                double jerk, double allowed) {
    const Evaluation at = evaluate(loaded, h);
    print(group, fmt::format("duration of {}", what), "s", duration,
          get_metric(loaded, at, "duration"), 2e-5);
    print(group, fmt::format("jerk of {}", what), "deg^2/s^5", jerk,
          get_metric(loaded, at, "jerk") / (kDeg * kDeg), allowed * jerk);
  };
  print_motion({0.72771, 2.16044, 2.95972, 1.79609, 0.88700}, "the fastest spline", 8.530954,
               81381.4, 1e-5);
  std::vector<double> shape = {0.08632, 0.27714, 0.29144, 0.26251, 0.08259};
  for (double& h : shape) {
    h *= 10;
  }
  print_motion(shape, "the smoothest spline of 10 s", 10, 33953, 2e-5);
  const double d[] = {65, 15, 15, 140, 40, 95}, v[] = {100, 95, 100, 150, 130, 110},
               a[] = {60, 60, 75, 70, 90, 80}, j[] = {60, 66, 85, 70, 75, 70};
  for (const auto& [profile, oracle] :
       {std::pair{RestProfile::bang_bang, 4.0}, std::pair{RestProfile::septic, 4.7177},
        std::pair{RestProfile::sine, 4.6498}}) {
    double time = 0;
    for (int i = 0; i < 6; ++i) {
      time = std::max(time, calc_least_time_s(profile, d[i], v[i], a[i], j[i]));
    }
    print(
        group,
        fmt::format("point to point, {}", rest_profile_names()[static_cast<std::size_t>(profile)]),
        "s", oracle, time, 5e-5);
  }
  const double d2[] = {11 * pi / 15, pi / 6, pi / 6, pi / 3, 3 * pi / 4, pi / 4},
               v2[] = {1.8, 2, 1.5, 2, 2.5, 2}, a2[] = {4, 5, 3.5, 4, 5, 4},
               j2[] = {20, 25, 20, 20, 30, 25};
  for (const auto& [profile, oracle] :
       {std::pair{RestProfile::bang_bang, 1.9299}, std::pair{RestProfile::septic, 2.7998}}) {
    double time = 0;
    for (int i = 0; i < 6; ++i) {
      time = std::max(time, profile == RestProfile::bang_bang
                                ? calc_jerk_limited_time_s(d2[i], v2[i], a2[i], j2[i])
                                : calc_least_time_s(profile, d2[i], v2[i], a2[i], j2[i]));
    }
    print(group,
          fmt::format("second task, {}", rest_profile_names()[static_cast<std::size_t>(profile)]),
          "s", oracle, time, 5e-5);
  }
}

void check_puma() {
  const char* const group = "PUMA 560";
  const LoadedProblem loaded = load_problem("saravanan-puma");
  const RobotModel& robot = dynamic_cast<const MotionProblem&>(*loaded.problem).config().robot;
  const articulated::ChainModel chain(robot, 9.81);
  articulated::ArmEquations equations(chain);
  const double q[] = {0, 45 * kDeg, 180 * kDeg, 0, 45 * kDeg, 0};
  equations.set(q, std::vector<double>(6, 0));
  const double gravity[] = {0, 31.63988, 6.03514, 0, 0.0282528, 0};
  const double inertia[] = {3.6594, 4.4137, 0.9378, 0.1925, 0.1713, 0.1941};
  for (std::size_t i = 0; i < 6; ++i) {
    print(group, fmt::format("gravity torque of joint {}", i + 1), "N m", gravity[i],
          equations.bias(i), 1e-5);
  }
  for (std::size_t i = 0; i < 6; ++i) {
    // The source's tensor of link 3 has 0.086 where the file has 0.0785, which a body can have.
    const double tensor = i == 1 || i == 2 ? 0.086 - 0.0785 : 0;
    print(group, fmt::format("inertia at joint {}", i + 1), "kg m^2", inertia[i],
          equations.mass(i, i) + robot.joints[i].plant.armature + tensor, 6e-5);
  }
  for (const bool rotors : {true, false}) {
    const std::vector<std::string> overrides = {
        "motion.point=[{joints=[0,0,0,0,0,0]}, {joints=[1.5707963267948966, 0.7853981633974483, "
        "-1.5707963267948966, 0.7853981633974483, 0.7853981633974483, 1.5707963267948966]}]",
        "motion.curve=rest",
        "motion.samples=401",
        "obstacle=[]",
        "motion.clearance_m=0",
        "motion.self_clearance=true",
        rotors ? "robot.plant=\"puma560.plant.toml\"" : "robot.plant=\"\""};
    const LoadedProblem move = load_problem("saravanan-puma", overrides);
    // The least time within the torques, by bisection.
    double shorter = 0.1, longer = 2;
    for (int i = 0; i < 60; ++i) {
      const double middle = (shorter + longer) / 2;
      const Evaluation at = evaluate(move, {middle});
      double worst = -1;
      for (std::size_t k = 0; k < at.constraint_values.size(); ++k) {
        if (move.problem->description().constraints[k].name.ends_with(".effort")) {
          worst = std::max(worst, at.constraint_values[k]);
        }
      }
      (worst > 0 ? shorter : longer) = middle;
    }
    const char* const arm = rotors ? "with rotors" : "without rotors";
    print(group, fmt::format("least time of the quintic move, {}", arm), "s",
          rotors ? 0.614642 : 0.552223, longer, 2e-6);
    print(group, fmt::format("energy of that move, {}", arm), "J", rotors ? 95.402 : 91.079,
          get_metric(move, evaluate(move, {longer}), "energy"), 1e-3);
    print(group, fmt::format("energy in 1 s, {}", arm), "J", rotors ? 53.648 : 47.674,
          get_metric(move, evaluate(move, {1}), "energy"), 1e-3);
    print(group, fmt::format("energy in 2 s, {}", arm), "J", rotors ? 34.782 : 33.445,
          get_metric(move, evaluate(move, {2}), "energy"), 1e-3);
  }
}

void check_links() {
  const char* const group = "link design";
  const LoadedProblem loaded = load_problem("shiakolas");
  const Evaluation at = evaluate(loaded, {0.5, 0.06, 0.003, 0.5, 0.05, 0.003});
  print(group, "peak torques of the check point", "N m", 5.823368, at.objectives.at(0), 5e-7);
  print(group, "deflection of the check point", "mm", 0.571975,
        1000 * get_metric(loaded, at, "deflection"), 5e-7);
  const Evaluation best = evaluate(loaded, {0.68447, 0.07430, 0.001, 0.3, 0.02628, 0.001});
  print(group, "peak torques of the optimum", "N m", 4.390420, best.objectives.at(0), 2e-4);
}

void check_line() {
  const char* const group = "straight line";
  const RobotModel robot = make_line_arm();
  const std::vector<double> none(3, kNoLimit);
  const auto find_time = [&](double gravity, std::size_t intervals, std::vector<double> efforts) {
    return calc_least_time(robot, gravity, sample_path(find_line_postures(intervals)),
                           {none, none, none, std::move(efforts)})
        .duration_s;
  };
  for (const auto& [intervals, oracle] :
       {std::pair{100, 0.4149}, std::pair{200, 0.4143}, std::pair{400, 0.4140}}) {
    print(group, fmt::format("least time, {} intervals", intervals), "s", oracle,
          find_time(9.80665, static_cast<std::size_t>(intervals), {10, 12, 4}), 5e-5);
  }
  print(group, "least time of the problem chaiyaratana-line", "s", 0.4143,
        evaluate(load_problem("chaiyaratana-line"), {1, 1, 1}).objectives.at(0), 5e-5);
  print(group, "least time without gravity, 200 intervals", "s", 0.36652,
        find_time(0, 200, {10, 12, 4}), 5e-6);
  const double plain = find_time(0, 200, {10, 20, 10});
  print(group, "without gravity, limits (10, 20, 10) N m", "s", 0.364547, plain, 5e-7);
  print(group, "that time over the time of four times the limits", "1", 2,
        plain / find_time(0, 200, {40, 80, 40}), 2e-9);
}

int run() {
  fmt::print("group,quantity,unit,oracle,armwright,allowed,verdict\n");
  check_splines();
  check_puma();
  check_links();
  check_line();
  return failures > 0 ? 1 : 0;
}

}  // namespace
}  // namespace armwright

int main() {
  return armwright::run();
}
