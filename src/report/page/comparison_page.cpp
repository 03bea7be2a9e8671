// Makes the page that compares two runs or two studies, A and B.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "base/error.hpp"
#include "base/text.hpp"
#include "report/evidence/page_json.hpp"
#include "report/evidence/recorded_run.hpp"
#include "report/page/comparison_settings.hpp"
#include "report/page/page_data.hpp"
#include "report/page/page_file.hpp"
#include "study/analysis/study_result.hpp"
#include "study/compare/study_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using Folders = std::array<std::filesystem::path, 2>;

// ---------------------------------------------------------------- the page

std::string name_folder(const std::filesystem::path& folder) {
  const auto path = folder.lexically_normal();
  return (path.has_filename() ? path.filename() : path.parent_path().filename()).string();
}

// Returns the notes of both pages, each with the page that it belongs to.
json join_notes(const json& a, const json& b) {
  json notes = json::array();
  const auto has = [](const json& page, const json& note) {
    return std::ranges::find(page.at("notes"), note) != page.at("notes").end();
  };
  for (const json& note : a.at("notes")) {
    notes.push_back((has(b, note) ? "A and B: " : "A: ") + note.get<std::string>());
  }
  for (const json& note : b.at("notes")) {
    if (!has(a, note)) {
      notes.push_back("B: " + note.get<std::string>());
    }
  }
  return notes;
}

// Returns ComparisonData without the parts of runs or studies.
json make_frame(const Folders& folders, const json& a, const json& b, json settings) {
  const auto names = std::array{name_folder(folders[0]), name_folder(folders[1])};
  const std::vector<std::string> again = {"armwright", "report", folders[0].string(),
                                          folders[1].string()};
  return {{"format", kPageFormat},
          {"kind", "comparison"},
          {"title", fmt::format("A: {} – B: {}", sanitize(names[0]), sanitize(names[1]))},
          {"subtitle", fmt::format("A: {} – B: {}", a.at("title").get<std::string>(),
                                   b.at("title").get<std::string>())},
          {"program", make_program()},
          {"folder", folders[0].string() + " and " + folders[1].string()},
          {"command", quote_command(again)},
          {"finished", a.at("finished").get<bool>() && b.at("finished").get<bool>()},
          {"progress", nullptr},
          {"watched", nullptr},
          {"notes", join_notes(a, b)},
          {"facts", json::array()},
          {"robots", json::array()},
          {"replays", json::array()},
          {"settings", std::move(settings)},
          {"runs", nullptr},
          {"studies", nullptr}};
}

// ---------------------------------------------------------------- runs

// Returns whether both replays show the same task, so that motions of one are comparable with
// those of the other.
bool have_same_task(const json& a, const json& b) {
  return a.at("task") == b.at("task");
}

// Returns one replay of both winners in the cases that both pages have; null if there is none.
json merge_replays(json a, json b) {
  const auto find_winner = [](const json& set) -> const json* {
    const json& designs = set.at("designs");
    return designs.empty() || designs.front().at("id") != "winner" ? nullptr : &designs.front();
  };
  if (find_winner(a) == nullptr || find_winner(b) == nullptr || !have_same_task(a, b)) {
    return nullptr;
  }
  json cases = json::array();
  for (json& one : a["cases"]) {
    const auto other = std::ranges::find_if(b["cases"], [&](const json& its) {
      return its.at("id") == one.at("id") && its.at("points_m") == one.at("points_m");
    });
    if (other == b["cases"].end()) {
      continue;
    }
    json motions = json::array();
    const std::array<std::pair<const char*, json*>, 2> sides = {std::pair{"a", &one},
                                                                std::pair{"b", &*other}};
    for (const auto& [id, side] : sides) {
      for (json& motion : (*side)["motions"]) {
        if (motion.at("design") == "winner") {
          motion["design"] = id;
          motions.push_back(std::move(motion));
        }
      }
    }
    one["motions"] = std::move(motions);
    one["label"] = one.at("label").get<std::string>() + " (of A)";  // what is notable for A
    cases.push_back(std::move(one));
  }
  if (cases.empty()) {
    return nullptr;
  }
  json designs = json::array();
  for (const auto& [id, name, set] :
       {std::tuple{"a", "winner of A", &a}, std::tuple{"b", "winner of B", &b}}) {
    json design = *find_winner(*set);
    design["id"] = id;
    design["name"] = name;
    designs.push_back(std::move(design));
  }
  a["title"] = "Motions of both winners";
  a["designs"] = std::move(designs);
  a["cases"] = std::move(cases);
  return a;
}

// Returns PairedErrors: the winners' errors on the same test cases, or null if the runs have no
// common test cases.
json make_paired_errors(const RecordedRun& a, const RecordedRun& b, bool same_cases) {
  const auto get_errors = [](const RecordedRun& run) {
    std::vector<double> errors =
        run.result && run.result->winner ? run.result->test.case_errors : std::vector<double>{};
    // A case without an error is worse than any other.
    std::ranges::replace_if(
        errors, [](double error) { return std::isnan(error); },
        std::numeric_limits<double>::infinity());
    return errors;
  };
  const auto errors_a = get_errors(a);
  const auto errors_b = get_errors(b);
  if (!same_cases || errors_a.empty() || errors_a.size() != errors_b.size()) {
    return nullptr;
  }
  const PairResult pair = compare_pairs(std::vector{errors_a, errors_b}).front();
  const bool a_first = pair.a == 0;
  return {{"cases", errors_a.size()},
          {"wins", a_first ? pair.wins.wins : pair.wins.losses},
          {"ties", pair.wins.ties},
          {"losses", a_first ? pair.wins.losses : pair.wins.wins},
          {"p", pair.test.p_value},
          {"a12", calc_a12(errors_a, errors_b)},
          {"better", pair.is_significant() ? json(a_first ? "a" : "b") : json(nullptr)}};
}

// Returns whether both runs judge their winners on the same cases, which follow from the problem and
// its test set.
bool have_same_cases(const ComparedSettings& a, const ComparedSettings& b) {
  const std::set<std::string> obstacles = list_obstacles(a, b);
  return !obstacles.contains(kBasisProblem) && !obstacles.contains(kBasisTestSet);
}

std::optional<json> make_runs(const Folders& folders, PageOptions options, StopSignal& stop,
                              RunObserver& observer) {
  const RecordedRun a = read_recorded_run(folders[0]);
  const RecordedRun b = read_recorded_run(folders[1]);
  const ComparedSettings settings_a = list_settings(a);
  const ComparedSettings settings_b = list_settings(b);
  const bool same_cases = have_same_cases(settings_a, settings_b);
  const auto text_a = make_run_page(folders[0], options, stop, observer);
  if (!text_a) {
    return std::nullopt;
  }
  json page_a = json::parse(*text_a);
  if (same_cases && !page_a["replays"].empty()) {
    // The page of B replays the test cases that are notable for A, too.
    for (const json& one : page_a["replays"].front()["cases"]) {
      if (one.at("set") == a.problem->sets.test) {
        options.cases.push_back(one.at("id").get<std::string>());
      }
    }
  }
  const auto text_b = make_run_page(folders[1], options, stop, observer);
  if (!text_b) {
    return std::nullopt;
  }
  json page_b = json::parse(*text_b);
  json page = make_frame(folders, page_a, page_b, make_compared_settings(settings_a, settings_b));
  if (!page_a["replays"].empty() && !page_b["replays"].empty()) {
    json replay =
        merge_replays(std::move(page_a["replays"].front()), std::move(page_b["replays"].front()));
    if (!replay.is_null()) {
      page["replays"].push_back(std::move(replay));
      page["robots"] = std::move(page_a["robots"]);
    } else {
      page["notes"].push_back(
          "The runs have different tasks or cases, so no motion of one is beside that of the "
          "other.");
    }
  }
  for (json* one : {&page_a, &page_b}) {
    (*one)["replays"] = json::array();
    (*one)["robots"] = json::array();
  }
  page["runs"] = {{"a", std::move(page_a)},
                  {"b", std::move(page_b)},
                  {"same_cases", same_cases},
                  {"paired", make_paired_errors(a, b, same_cases)}};
  return page;
}

// ---------------------------------------------------------------- studies

template <typename Items, typename Label>
std::optional<std::size_t> find_label(const Items& items, const Label& label) {
  const auto found =
      std::ranges::find_if(items, [&](const auto& one) { return one.label == label; });
  return found == items.end() ? std::nullopt
                              : std::optional(static_cast<std::size_t>(found - items.begin()));
}

// The values of the replicates of one optimizer on one problem.
std::map<int, double> list_values(const StudyResult& result, const std::string& problem,
                                  const std::string& optimizer, const OptimizerResult& one) {
  std::map<int, double> values;
  std::size_t next = 0;
  for (const CellOutcome& cell : result.cells) {
    if (cell.problem == problem && cell.optimizer == optimizer) {
      values[cell.replicate] = one.values.at(next++);
    }
  }
  return values;
}

// Returns the probability that a run of A is better than one of B; null if a side has no runs.
json calc_effect(const std::map<int, double>& a, const std::map<int, double>& b,
                 const Margin& margin) {
  if (a.empty() || b.empty()) {
    return nullptr;
  }
  const auto round = [&](const std::map<int, double>& values) {
    std::vector<double> rounded;
    for (const auto& [replicate, value] : values) {
      rounded.push_back(margin.round(value));
    }
    return rounded;
  };
  return calc_a12(round(a), round(b));
}

json make_side(const std::map<int, double>& values) {
  std::vector<double> all;
  for (const auto& [replicate, value] : values) {
    all.push_back(value);
  }
  const Spread spread = all.empty() ? Spread{} : calc_spread(all);
  const auto or_null = [&](double value) {
    return all.empty() ? json(nullptr) : finite_or_null(value);
  };
  return {{"runs", all.size()},
          {"q1", or_null(spread.lower_quartile)},
          {"median", or_null(spread.median)},
          {"q3", or_null(spread.upper_quartile)}};
}

// Returns why the results of a problem of both studies cannot be compared; empty if they can.
std::string find_obstacle(const StudyPlan& plan_a, const StudyProblem& a, const StudyPlan& plan_b,
                          const StudyProblem& b) {
  std::set<std::string> parts = list_obstacles(list_settings(a), list_settings(b));
  if (plan_a.constraint_tolerance != plan_b.constraint_tolerance) {
    parts.insert("the tolerance of constraints");
  }
  return parts.empty()
             ? ""
             : fmt::format("{} {}",
                           join(std::vector<std::string>(parts.begin(), parts.end()), ", "),
                           parts.size() == 1 ? "differs" : "differ");
}

// Returns why replicates with the same number form no pairs, though the results can be compared;
// empty if they do.
std::string find_unpaired(const StudyPlan& a, const StudyPlan& b) {
  return a.seed != b.seed                   ? "the seed differs"
         : a.start_spread != b.start_spread ? "the spread of the starts differs"
                                            : "";
}

// Returns whether the values of the problem are shares of a hypervolume. These are measured against
// the study's own ideal and reference point, and mean nothing beside those of another study.
bool have_front(const ProblemResult& a, const ProblemResult& b) {
  return a.has_front || b.has_front;
}

// Returns one note per problem that both studies have and that is not compared.
json list_omissions(const StudyResult& a, const StudyResult& b) {
  json notes = json::array();
  for (const ProblemResult& problem : a.problems) {
    const auto other = find_label(b.problems, problem.label);
    if (other && have_front(problem, b.problems[*other])) {
      notes.push_back(fmt::format(
          "The problem {} is not compared: it has several objectives, and each study measures the "
          "hypervolume from its own reference point.",
          sanitize(problem.label)));
    }
  }
  return notes;
}

// Returns a list of ComparedCell: one per problem and optimizer that both studies have. Only results
// of equal problems are compared, and only pairs of replicates with the same start and training set
// are tested.
json make_cells(const StudyPlan& plan_a, const StudyResult& a, const StudyPlan& plan_b,
                const StudyResult& b) {
  json cells = json::array();
  std::vector<double> p_values;
  for (std::size_t p = 0; p < plan_a.problems.size(); ++p) {
    const std::string& problem = plan_a.problems[p].label;
    const auto other_p = find_label(plan_b.problems, problem);
    if (!other_p || plan_a.value != plan_b.value ||
        have_front(a.problems[p], b.problems[*other_p])) {
      continue;
    }
    const ProblemResult& result_a = a.problems[p];
    const ProblemResult& result_b = b.problems[*other_p];
    const bool same_quantity = result_a.quantity.name == result_b.quantity.name &&
                               result_a.quantity.unit == result_b.quantity.unit;
    const std::string obstacle =
        find_obstacle(plan_a, plan_a.problems[p], plan_b, plan_b.problems[*other_p]);
    const std::string unpaired = obstacle.empty() ? find_unpaired(plan_a, plan_b) : obstacle;
    for (std::size_t o = 0; same_quantity && o < plan_a.optimizers.size(); ++o) {
      const std::string& optimizer = plan_a.optimizers[o].label;
      const auto other_o = find_label(plan_b.optimizers, optimizer);
      if (!other_o) {
        continue;
      }
      const auto values_a = list_values(a, problem, optimizer, result_a.optimizers[o]);
      const auto values_b = list_values(b, problem, optimizer, result_b.optimizers[*other_o]);
      std::vector<std::vector<double>> pairs(2);
      for (const auto& [replicate, value] : values_a) {
        const auto found = values_b.find(replicate);
        if (unpaired.empty() && found != values_b.end()) {
          pairs[0].push_back(value);
          pairs[1].push_back(found->second);
        }
      }
      json cell = {
          {"problem", sanitize(problem)},
          {"optimizer", sanitize(optimizer)},
          {"quantity", make_quantity(result_a.quantity, !plan_a.problems[p].loaded.tracking())},
          {"a", make_side(values_a)},
          {"b", make_side(values_b)},
          {"pairs", pairs[0].size()},
          {"wins", 0},
          {"ties", 0},
          {"losses", 0},
          {"a12",
           obstacle.empty() ? calc_effect(values_a, values_b, result_a.margin) : json(nullptr)},
          {"p", nullptr},
          {"p_holm", nullptr},
          {"better", nullptr},
          {"untested", nullptr}};
      if (!unpaired.empty()) {
        cell["untested"] = unpaired;
      } else if (std::ssize(pairs[0]) < kFewestPairs) {
        cell["untested"] =
            fmt::format("not enough pairs to decide; at least {} are needed", kFewestPairs);
      } else {
        const PairResult pair = compare_pairs(pairs, result_a.margin).front();
        const bool a_first = pair.a == 0;
        cell["wins"] = a_first ? pair.wins.wins : pair.wins.losses;
        cell["ties"] = pair.wins.ties;
        cell["losses"] = a_first ? pair.wins.losses : pair.wins.wins;
        cell["p"] = pair.test.p_value;
        cell["better"] = a_first ? "a" : "b";  // if it is significant, which is decided below
        p_values.push_back(pair.test.p_value);
      }
      cells.push_back(std::move(cell));
    }
  }
  const std::vector<double> adjusted = adjust_holm(p_values);
  std::size_t next = 0;
  for (json& cell : cells) {
    if (cell["p"].is_null()) {
      continue;
    }
    const double p = adjusted[next++];
    cell["p_holm"] = p;
    if (p >= kSignificance) {
      cell["better"] = nullptr;
    }
  }
  return cells;
}

std::optional<json> make_studies(const Folders& folders, PageOptions options, StopSignal& stop,
                                 RunObserver& observer) {
  options.simulate = false;  // a study has many designs, and none stands for all
  const StudyPlan plan_a = load_study_plan(folders[0]);
  const StudyPlan plan_b = load_study_plan(folders[1]);
  const auto text_a = make_study_page(folders[0], options, stop, observer);
  const auto text_b = text_a ? make_study_page(folders[1], options, stop, observer) : std::nullopt;
  if (!text_b) {
    return std::nullopt;
  }
  json page_a = json::parse(*text_a);
  json page_b = json::parse(*text_b);
  json page = make_frame(
      folders, page_a, page_b,
      make_compared_settings(list_settings(plan_a, plan_b), list_settings(plan_b, plan_a)));
  const StudyResult result_a = analyze_study(plan_a, folders[0], MissingCells::left_out);
  const StudyResult result_b = analyze_study(plan_b, folders[1], MissingCells::left_out);
  for (json& note : list_omissions(result_a, result_b)) {
    page["notes"].push_back(std::move(note));
  }
  page["studies"] = {{"a", std::move(page_a)},
                     {"b", std::move(page_b)},
                     {"cells", make_cells(plan_a, result_a, plan_b, result_b)}};
  return page;
}

}  // namespace

std::optional<std::string> make_comparison_page(const std::filesystem::path& a,
                                                const std::filesystem::path& b,
                                                const PageOptions& options, StopSignal& stop,
                                                RunObserver& observer) {
  const PageKind kind = find_page_kind(a);
  if (kind != find_page_kind(b) || kind == PageKind::reproduction) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{} is the folder of {}, and {} that of {}; a page can compare two runs "
                    "or two studies",
                    a.string(), to_string(kind), b.string(), to_string(find_page_kind(b))));
  }
  if (kind == PageKind::study && !options.cases.empty()) {
    throw Error(ErrorKind::usage, "--case needs runs; a comparison of studies shows no motion");
  }
  const auto page = kind == PageKind::run ? make_runs({a, b}, options, stop, observer)
                                          : make_studies({a, b}, options, stop, observer);
  return page ? std::optional(dump_page(*page)) : std::nullopt;
}

}  // namespace armwright
