// plugin.h for C++20 authors: a class with a minimize(), containers instead of pointers, exceptions
// instead of error codes. Header only, and it needs nothing but the standard library.
//
//     class Halving {
//      public:
//       static armwright::plugin::Description describe() {
//         return {.name = "halving",
//                 .summary = "Steps along one variable at a time, halved when nothing improves",
//                 .source = "a textbook",
//                 .capabilities = ARMWRIGHT_BOUNDS | ARMWRIGHT_LOCAL,
//                 .options = {armwright::plugin::number("step", "first step, share of the box",
//                                                       0.1, 1e-6, 1)}};
//       }
//       void minimize(armwright::plugin::Evaluator& evaluator,
//                     const armwright::plugin::Options& options, std::uint64_t seed);
//     };
//     ARMWRIGHT_PLUGIN(Halving)
//
// An object is made for every call of minimize(). What it throws becomes the run's message.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armwright/plugin.h"

namespace armwright::plugin {

struct Variable {
  std::string name;
  std::string unit;
  double lower = 0;
  double upper = 0;
  double start = 0;
  bool is_logarithmic = false;
  int type = ARMWRIGHT_REAL_VARIABLE;
  std::vector<std::string> choices = {};  // the words of a category
};

struct Problem {
  explicit Problem(const armwright_problem& raw)
      : name(raw.name),
        objectives(raw.objective_names, raw.objective_names + raw.objective_count),
        constraints(raw.constraint_names, raw.constraint_names + raw.constraint_count) {
    for (std::size_t i = 0; i < raw.dimension; ++i) {
      variables.push_back({raw.variable_names[i], raw.variable_units[i], raw.lower[i], raw.upper[i],
                           raw.start[i], raw.is_logarithmic[i] != 0});
    }
    if (raw.struct_size <= offsetof(armwright_problem, variable_choices)) {
      return;  // an armwright of version 1.0
    }
    for (std::size_t i = 0; i < raw.dimension; ++i) {
      variables[i].type = raw.variable_types[i];
      if (variables[i].type == ARMWRIGHT_CATEGORY_VARIABLE) {
        const char* const* const words = raw.variable_choices[i];
        variables[i].choices.assign(words, words + static_cast<std::size_t>(raw.upper[i]) + 1);
      }
    }
    objective_units.assign(raw.objective_units, raw.objective_units + raw.objective_count);
    constraint_units.assign(raw.constraint_units, raw.constraint_units + raw.constraint_count);
    if (raw.objective_weights != nullptr) {
      objective_weights.assign(raw.objective_weights, raw.objective_weights + raw.objective_count);
    }
    has_residuals = raw.has_residuals != 0;
  }

  std::vector<double> start() const {
    std::vector<double> x;
    for (const Variable& variable : variables) {
      x.push_back(variable.start);
    }
    return x;
  }
  // The number by which the run is judged: the weighted sum of the objectives or, without weights,
  // the first objective.
  double calc_scalar(std::span<const double> values) const {
    double sum = 0;
    for (std::size_t i = 0; i < objective_weights.size(); ++i) {
      sum += objective_weights[i] * values[i];
    }
    return objective_weights.empty() ? values.front() : sum;
  }
  // The nearest point inside the box, with whole numbers for integers and categories.
  std::vector<double> clip(std::span<const double> x) const {
    std::vector<double> inside(x.begin(), x.end());
    for (std::size_t i = 0; i < inside.size(); ++i) {
      const bool is_real = variables[i].type == ARMWRIGHT_REAL_VARIABLE;
      inside[i] = std::clamp(is_real ? inside[i] : std::floor(inside[i] + 0.5), variables[i].lower,
                             variables[i].upper);
    }
    return inside;
  }

  std::string name;
  std::vector<Variable> variables;
  std::vector<std::string> objectives;
  std::vector<std::string> constraints;
  std::vector<std::string> objective_units;
  std::vector<std::string> constraint_units;
  std::vector<double> objective_weights;  // empty: only the first objective counts
  bool has_residuals = false;
};

struct Score {
  std::vector<double> objectives;         // finite always
  std::vector<double> constraint_values;  // g <= 0 is met; empty for a failed evaluation
  int status = ARMWRIGHT_OK;
  // Empty for an evaluation that failed or was abandoned, and without ARMWRIGHT_RESIDUALS.
  std::vector<double> residuals = {};
  bool clipped = false;  // the point was outside the bounds and was evaluated at the nearest inside
};

// Thrown by Evaluator::operator() when there is nothing more to come, and caught by the macro:
// minimize() need not look for the end. One that wants to recommend a point at the end catches it:
// points that are recommended then still count. Do not derive it from std::exception: catching those
// must not stop the way out.
struct Stopped {};

class Evaluator {
 public:
  Evaluator(const armwright_problem& problem, const armwright_evaluator& raw)
      : problem_(problem), raw_(raw) {}

  const Problem& problem() const { return problem_; }

  // The number by which one point is judged (Problem::calc_scalar()); throws Stopped at the end.
  double operator()(std::span<const double> x) {
    return problem_.calc_scalar(evaluate(x).objectives);
  }

  // One point; throws Stopped at the end.
  Score evaluate(std::span<const double> x) {
    std::vector<Score> scores = evaluate_flat(x, 1);
    if (scores.empty()) {
      throw Stopped{};
    }
    return std::move(scores.front());
  }

  // Several points, which run in parallel. Fewer scores than points come back at the end.
  std::vector<Score> evaluate(std::span<const std::vector<double>> points) {
    std::vector<double> flat;
    for (const std::vector<double>& point : points) {
      check(point);
      flat.insert(flat.end(), point.begin(), point.end());
    }
    return evaluate_flat(flat, points.size());
  }
  std::vector<Score> evaluate(const std::vector<std::vector<double>>& points) {
    return evaluate(std::span<const std::vector<double>>(points));
  }

  bool stopped() const { return raw_.stopped(raw_.context) != 0; }
  std::int64_t remaining() const { return raw_.remaining(raw_.context); }
  void begin_generation() { raw_.begin_generation(raw_.context); }
  void recommend(std::span<const double> x) {
    check(x);
    raw_.recommend(raw_.context, x.data());
  }
  // Says why minimize() ends before the evaluator has stopped, in a few words.
  void explain_end(std::string reason) { end_ = std::move(reason); }
  const std::string& end() const { return end_; }

 private:
  // The border knows no lengths of points.
  void check(std::span<const double> x) const {
    if (x.size() != problem_.variables.size()) {
      throw std::invalid_argument("a point of " + std::to_string(x.size()) + " coordinates for " +
                                  std::to_string(problem_.variables.size()) +
                                  " decision variables");
    }
  }

  std::vector<Score> evaluate_flat(std::span<const double> flat, std::size_t count) {
    if (count == 1) {
      check(flat);
    }
    const std::size_t objective_count = problem_.objectives.size();
    const std::size_t constraint_count = problem_.constraints.size();
    std::vector<double> objectives(count * objective_count);
    std::vector<double> constraints(count * constraint_count);
    std::vector<std::int32_t> statuses(count);
    const std::size_t done = raw_.evaluate(raw_.context, flat.data(), count, objectives.data(),
                                           constraints.data(), statuses.data());
    std::vector<Score> scores(done);
    for (std::size_t i = 0; i < done; ++i) {
      const auto f = objectives.begin() + static_cast<std::ptrdiff_t>(i * objective_count);
      const auto g = constraints.begin() + static_cast<std::ptrdiff_t>(i * constraint_count);
      scores[i].objectives.assign(f, f + static_cast<std::ptrdiff_t>(objective_count));
      scores[i].status = statuses[i];
      if (statuses[i] == ARMWRIGHT_OK) {
        scores[i].constraint_values.assign(g, g + static_cast<std::ptrdiff_t>(constraint_count));
      }
      add_residuals(i, scores[i]);
    }
    return scores;
  }

  void add_residuals(std::size_t point, Score& score) const {
    if (raw_.struct_size <= offsetof(armwright_evaluator, is_clipped)) {
      return;  // an armwright of version 1.0
    }
    std::size_t count = 0;
    const double* const residuals = raw_.residuals(raw_.context, point, &count);
    score.residuals.assign(residuals, residuals + count);
    score.clipped = raw_.is_clipped(raw_.context, point) != 0;
  }

  Problem problem_;
  const armwright_evaluator& raw_;
  std::string end_;
};

class Options {
 public:
  explicit Options(const armwright_options& raw) : raw_(raw) {}
  bool get_bool(const char* name) const { return raw_.get_bool(raw_.context, name) != 0; }
  std::int64_t get_integer(const char* name) const { return raw_.get_integer(raw_.context, name); }
  double get_number(const char* name) const { return raw_.get_number(raw_.context, name); }
  std::string get_text(const char* name) const { return raw_.get_text(raw_.context, name); }

 private:
  const armwright_options& raw_;
};

struct Option {
  std::string name;
  std::string description;
  std::int32_t type = ARMWRIGHT_NUMBER;
  double fallback = 0;
  double lower = 0;
  double upper = 0;
  std::string fallback_text = {};
  std::vector<std::string> choices = {};
};

inline Option flag(std::string name, std::string description, bool fallback) {
  return {std::move(name), std::move(description), ARMWRIGHT_BOOL, fallback ? 1.0 : 0.0};
}
inline Option integer(std::string name, std::string description, std::int64_t fallback,
                      std::int64_t lower, std::int64_t upper) {
  return {std::move(name),
          std::move(description),
          ARMWRIGHT_INTEGER,
          static_cast<double>(fallback),
          static_cast<double>(lower),
          static_cast<double>(upper)};
}
inline Option number(std::string name, std::string description, double fallback, double lower,
                     double upper) {
  return {std::move(name), std::move(description), ARMWRIGHT_NUMBER, fallback, lower, upper};
}
inline Option text(std::string name, std::string description, std::string fallback,
                   std::vector<std::string> choices = {}) {
  return {std::move(name),     std::move(description), ARMWRIGHT_TEXT, 0, 0, 0,
          std::move(fallback), std::move(choices)};
}

struct Description {
  std::string name;
  std::string summary;
  std::string source;
  std::uint32_t capabilities = 0;  // ARMWRIGHT_BOUNDS | ...
  std::vector<Option> options = {};
  // The least that a problem must have.
  std::size_t least_objectives = 1;
  std::size_t least_variables = 1;
  bool needs_residuals = false;
};

// A description in the border's form, with everything that it points to. Made once.
class Exported {
 public:
  using Minimize = decltype(armwright_plugin::minimize);

  Exported(Description description, Minimize minimize) : description_(std::move(description)) {
    choices_.reserve(description_.options.size());
    for (const Option& option : description_.options) {
      auto& choices = choices_.emplace_back();
      for (const std::string& choice : option.choices) {
        choices.push_back(choice.c_str());
      }
      choices.push_back(nullptr);
      const bool is_text = option.type == ARMWRIGHT_TEXT;
      options_.push_back({option.name.c_str(), option.description.c_str(), option.type,
                          option.fallback, option.lower, option.upper,
                          is_text ? option.fallback_text.c_str() : nullptr,
                          option.choices.empty() ? nullptr : choices.data()});
    }
    raw_ = {ARMWRIGHT_PLUGIN_ABI,
            sizeof(struct armwright_plugin),
            description_.name.c_str(),
            description_.summary.c_str(),
            description_.source.c_str(),
            description_.capabilities,
            options_.data(),
            options_.size(),
            minimize,
            description_.least_objectives,
            description_.least_variables,
            description_.needs_residuals ? std::size_t{1} : std::size_t{0}};
  }
  Exported(const Exported&) = delete;
  Exported& operator=(const Exported&) = delete;

  const struct armwright_plugin* raw() const { return &raw_; }

 private:
  Description description_;
  std::vector<std::vector<const char*>> choices_;
  std::vector<armwright_option> options_;
  struct armwright_plugin raw_ {};
};

// No exception crosses the border.
template <typename Body>
int run_guarded(Body&& body, char* message, std::size_t message_size) {
  try {
    body();
    return 0;
  } catch (const Stopped&) {
    return 0;
  } catch (const std::exception& error) {
    std::snprintf(message, message_size, "%s", error.what());
  } catch (...) {
    std::snprintf(message, message_size, "something that is no std::exception was thrown");
  }
  return 1;
}

template <typename Method>
int minimize_with(const armwright_problem* problem, const armwright_evaluator* evaluator,
                  const armwright_options* options, std::uint64_t seed, char* message,
                  std::size_t message_size) {
  return run_guarded(
      [&] {
        Evaluator wrapped(*problem, *evaluator);
        Method().minimize(wrapped, Options(*options), seed);
        std::snprintf(message, message_size, "%s", wrapped.end().c_str());
      },
      message, message_size);
}

}  // namespace armwright::plugin

// Exports a class with `static Description describe()` and
// `void minimize(Evaluator&, const Options&, std::uint64_t seed)`. Once a library.
#define ARMWRIGHT_PLUGIN(Method)                                                             \
  extern "C" ARMWRIGHT_PLUGIN_EXPORT const struct armwright_plugin* armwright_plugin(void) { \
    static const ::armwright::plugin::Exported exported(                                     \
        Method::describe(), &::armwright::plugin::minimize_with<Method>);                    \
    return exported.raw();                                                                   \
  }
