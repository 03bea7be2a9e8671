// The problem that `armwright new-problem` writes, the same in each language: a mass that a
// controller moves by 1 m.
#include "cli/manual/plugin_templates.hpp"

namespace armwright {
namespace {

constexpr const char* kPythonProblem =
    R"raw("""@NAME@: a problem for armwright. A controller with the gains kp and kd moves a mass by 1 m.
Replace DESCRIPTION and simulate() by your own problem.

Standard output is used by the protocol. Print notes to standard error: print(..., file=sys.stderr)
"""
import json
import sys

DESCRIPTION = {
    "type": "problem",
    "protocol": 1,
    "name": "@NAME@",
    "summary": "Move a mass by 1 m, quickly and without much overshoot",
    "variables": [
        {"name": "kp", "unit": "N/m", "lower": 1, "upper": 1000, "scale": "logarithmic"},
        {"name": "kd", "unit": "N s/m", "lower": 0.1, "upper": 100, "scale": "logarithmic"},
    ],
    "objectives": [{"name": "itae", "unit": "m s2"}],
    "constraints": [{"name": "overshoot", "unit": "m", "limit": 0.05}],
    "metrics": [{"name": "peak_force", "unit": "N"}],
}


def simulate(kp, kd):
    """Returns the answer for one design. Only its arguments may decide it."""
    mass_kg, dt_s, limit_n = 2.0, 0.001, 50.0
    x_m = v_m_per_s = itae = overshoot_m = peak_n = 0.0
    for step in range(3000):
        error_m = 1.0 - x_m
        force_n = min(max(kp * error_m - kd * v_m_per_s, -limit_n), limit_n)
        v_m_per_s += force_n / mass_kg * dt_s
        x_m += v_m_per_s * dt_s
        itae += step * dt_s * abs(error_m) * dt_s
        overshoot_m = max(overshoot_m, -error_m)
        peak_n = max(peak_n, abs(force_n))
    return {"objectives": [itae], "constraints": [overshoot_m], "metrics": [peak_n]}


def send(message):
    print(json.dumps(message), flush=True)


for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "hello":
        send(DESCRIPTION)
    elif message["type"] == "evaluate":
        answers = [simulate(*point) for point in message["points"]]
        send({"type": "answers", "id": message["id"], "answers": answers})
    elif message["type"] == "quit":
        break
)raw";

constexpr const char* kCppProblem =
    R"raw(// @NAME@: a problem for armwright. A controller with the gains kp and kd moves a mass by 1 m. Replace
// describe() and evaluate() by your own problem.
#include <algorithm>
#include <armwright/problem.hpp>
#include <cmath>

namespace aw = armwright::problem;

class @CLASS@ : public aw::Problem {
 public:
  aw::Description describe() const override {
    aw::Description all;
    all.name = "@NAME@";
    all.summary = "Move a mass by 1 m, quickly and without much overshoot";
    all.variables = {aw::logarithmic("kp", "N/m", 1, 1000),
                     aw::logarithmic("kd", "N s/m", 0.1, 100)};
    all.objectives = {{"itae", "m s2"}};
    all.constraints = {{"overshoot", "m", 0.05}};
    all.metrics = {{"peak_force", "N"}};
    return all;
  }

  // The answer may depend on the gains and the case only.
  aw::Answer evaluate(const aw::Point& gains, const aw::Case& /*one*/) override {
    const double mass_kg = 2, dt_s = 0.001, limit_n = 50;
    double x_m = 0, v_m_per_s = 0, itae = 0, overshoot_m = 0, peak_n = 0;
    for (int step = 0; step < 3000; ++step) {
      const double error_m = 1 - x_m;
      const double force_n =
          std::clamp(gains[0] * error_m - gains[1] * v_m_per_s, -limit_n, limit_n);
      v_m_per_s += force_n / mass_kg * dt_s;
      x_m += v_m_per_s * dt_s;
      itae += step * dt_s * std::abs(error_m) * dt_s;
      overshoot_m = std::max(overshoot_m, -error_m);
      peak_n = std::max(peak_n, std::abs(force_n));
    }
    aw::Answer answer(itae);
    answer.constraints = {overshoot_m};
    answer.metrics = {peak_n};
    return answer;
  }
};

ARMWRIGHT_PROBLEM(@CLASS@)
)raw";

constexpr const char* kCProblem =
    R"raw(/* @NAME@: a problem for armwright. A controller with the gains kp and kd moves a mass by 1 m. Replace
 * the tables and evaluate() by your own problem. */
#include <armwright/problem.h>
#include <math.h>

static const struct armwright_variable variables[] = {
    {"kp", "N/m", ARMWRIGHT_VARIABLE_REAL, 1, 1000, NAN, 1, NULL},
    {"kd", "N s/m", ARMWRIGHT_VARIABLE_REAL, 0.1, 100, NAN, 1, NULL}};
static const struct armwright_objective objectives[] = {{"itae", "m s2", 0, 1, NULL, NULL}};
static const struct armwright_constraint constraints[] = {{"overshoot", "m", 0.05}};
static const struct armwright_metric metrics[] = {{"peak_force", "N"}};

/* The answer may depend on the question only. */
static void evaluate(void* context, const struct armwright_case* question,
                     struct armwright_answer* answer) {
  const double mass_kg = 2, dt_s = 0.001, limit_n = 50;
  double x_m = 0, v_m_per_s = 0, itae = 0, overshoot_m = 0, peak_n = 0;
  int step;
  (void)context;
  for (step = 0; step < 3000; ++step) {
    const double error_m = 1 - x_m;
    const double wanted_n = question->x[0] * error_m - question->x[1] * v_m_per_s;
    const double force_n = fmin(fmax(wanted_n, -limit_n), limit_n);
    v_m_per_s += force_n / mass_kg * dt_s;
    x_m += v_m_per_s * dt_s;
    itae += step * dt_s * fabs(error_m) * dt_s;
    overshoot_m = fmax(overshoot_m, -error_m);
    peak_n = fmax(peak_n, fabs(force_n));
  }
  answer->objectives[0] = itae;
  answer->constraints[0] = overshoot_m;
  answer->metrics[0] = peak_n;
}

static const struct armwright_user_problem problem = {
    .abi = ARMWRIGHT_PROBLEM_ABI,
    .struct_size = sizeof(struct armwright_user_problem),
    .name = "@NAME@",
    .summary = "Move a mass by 1 m, quickly and without much overshoot",
    .variables = variables,
    .variable_count = sizeof(variables) / sizeof(variables[0]),
    .objectives = objectives,
    .objective_count = sizeof(objectives) / sizeof(objectives[0]),
    .constraints = constraints,
    .constraint_count = sizeof(constraints) / sizeof(constraints[0]),
    .metrics = metrics,
    .metric_count = sizeof(metrics) / sizeof(metrics[0]),
    .evaluate = evaluate};

ARMWRIGHT_PROBLEM_EXPORT const struct armwright_user_problem* armwright_user_problem(void) {
  return &problem;
}
)raw";

constexpr const char* kAwkModel =
    R"raw(# @NAME@: a simulator that reads gains from a file and prints results. A controller with the gains kp
# and kd moves a mass by 1 m. Replace it by your own simulator, and its command line in @NAME@.toml.
{ gain[$1] = $2 }
END {
  mass = 2; dt = 0.001; limit = 50
  for (step = 0; step < 3000; ++step) {
    error = 1 - x
    force = gain["kp"] * error - gain["kd"] * v
    force = force > limit ? limit : force < -limit ? -limit : force
    v += force / mass * dt
    x += v * dt
    itae += step * dt * (error < 0 ? -error : error) * dt
    if (-error > overshoot) overshoot = -error
    if (force > peak) peak = force
  }
  printf "itae %.17g\novershoot %.17g\npeak %.17g\n", itae, overshoot, peak
}
)raw";

constexpr const char* kCommandProblem =
    R"raw(# @NAME@: a problem for armwright that a command computes. Each case runs the command in a new folder.
kind = "command"
title = "Move a mass by 1 m, quickly and without much overshoot"

[command]
run = "awk -f {folder}/@NAME@.awk gains.txt"
time_limit_s = 10

[[command.input]]
file = "gains.txt"
text = """
kp {kp}
kd {kd}
"""

[[variable]]
name = "kp"
unit = "N/m"
lower = 1
upper = 1000
scale = "logarithmic"

[[variable]]
name = "kd"
unit = "N s/m"
lower = 0.1
upper = 100
scale = "logarithmic"

[[objective]]
name = "itae"
unit = "m s2"
regex = "itae (.+)"

[[constraint]]
name = "overshoot"
unit = "m"
limit = 0.05
regex = "overshoot (.+)"

[[metric]]
name = "peak_force"
unit = "N"
regex = "peak (.+)"
)raw";

constexpr const char* kProblemReadme = R"raw(# @NAME@

A problem for armwright, created by `armwright new-problem --language @LANGUAGE@ @NAME@`.

- `@SOURCE@` is the problem; replace it by your own.
- `./test.sh` @STEPS@ checks every promise of a problem and optimizes it.

Then:

    armwright optimize '@PLUGIN@' --optimizer cmaes --budget 1000
    armwright compare --problems '@PLUGIN@' --optimizers cmaes,ga,random --budget 500
)raw";

constexpr const char* kProblemTestBegin = R"raw(#!/bin/sh
# Tests the problem. ARMWRIGHT names another program than the armwright on the PATH. CMAKE_PREFIX_PATH names
# another folder where armwright is installed.
set -eu
cd "$(dirname "$0")"
armwright=${ARMWRIGHT:-armwright}
)raw";

constexpr const char* kProblemTestEnd = R"raw(problem='@PLUGIN@'
"$armwright" check-problem "$problem"
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
"$armwright" optimize "$problem" --optimizer cmaes --budget 200 --out "$results/run" --quiet > /dev/null
)raw";

const TemplateLanguage kProblemLanguages[] = {
    {"python", ".py", kPythonProblem, nullptr, nullptr, "exec:python3 @NAME@.py", nullptr},
    {"c++", ".cpp", kCppProblem, "CXX", "cxx_std_20", "./build/lib@NAME@.so", nullptr},
    {"c", ".c", kCProblem, "C", "c_std_99", "./build/lib@NAME@.so", nullptr},
    {"command", ".awk", kAwkModel, nullptr, nullptr, "./@NAME@.toml", kCommandProblem},
};

}  // namespace

const TemplateKind kProblemTemplates = {.languages = kProblemLanguages,
                                        .readme = kProblemReadme,
                                        .test_begin = kProblemTestBegin,
                                        .test_end = kProblemTestEnd};

}  // namespace armwright
