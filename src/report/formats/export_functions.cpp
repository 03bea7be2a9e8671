#include "report/formats/export_functions.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "problems/config/problem_loader.hpp"
#include "report/formats/export_files.hpp"

namespace armwright {
namespace {

// The problem `robot` is missing: without a robot of the user's it is no function.
constexpr std::array<std::pair<std::string_view, std::size_t>, 47> kFunctions = {{
    {"sphere", 25},          {"ellipsoid", 26},     {"rosenbrock", 27},   {"rastrigin", 28},
    {"constrained", 29},     {"bbob-f1", 30},       {"bbob-f2", 31},      {"bbob-f3", 32},
    {"bbob-f8", 33},         {"bbob-f10", 34},      {"bbob-f15", 35},     {"q1-complex", 40},
    {"q1-ramp", 41},         {"q1-step", 42},       {"q1-trapezoid", 43}, {"q1-triangular", 44},
    {"q1-requirements", 45}, {"q2-e1", 46},         {"q2-e2", 47},        {"q2-e3", 48},
    {"q2-e4", 49},           {"q2-e5", 50},         {"q2-e6", 51},        {"q2-energy", 52},
    {"q2-error", 53},        {"q2-torque", 54},     {"q2-pareto", 55},    {"q3-load", 56},
    {"q4-speed", 57},        {"faithful-q1", 58},   {"faithful-e6", 59},  {"faithful-q3", 60},
    {"robust-q1", 61},       {"robust-e6", 62},     {"robust-q3", 63},    {"initial", 64},
    {"initial-0cm", 65},     {"initial-45cm", 66},  {"initial-90cm", 67}, {"co-design", 68},
    {"sphere-int", 36},      {"ellipsoid-int", 37}, {"ackley", 38},       {"branin", 39},
    {"hartmann6", 69},       {"zdt1", 70},          {"dtlz2", 71},
}};

bool is_shipped(const RecordedFunction& function) {
  return find_function_id(function.problem).has_value() &&
         make_function_settings(load_problem(function.problem).resolved_json) == function.settings;
}

bool are_same_function(const ProblemRuns& a, const ProblemRuns& b) {
  return a.function.problem == b.function.problem && a.function.settings == b.function.settings &&
         a.names.objectives == b.names.objectives && a.names.metrics == b.names.metrics;
}

std::size_t get_dimension(const ProblemRuns* problem) {
  return problem->names.variables.size();
}

// Adds the problem to the function that it is an instance of, or as a new function.
void add_problem(std::vector<ExportFunction>& functions, const ProblemRuns& problem) {
  const auto found = std::ranges::find_if(functions, [&](const ExportFunction& function) {
    return are_same_function(*function.problems.front(), problem) &&
           std::ranges::find(function.problems, get_dimension(&problem), get_dimension) ==
               function.problems.end();
  });
  if (found != functions.end()) {
    found->problems.push_back(&problem);
  } else {
    functions.push_back({0, "", {&problem}});
  }
}

}  // namespace

std::optional<std::size_t> find_function_id(std::string_view problem) {
  const auto* const found =
      std::ranges::find(kFunctions, problem, [](const auto& row) { return row.first; });
  return found == kFunctions.end() ? std::nullopt : std::optional(found->second);
}

std::vector<ExportFunction> number_functions(const CollectedRuns& runs) {
  std::vector<const ProblemRuns*> problems;
  for (const ProblemRuns& problem : runs.problems) {
    problems.push_back(&problem);
  }
  std::ranges::stable_sort(problems, {}, &ProblemRuns::place);
  std::vector<ExportFunction> functions;
  for (const ProblemRuns* problem : problems) {
    add_problem(functions, *problem);
  }
  std::size_t next = kFirstOwnFunction;
  UniqueNames names;
  for (ExportFunction& function : functions) {
    const ProblemRuns& first = *function.problems.front();
    // 0 stands for no number.
    const std::size_t id =
        is_shipped(first.function) ? find_function_id(first.function.problem).value_or(0) : 0;
    const bool taken = std::ranges::count(functions, id, &ExportFunction::id) > 0;
    function.id = id > 0 && !taken ? id : next++;
    const bool is_own_name = function.id < kFirstOwnFunction || function.problems.size() > 1;
    function.name = names.add(is_own_name ? first.function.problem : first.name);
    std::ranges::sort(function.problems, {}, get_dimension);
  }
  std::ranges::sort(functions, {}, &ExportFunction::id);
  return functions;
}

}  // namespace armwright
