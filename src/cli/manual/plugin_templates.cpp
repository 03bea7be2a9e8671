#include "cli/manual/plugin_templates.hpp"

#include <cctype>
#include <utility>

namespace armwright {

namespace {

// CMakeLists.txt of a library that needs only headers of armwright.
constexpr const char* kCmake = R"raw(cmake_minimum_required(VERSION 3.25)
project(@NAME@ LANGUAGES @COMPILER@)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()
find_package(armwright REQUIRED COMPONENTS plugin)

add_library(@NAME@ MODULE @SOURCE@)
target_compile_features(@NAME@ PRIVATE @STANDARD@)
target_link_libraries(@NAME@ PRIVATE armwright::plugin m)
)raw";

// The same optimizer in each language.

constexpr const char* kCppPlugin =
    R"raw(// @NAME@: an optimizer for armwright. It takes normally distributed steps from the best point so far.
// Steps get longer after a success and shorter after a failure. Replace minimize() by your own
// method.
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
    std::mt19937_64 random(seed);  // only the seed determines random numbers: runs can be resumed
    double step = options.get_number("step");
    std::vector<double> best = problem.start();
    double least = evaluate(best);
    while (true) {  // evaluate() leaves minimize() when the budget is spent
      std::vector<double> x = best;
      for (std::size_t i = 0; i < x.size(); ++i) {
        const plugin::Variable& v = problem.variables[i];
        std::normal_distribution<double> normal;
        if (v.is_logarithmic) {  // a step is a factor, the same in the whole range
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

constexpr const char* kCPlugin =
    R"raw(/* @NAME@: an optimizer for armwright. It takes random steps from the best point so far. Steps get
 * longer after a success and shorter after a failure. Replace minimize() by your own method. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "armwright/plugin.h"

/* Returns a number between -1 and 1. Only the seed determines it: runs can be resumed. */
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
  /* evaluate() returns 0 when the budget is spent. */
  while (evaluator->evaluate(evaluator->context, x, 1, objectives, NULL, NULL) == 1) {
    const double value = armwright_scalar(problem, objectives);
    const int is_better = value < least;
    size_t i;
    if (is_better) {
      memcpy(best, x, n * sizeof(double));
      least = value;
    }
    step = fmin(step * (is_better ? 1.5 : 0.92), 1);
    for (i = 0; i < n; ++i) {
      const double lower = problem->lower[i];
      const double upper = problem->upper[i];
      if (problem->is_logarithmic[i]) { /* a step is a factor, the same in the whole range */
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
    .abi = ARMWRIGHT_PLUGIN_ABI,
    .struct_size = sizeof(struct armwright_plugin),
    .name = "@NAME@",
    .summary = "Random steps from the best point so far",
    .source = "Schumer and Steiglitz 1968, Adaptive step size random search",
    .capabilities = ARMWRIGHT_BOUNDS | ARMWRIGHT_STOCHASTIC,
    .options = options,
    .option_count = sizeof(options) / sizeof(options[0]),
    .minimize = minimize};

ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) { return &plugin; }
)raw";

constexpr const char* kPythonPlugin =
    R"raw("""@NAME@: an optimizer for armwright. It takes random steps from the best point so far. Steps get longer
after a success and shorter after a failure. Replace minimize() by your own method.

Standard output is used by the protocol. Print notes to standard error: print(..., file=sys.stderr)
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
    """The budget is spent, or the user has stopped the run."""


def send(message):
    print(json.dumps(message), flush=True)


def receive():
    line = sys.stdin.readline()
    if not line:
        sys.exit(0)  # armwright has ended
    return json.loads(line)


def evaluate(points):
    """Returns the scores of the points. Evaluate many points per call if you can: they are simulated in parallel."""
    send({"type": "ask", "points": points})
    answer = receive()
    if answer["stopped"]:
        raise Stopped
    return answer["scores"]


def minimize(variables, options, seed):
    generator = random.Random(seed)  # only the seed determines random numbers: runs can be resumed
    step = options["step"]
    best = [v["start"] for v in variables]
    least = evaluate([best])[0]["objectives"][0]
    while True:
        x = []
        for v, value in zip(variables, best):
            lower, upper = v["lower"], v["upper"]
            if v["scale"] == "logarithmic":  # a step is a factor, the same in the whole range
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

constexpr const char* kReadme = R"raw(# @NAME@

An optimizer for armwright, created by `armwright new-plugin --language @LANGUAGE@ @NAME@`.

- `@SOURCE@` is the optimizer; replace its minimize().
- `./test.sh` @STEPS@ checks it and runs it on the sphere.

Then:

    armwright optimize q1-complex --optimizer '@PLUGIN@'
)raw";

constexpr const char* kTestBegin = R"raw(#!/bin/sh
# Tests the plugin. ARMWRIGHT names another program than the armwright on the PATH. CMAKE_PREFIX_PATH names
# another folder where armwright is installed.
set -eu
cd "$(dirname "$0")"
armwright=${ARMWRIGHT:-armwright}
)raw";

constexpr const char* kTestBuild = R"raw(cmake -S . -B build
cmake --build build
)raw";

constexpr const char* kTestEnd = R"raw(plugin='@PLUGIN@'
"$armwright" check-plugin "$plugin"
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
"$armwright" optimize sphere --optimizer "$plugin" --budget 1000 --out "$results/run" --quiet > /dev/null
)raw";

const TemplateLanguage kPluginLanguages[] = {
    {"c++", ".cpp", kCppPlugin, "CXX", "cxx_std_20", "./build/lib@NAME@.so", nullptr},
    {"c", ".c", kCPlugin, "C", "c_std_99", "./build/lib@NAME@.so", nullptr},
    {"python", ".py", kPythonPlugin, nullptr, nullptr, "exec:python3 @NAME@.py", nullptr},
};

std::string to_pascal_case(std::string_view name) {
  std::string pascal;
  bool is_first = true;
  for (const char c : name) {
    if (c == '_') {
      is_first = true;
      continue;
    }
    pascal += is_first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    is_first = false;
  }
  return pascal;
}

std::string replace_all(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
  return text;
}

}  // namespace

const TemplateKind kPluginTemplates = {.languages = kPluginLanguages,
                                       .readme = kReadme,
                                       .test_begin = kTestBegin,
                                       .test_end = kTestEnd};

std::vector<std::string> list_languages(const TemplateKind& kind) {
  std::vector<std::string> names;
  for (const TemplateLanguage& language : kind.languages) {
    names.emplace_back(language.name);
  }
  return names;
}

std::vector<PluginFile> make_files(const TemplateKind& kind, std::string_view language_name,
                                   std::string_view name) {
  std::vector<PluginFile> files;
  for (const TemplateLanguage& language : kind.languages) {
    if (language.name != language_name) {
      continue;
    }
    const std::string source = std::string(name) + language.suffix;
    const auto fill = [&](std::string text) {
      text = replace_all(text, "@PLUGIN@", language.plugin);
      text = replace_all(text, "@SOURCE@", source);
      text = replace_all(text, "@LANGUAGE@", language.name);
      text = replace_all(text, "@STEPS@ ", language.compiler == nullptr ? "" : "builds it, ");
      text = replace_all(text, "@CLASS@", to_pascal_case(name));
      return replace_all(text, "@NAME@", name);
    };
    files.push_back({source, fill(language.source)});
    if (language.compiler != nullptr) {
      std::string cmake = replace_all(kCmake, "@COMPILER@", language.compiler);
      cmake = replace_all(std::move(cmake), "@STANDARD@", language.standard);
      files.push_back({"CMakeLists.txt", fill(std::move(cmake))});
    }
    if (language.problem_file != nullptr) {
      files.push_back({std::string(name) + ".toml", fill(language.problem_file)});
    }
    files.push_back({"README.md", fill(kind.readme)});
    files.push_back({"test.sh",
                     fill(std::string(kind.test_begin) +
                          (language.compiler == nullptr ? "" : kTestBuild) + kind.test_end),
                     true});
  }
  return files;
}

}  // namespace armwright
