#include "study/compare/rerun.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "study/compare/study_plan.hpp"

namespace armwright {
namespace {

// Returns a label as the plan writes it and as folder names do.
std::vector<std::string> list_forms(const std::string& label) {
  std::vector<std::string> forms = {label};
  if (escape_name(label) != label) {
    forms.push_back(escape_name(label));
  }
  return forms;
}

std::vector<std::string> list_problem_labels(const StudyPlan& plan) {
  std::vector<std::string> labels;
  for (const StudyProblem& problem : plan.problems) {
    labels.push_back(problem.label);
  }
  return labels;
}

std::vector<std::string> list_optimizer_labels(const StudyPlan& plan) {
  std::vector<std::string> labels;
  for (const StudyOptimizer& optimizer : plan.optimizers) {
    labels.push_back(optimizer.label);
  }
  return labels;
}

// Returns all ways to read "PROBLEM/OPTIMIZER"; labels may contain slashes. A name written with
// folder names has no other slash, so it is read in only one way.
std::vector<Cell> find_readings(const StudyPlan& plan, std::string_view head) {
  std::vector<Cell> readings;
  for (std::size_t p = 0; p < plan.problems.size(); ++p) {
    for (std::size_t o = 0; o < plan.optimizers.size(); ++o) {
      if (head ==
          escape_name(plan.problems[p].label) + "/" + escape_name(plan.optimizers[o].label)) {
        return {{p, o, 1}};
      }
      bool is_it = false;
      for (const std::string& problem : list_forms(plan.problems[p].label)) {
        for (const std::string& optimizer : list_forms(plan.optimizers[o].label)) {
          is_it = is_it || head == problem + "/" + optimizer;
        }
      }
      if (is_it) {
        readings.push_back({p, o, 1});
      }
    }
  }
  return readings;
}

// Throws with the part of the name that is unknown.
[[noreturn]] void refuse_head(const StudyPlan& plan, std::string_view head) {
  for (const StudyProblem& problem : plan.problems) {
    for (const std::string& form : list_forms(problem.label)) {
      if (head.starts_with(form + "/")) {
        throw Error(ErrorKind::usage, describe_unknown("optimizer", head.substr(form.size() + 1),
                                                       list_optimizer_labels(plan)));
      }
    }
  }
  throw Error(ErrorKind::usage, describe_unknown("problem", head.substr(0, head.find('/')),
                                                 list_problem_labels(plan)));
}

}  // namespace

Cell find_cell(const StudyPlan& plan, std::string_view name) {
  const std::size_t slash = name.rfind('/');
  const std::string_view last = slash == std::string_view::npos ? name : name.substr(slash + 1);
  std::optional<long long> replicate;
  if (last.size() > 1 && last[0] == 'r' &&
      last.find_first_not_of("0123456789", 1) == std::string_view::npos) {
    replicate = parse_integer(last.substr(1));
  }
  if (slash == std::string_view::npos || !replicate) {
    throw Error(
        ErrorKind::usage,
        fmt::format("'{}' is not a cell of a study; a cell is PROBLEM/OPTIMIZER/rNN, as in "
                    "'{}/{}/r01'",
                    sanitize(name), plan.problems.front().label, plan.optimizers.front().label));
  }
  const std::string_view head = name.substr(0, slash);
  const auto readings = find_readings(plan, head);
  if (readings.empty()) {
    refuse_head(plan, head);
  }
  if (readings.size() > 1) {
    throw Error(
        ErrorKind::usage,
        fmt::format("'{}' fits two cells; name the cell as its folder is named: {}", sanitize(name),
                    make_cell_path(plan, readings[0]).lexically_relative("cells").string()));
  }
  if (*replicate < 1 || *replicate > plan.replicates) {
    throw Error(ErrorKind::usage, fmt::format("the study has no replicate {}; it has r01 to r{:02}",
                                              sanitize(last), plan.replicates));
  }
  Cell cell = readings.front();
  cell.replicate = static_cast<int>(*replicate);
  return cell;
}

std::filesystem::path choose_rerun_folder(const std::filesystem::path& study, const StudyPlan& plan,
                                          const Cell& cell) {
  const auto first = study / "reruns" / make_cell_path(plan, cell).lexically_relative("cells");
  std::filesystem::path folder = first;
  for (int number = 2; has_ended(folder); ++number) {
    folder = first;
    folder += fmt::format("-{:03}", number);
  }
  return folder;
}

bool has_ended(const std::filesystem::path& folder) {
  return path_exists(folder / "cell.json");
}

}  // namespace armwright
