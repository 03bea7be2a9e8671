#include "cli/manual/plugin_template_texts.hpp"

namespace armwright {

const char* const kCppPlugin =
    R"raw(// @NAME@: an optimizer for armwright. Normally distributed steps from the best point so far, longer
// after a success and shorter after a failure. Replace minimize() by your own method.
#include <cmath>
#include <random>

#include "armwright/plugin.hpp"

namespace plugin = armwright::plugin;

class @CLASS@ {
 public:
  static plugin::Description describe() {
    return {.name = "@NAME@",
            .summary = "Random steps from the best point so far",
            .source = "Schumer and Steiglitz 1968, Adaptive step size random search",
            .capabilities = ARMWRIGHT_BOUNDS | ARMWRIGHT_STOCHASTIC,
            .options = {plugin::number("step", "first step, as a share of the box", 0.1, 1e-9, 1)}};
  }

  void minimize(plugin::Evaluator& evaluate, const plugin::Options& options, std::uint64_t seed) {
    const plugin::Problem& problem = evaluate.problem();
    std::mt19937_64 random(seed);  // the seed is the only source of chance: runs can be resumed
    double step = options.get_number("step");
    std::vector<double> best = problem.start();
    double least = evaluate(best);
    while (true) {  // evaluate() leaves minimize() when the budget is spent
      std::vector<double> x = best;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const plugin::Variable& v = problem.variables[i];
        std::normal_distribution<double> normal;
        if (v.is_logarithmic) {  // a factor means the same everywhere in the range
          x[i] *= std::exp(step * std::abs(std::log(v.upper / v.lower)) * normal(random));
        } else {
          x[i] += step * (v.upper - v.lower) * normal(random);
        }
      }
      x = problem.clip(x);
      const double value = evaluate(x);
      const bool is_better = value < least;
      step = std::min(step * (is_better ? 1.5 : 0.92), 1.0);
      if (is_better) {
        best = x;
        least = value;
      }
    }
  }
};

ARMWRIGHT_PLUGIN(@CLASS@)
)raw";

const char* const kCPlugin =
    R"raw(/* @NAME@: an optimizer for armwright. Random steps from the best point so far, longer after a
 * success and shorter after a failure. Replace minimize() by your own method. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "armwright/plugin.h"

/* Uniform between -1 and 1. The seed is the only source of chance: runs can be resumed. */
static double draw(uint64_t* state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-52 - 1;
}

static int minimize(const struct armwright_problem* problem,
                    const struct armwright_evaluator* evaluator,
                    const struct armwright_options* options, uint64_t seed, char* message,
                    size_t message_size) {
  const size_t n = problem->dimension;
  double step = options->get_number(options->context, "step");
  double* best = malloc(n * sizeof(double));
  double* x = malloc(n * sizeof(double));
  double* objectives = malloc(problem->objective_count * sizeof(double));
  double least = INFINITY;
  uint64_t state = seed;
  if (best == NULL || x == NULL || objectives == NULL) {
    snprintf(message, message_size, "no memory for %zu variables", n);
    free(best);
    free(x);
    free(objectives);
    return 1;
  }
  memcpy(x, problem->start, n * sizeof(double));
  /* 0 points come back when the budget is spent. */
  while (evaluator->evaluate(evaluator->context, x, 1, objectives, NULL, NULL) == 1) {
    const int is_better = objectives[0] < least;
    size_t i;
    if (is_better) {
      memcpy(best, x, n * sizeof(double));
      least = objectives[0];
    }
    step = fmin(step * (is_better ? 1.5 : 0.92), 1);
    for (i = 0; i < n; ++i) {
      const double lower = problem->lower[i];
      const double upper = problem->upper[i];
      if (problem->is_logarithmic[i]) { /* a factor means the same everywhere in the range */
        x[i] = best[i] * exp(step * fabs(log(upper / lower)) * draw(&state));
      } else {
        x[i] = best[i] + step * (upper - lower) * draw(&state);
      }
      x[i] = fmin(fmax(x[i], lower), upper);
    }
  }
  free(best);
  free(x);
  free(objectives);
  return 0;
}

static const struct armwright_option options[] = {
    {"step", "first step, as a share of the box", ARMWRIGHT_NUMBER, 0.1, 1e-9, 1, NULL, NULL}};

static const struct armwright_plugin plugin = {
    ARMWRIGHT_PLUGIN_ABI,
    sizeof(struct armwright_plugin),
    "@NAME@",
    "Random steps from the best point so far",
    "Schumer and Steiglitz 1968, Adaptive step size random search",
    ARMWRIGHT_BOUNDS | ARMWRIGHT_STOCHASTIC,
    options,
    sizeof(options) / sizeof(options[0]),
    minimize};

ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) { return &plugin; }
)raw";

const char* const kPythonPlugin =
    R"raw("""@NAME@: an optimizer for armwright. Random steps from the best point so far, longer after a success
and shorter after a failure. Replace minimize() by your own method.

Standard output belongs to the protocol; notes go to standard error: print(..., file=sys.stderr)
"""
import json
import math
import random
import sys

DESCRIPTION = {
    "type": "description",
    "protocol": 1,
    "name": "@NAME@",
    "summary": "Random steps from the best point so far",
    "source": "Schumer and Steiglitz 1968, Adaptive step size random search",
    "capabilities": ["bounds", "stochastic"],
    "options": [{"name": "step", "description": "first step, as a share of the box",
                 "default": 0.1, "lower": 1e-9, "upper": 1}],
}


class Stopped(Exception):
    """The budget is spent, or the user has had enough."""


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    line = sys.stdin.readline()
    if not line:
        sys.exit(0)  # armwright is gone
    return json.loads(line)


def evaluate(points):
    """The points' scores. Ask for many at a time where you can: they are evaluated in parallel."""
    send({"type": "ask", "points": points})
    answer = receive()
    if answer["stopped"]:
        raise Stopped
    return answer["scores"]


def minimize(variables, options, seed):
    generator = random.Random(seed)  # the only source of chance: runs can be resumed
    step = options["step"]
    best = [v["start"] for v in variables]
    least = evaluate([best])[0]["objectives"][0]
    while True:
        x = []
        for v, value in zip(variables, best):
            lower, upper = v["lower"], v["upper"]
            if v["scale"] == "logarithmic":  # a factor means the same everywhere in the range
                value *= math.exp(step * abs(math.log(upper / lower)) * generator.uniform(-1, 1))
            else:
                value += step * (upper - lower) * generator.uniform(-1, 1)
            x.append(min(max(value, lower), upper))
        value = evaluate([x])[0]["objectives"][0]
        step = min(step * (1.5 if value < least else 0.92), 1)
        if value < least:
            best, least = x, value


receive()  # hello
send(DESCRIPTION)
request = receive()
if request["type"] == "minimize":
    try:
        minimize(request["problem"]["variables"], request["options"], request["seed"])
    except Stopped:
        pass
    send({"type": "done"})
)raw";

}  // namespace armwright
