#include "study/contract/problem_specimen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "base/random.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kRandomDesigns = 4;  // beside the start
constexpr std::size_t kMostCorners = 100;  // designs at the bounds

double draw_value(const DecisionVariable& v, RandomStream& random) {
  if (v.scale == Scale::logarithmic) {
    return v.lower * std::pow(v.upper / v.lower, random.uniform());
  }
  const double past = v.type == VariableType::real ? 0 : 0.5;  // each value gets the same share
  return random.uniform(v.lower - past, v.upper + past);
}

}  // namespace

Specimen::Specimen(const ProblemTrial& trial) : loaded_(trial.load()) {
  const auto available = static_cast<std::size_t>(loaded_.sets.training_cases);
  const std::size_t count = available > 0 ? std::min(trial.cases, available) : trial.cases;
  for (std::uint64_t number = 0; number < count; ++number) {
    block_.numbers.push_back(number);
  }
  block_.set = loaded_.sets.training;
}

std::vector<Question> Specimen::make_questions() const {
  std::vector<std::vector<double>> designs = {get_start()};
  RandomStream random("check-problem");
  for (std::size_t i = 0; i < kRandomDesigns; ++i) {
    std::vector<double> x;
    for (const DecisionVariable& v : description().variables) {
      x.push_back(settle_value(v, draw_value(v, random)));
    }
    designs.push_back(std::move(x));
  }
  return cross(designs);
}

std::vector<Question> Specimen::make_corners() const {
  const std::vector<DecisionVariable>& variables = description().variables;
  std::vector<std::vector<double>> designs(3, get_start());
  for (std::size_t i = 0; i < variables.size(); ++i) {
    designs[1][i] = variables[i].lower;
    designs[2][i] = variables[i].upper;
  }
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const bool has_words = variables[i].type == VariableType::category;
    const double step = has_words ? 1 : variables[i].upper - variables[i].lower;
    for (double value = variables[i].lower;
         value <= variables[i].upper && designs.size() < kMostCorners; value += step) {
      designs.push_back(get_start());
      designs.back()[i] = value;
    }
  }
  std::vector<Question> questions;
  for (std::vector<double>& x : designs) {
    questions.push_back({std::move(x), 0});
  }
  return questions;
}

std::vector<double> Specimen::get_start() const {
  return list_starts(description().variables);
}

std::vector<CaseOutcome> Specimen::ask(std::span<const Question> questions, bool residuals) const {
  std::vector<CaseJob> jobs;
  for (const Question& one : questions) {
    jobs.push_back({.x = one.x, .block = &block_, .number = one.number, .residuals = residuals});
  }
  return problem().simulate(jobs);
}

std::vector<CaseOutcome> Specimen::ask_singly(std::span<const Question> questions) const {
  std::vector<CaseOutcome> outcomes;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    outcomes.push_back(ask(questions.subspan(i, 1)).front());
  }
  return outcomes;
}

std::string Specimen::describe(const Question& question) const {
  constexpr std::size_t kMostShown = 6;
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(question.x.size(), kMostShown); ++i) {
    const DecisionVariable& variable = description().variables[i];
    words.push_back(fmt::format("{}={}", variable.name, format_value(variable, question.x[i])));
  }
  return fmt::format("{}{} on case {}", join(words, " "),
                     question.x.size() > kMostShown ? " ..." : "", question.number);
}

std::string Specimen::describe_failure(const Question& question, const CaseOutcome& outcome) const {
  return describe_failure(describe(question), outcome);
}

std::string Specimen::describe_failure(std::string_view what, const CaseOutcome& outcome) const {
  std::string reason = outcome.reason;
  if (ProblemWarnings* const warnings = find_warnings(problem())) {
    for (const std::string& warning : warnings->take()) {
      if (warning.starts_with(outcome.reason)) {
        reason = join(split(warning, '\n'), " |");
      }
    }
  }
  return fmt::format("{}: {}", what, reason);
}

std::string Specimen::compare(std::span<const Question> questions,
                              std::span<const CaseOutcome> first,
                              std::span<const CaseOutcome> second, std::string_view how) const {
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const std::string difference = compare(questions[i], first[i], second[i]);
    if (!difference.empty()) {
      return fmt::format("{}: {}{}", describe(questions[i]), difference, how);
    }
  }
  return "";
}

std::vector<Question> Specimen::cross(const std::vector<std::vector<double>>& designs) const {
  std::vector<Question> questions;
  for (const std::vector<double>& x : designs) {
    for (const std::uint64_t number : block_.numbers) {
      questions.push_back({x, number});
    }
  }
  return questions;
}

std::string Specimen::compare(const Question& question, const CaseOutcome& a,
                              const CaseOutcome& b) const {
  if (a.status != b.status || a.reason != b.reason) {
    const auto say = [](const CaseOutcome& outcome) {
      return fmt::format("'{}'{}", to_string(outcome.status),
                         outcome.reason.empty() ? "" : fmt::format(" ({})", outcome.reason));
    };
    return fmt::format("it was {}, and {}", say(a), say(b));
  }
  const Evaluation first = problem().aggregate(question.x, {&a, 1});
  const Evaluation second = problem().aggregate(question.x, {&b, 1});
  for (const auto& [names, left, right] :
       {std::tuple{&description().objectives, &first.objectives, &second.objectives},
        {&description().constraints, &first.constraint_values, &second.constraint_values},
        {&description().metrics, &first.metrics, &second.metrics}}) {
    for (std::size_t i = 0; i < left->size(); ++i) {
      if ((*left)[i] != (*right)[i]) {
        return fmt::format("'{}' was {}, and {}", (*names)[i].name, format_exact((*left)[i]),
                           format_exact((*right)[i]));
      }
    }
  }
  return "";
}

}  // namespace armwright
