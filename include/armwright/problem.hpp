// problem.h for C++17 authors: a class with describe() and evaluate(), containers instead of
// pointers, exceptions instead of statuses. Header only, and it needs nothing but the standard
// library.
//
//     class Bowl : public armwright::problem::Problem {
//      public:
//       armwright::problem::Description describe() const override {
//         armwright::problem::Description all;
//         all.name = "bowl";
//         all.variables = {armwright::problem::real("a", "m", -5, 5),
//                          armwright::problem::category("kind", {"round", "steep"})};
//         all.objectives = {{"depth", "m"}};
//         return all;
//       }
//       armwright::problem::Answer evaluate(const armwright::problem::Point& x,
//                                           const armwright::problem::Case&) override {
//         return x[0] * x[0] + (x.word(1) == "steep" ? 3 : 0);
//       }
//     };
//     ARMWRIGHT_PROBLEM(Bowl)
//
// The macro makes one object per process. A program of your own passes an object to
// armwright::optimize() (run.hpp) instead. An exception that evaluate() throws makes the case a
// failed one, with the exception's text as its reason; a Broken ends the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "armwright/problem.h"

namespace armwright::problem {

// Throw it where no case can be computed, for example because a file is missing. The run ends with
// its text.
class Broken : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Variable {
  std::string name;
  std::string unit;
  std::int32_t type = ARMWRIGHT_VARIABLE_REAL;
  double lower = 0;
  double upper = 0;
  double start = std::numeric_limits<double>::quiet_NaN();  // NaN: the middle of the bounds
  bool is_logarithmic = false;
  std::vector<std::string> choices = {};  // the words of a category
};

// Return variables that start in the middle of their bounds, or with the first word; set `start` for
// another one.
inline Variable real(std::string name, std::string unit, double lower, double upper) {
  return {std::move(name), std::move(unit), ARMWRIGHT_VARIABLE_REAL, lower, upper};
}
inline Variable logarithmic(std::string name, std::string unit, double lower, double upper) {
  Variable variable = real(std::move(name), std::move(unit), lower, upper);
  variable.is_logarithmic = true;
  return variable;
}
inline Variable integer(std::string name, std::string unit, double lower, double upper) {
  return {std::move(name), std::move(unit), ARMWRIGHT_VARIABLE_INTEGER, lower, upper};
}
inline Variable category(std::string name, std::vector<std::string> choices) {
  return {std::move(name), "", ARMWRIGHT_VARIABLE_CATEGORY, 0, 0, 0, false, std::move(choices)};
}

struct Objective {
  std::string name;
  std::string unit = {};
  bool is_maximised = false;
  double weight = 1;                   // of the weighted sum where one number is needed
  std::optional<double> penalty = {};  // what a failed training case counts as
  std::optional<double> bound = {};    // no case has a better value
};

struct Constraint {
  std::string name;
  std::string unit = {};
  double limit = 0;  // > 0: met if the number is <= limit; 0: met if it is <= 0
};

struct Metric {
  std::string name;
  std::string unit = {};
};

struct Description {
  std::string name;
  std::string summary = {};
  std::vector<Variable> variables = {};
  std::vector<Objective> objectives = {};
  std::vector<Constraint> constraints = {};
  std::vector<Metric> metrics = {};
  bool has_residuals = false;     // the objective is the sum of their squares
  bool takes_worst_case = false;  // how objectives of several cases combine: worst value, not mean
  bool is_noisy = false;          // the same question may have different answers
  bool has_records = false;       // record() returns something
  bool has_batches = false;       // evaluate_batch() is better than evaluate() one by one
  std::int64_t training_cases = 1;  // or ARMWRIGHT_ANY_CASES
  std::int64_t validation_cases = 1;
  std::int64_t test_cases = 1;
};

// A decision vector. It refers to numbers of armwright, so copy the numbers to keep them.
class Point {
 public:
  Point(const double* values, const std::vector<Variable>& variables)
      : values_(values), variables_(&variables) {}

  double operator[](std::size_t i) const { return values_[i]; }
  std::size_t size() const { return variables_->size(); }
  const double* begin() const { return values_; }
  const double* end() const { return values_ + size(); }
  // Returns the value of a variable by its name. Throws Broken if there is none.
  double get(const std::string& name) const { return values_[find(name)]; }
  // Returns the word of a category, by its place in the vector or by its name.
  const std::string& word(std::size_t i) const {
    return (*variables_)[i].choices.at(static_cast<std::size_t>(values_[i]));
  }
  const std::string& word(const std::string& name) const { return word(find(name)); }

 private:
  std::size_t find(const std::string& name) const {
    for (std::size_t i = 0; i < variables_->size(); ++i) {
      if ((*variables_)[i].name == name) {
        return i;
      }
    }
    throw Broken("asked for the variable '" + name + "', which it has not described");
  }

  const double* values_;
  const std::vector<Variable>* variables_;
};

enum class Role { training, validation, test };

struct Case {
  std::uint64_t number = 0;  // within its set, from 0
  std::uint64_t seed = 0;    // for random numbers of the case: the same for every decision vector
  Role role = Role::training;
  const char* set = "";  // the set's name: "train/1"
  bool wants_residuals = false;
};

struct Question {
  Point x;
  Case one;
};

// One number per objective, constraint and metric of the description, in its order.
struct Answer {
  Answer() = default;
  Answer(double objective) : objectives{objective} {}  // implicit: `return 3.5;`
  // Returns the answer of a case that failed for a reason.
  static Answer failed(std::string reason, std::int32_t status = ARMWRIGHT_CASE_FAILED) {
    Answer answer;
    answer.status = status;
    answer.reason = std::move(reason);
    return answer;
  }

  std::vector<double> objectives = {};
  std::vector<double> constraints = {};
  std::vector<double> metrics = {};
  std::vector<double> residuals = {};
  std::int32_t status = ARMWRIGHT_CASE_OK;
  std::string reason = {};
};

// What a case leaves beside its numbers.
struct Record {
  struct Series {
    std::string name;
    std::string unit;
    std::vector<double> values;
  };
  struct File {
    std::string name;  // "step.png"
    std::string bytes;
  };
  Series abscissa = {};             // "time" in s
  std::vector<Series> series = {};  // as many values each as the abscissa
  std::vector<File> files = {};
};

class Problem {
 public:
  virtual ~Problem() = default;
  // Called once, before all others.
  virtual Description describe() const = 0;
  // The answer depends on the question alone, unless Description::is_noisy. In a library one thread
  // calls. In a program of your own, `jobs` threads call at the same time.
  virtual Answer evaluate(const Point& x, const Case& one) = 0;
  // Called instead of evaluate() if Description::has_batches, with at most 1000 questions of one
  // set. Returns one answer per question, in their order.
  virtual std::vector<Answer> evaluate_batch(const std::vector<Question>& questions) {
    std::vector<Answer> answers;
    for (const Question& question : questions) {
      answers.push_back(evaluate(question.x, question.one));
    }
    return answers;
  }
  // Computes a case again and records it. Called only if Description::has_records.
  virtual Record record(const Point& /*x*/, const Case& /*one*/) { return {}; }
};

// A problem in the border's form, with everything that it points to. `problem` must live longer.
class Exported {
 public:
  explicit Exported(Problem& problem) : problem_(problem), description_(problem.describe()) {
    for (const Variable& variable : description_.variables) {
      auto& words = words_.emplace_back();
      for (const std::string& word : variable.choices) {
        words.push_back(word.c_str());
      }
      words.push_back(nullptr);
    }
    for (std::size_t i = 0; i < description_.variables.size(); ++i) {
      const Variable& one = description_.variables[i];
      variables_.push_back({one.name.c_str(), one.unit.c_str(), one.type, one.lower, one.upper,
                            one.start, one.is_logarithmic ? 1 : 0, words_[i].data()});
    }
    for (const Objective& one : description_.objectives) {
      objectives_.push_back({one.name.c_str(), one.unit.c_str(), one.is_maximised ? 1 : 0,
                             one.weight, one.penalty ? &*one.penalty : nullptr,
                             one.bound ? &*one.bound : nullptr});
    }
    for (const Constraint& one : description_.constraints) {
      constraints_.push_back({one.name.c_str(), one.unit.c_str(), one.limit});
    }
    for (const Metric& one : description_.metrics) {
      metrics_.push_back({one.name.c_str(), one.unit.c_str()});
    }
    raw_.abi = ARMWRIGHT_PROBLEM_ABI;
    raw_.struct_size = sizeof raw_;
    raw_.name = description_.name.c_str();
    raw_.summary = description_.summary.c_str();
    raw_.variables = variables_.data();
    raw_.variable_count = variables_.size();
    raw_.objectives = objectives_.data();
    raw_.objective_count = objectives_.size();
    raw_.constraints = constraints_.data();
    raw_.constraint_count = constraints_.size();
    raw_.metrics = metrics_.data();
    raw_.metric_count = metrics_.size();
    raw_.has_residuals = description_.has_residuals ? 1 : 0;
    raw_.takes_worst_case = description_.takes_worst_case ? 1 : 0;
    raw_.is_noisy = description_.is_noisy ? 1 : 0;
    raw_.training_cases = description_.training_cases;
    raw_.validation_cases = description_.validation_cases;
    raw_.test_cases = description_.test_cases;
    raw_.context = this;
    raw_.evaluate = [](void* self, const armwright_case* question, armwright_answer* answer) {
      static_cast<Exported*>(self)->answer_one(*question, *answer);
    };
    if (description_.has_batches) {
      raw_.evaluate_batch = [](void* self, const armwright_case* const* questions,
                               armwright_answer* const* answers, std::size_t count) {
        static_cast<Exported*>(self)->answer_batch(questions, answers, count);
      };
    }
    if (description_.has_records) {
      raw_.record = [](void* self, const armwright_case* question, armwright_record* record,
                       char* message, std::size_t message_size) {
        return static_cast<Exported*>(self)->make_record(*question, *record, message, message_size);
      };
    }
  }
  Exported(const Exported&) = delete;
  Exported& operator=(const Exported&) = delete;

  const struct armwright_user_problem* raw() const { return &raw_; }

 private:
  Question read(const armwright_case& raw) const {
    return {Point(raw.x, description_.variables),
            {raw.number, raw.seed, static_cast<Role>(raw.role), raw.set, raw.wants_residuals != 0}};
  }

  // No exception crosses the border. `body` computes; `fail` gets a status and a reason.
  template <typename Body, typename Fail>
  static void run_guarded(Body&& body, Fail&& fail) {
    try {
      body();
    } catch (const Broken& error) {
      fail(ARMWRIGHT_CASE_BROKEN, error.what());
    } catch (const std::bad_alloc&) {
      fail(ARMWRIGHT_CASE_FAILED, "it ran out of memory");
    } catch (const std::exception& error) {
      fail(ARMWRIGHT_CASE_FAILED, error.what());
    } catch (...) {
      fail(ARMWRIGHT_CASE_FAILED, "something that is no std::exception was thrown");
    }
  }

  static void fail(armwright_answer& answer, std::int32_t status, const char* reason) {
    answer.status = status;
    std::snprintf(answer.reason, answer.reason_size, "%s", reason);
  }

  static void copy(const std::vector<double>& from, std::size_t count, const char* what,
                   double* to) {
    if (from.size() != count) {
      throw Broken("it answered with " + std::to_string(from.size()) + " " + what +
                   "; its description has " + std::to_string(count));
    }
    for (std::size_t i = 0; i < count; ++i) {
      to[i] = from[i];
    }
  }

  void write(const Answer& from, armwright_answer& to) const {
    if (from.status != ARMWRIGHT_CASE_OK) {
      fail(to, from.status, from.reason.c_str());
      return;
    }
    copy(from.objectives, objectives_.size(), "objectives", to.objectives);
    copy(from.constraints, constraints_.size(), "constraints", to.constraints);
    copy(from.metrics, metrics_.size(), "metrics", to.metrics);
    if (!from.residuals.empty()) {
      to.set_residuals(&to, from.residuals.data(), from.residuals.size());
    }
  }

  void answer_one(const armwright_case& raw, armwright_answer& answer) {
    run_guarded(
        [&] {
          const Question question = read(raw);
          write(problem_.evaluate(question.x, question.one), answer);
        },
        [&](std::int32_t status, const char* reason) { fail(answer, status, reason); });
  }

  // If a batch throws, its questions are asked one by one, so that only those that throw fail.
  void answer_batch(const armwright_case* const* raw, armwright_answer* const* answers,
                    std::size_t count) {
    bool must_ask_each = false;
    run_guarded(
        [&] {
          std::vector<Question> questions;
          questions.reserve(count);
          for (std::size_t i = 0; i < count; ++i) {
            questions.push_back(read(*raw[i]));
          }
          const std::vector<Answer> found = problem_.evaluate_batch(questions);
          if (found.size() != count) {
            throw Broken("it gave " + std::to_string(found.size()) + " answers to " +
                         std::to_string(count) + " questions");
          }
          for (std::size_t i = 0; i < count; ++i) {
            write(found[i], *answers[i]);
          }
        },
        [&](std::int32_t status, const char* reason) {
          must_ask_each = status != ARMWRIGHT_CASE_BROKEN && count > 1;
          if (!must_ask_each) {
            fail(*answers[0], status, reason);
          }
        });
    for (std::size_t i = 0; must_ask_each && i < count; ++i) {
      answers[i]->status = ARMWRIGHT_CASE_OK;
      answer_batch(raw + i, answers + i, 1);
    }
  }

  int make_record(const armwright_case& raw, armwright_record& to, char* message,
                  std::size_t message_size) {
    int status = 0;
    run_guarded(
        [&] {
          const Question question = read(raw);
          const Record record = problem_.record(question.x, question.one);
          const Record::Series& abscissa = record.abscissa;
          if (!abscissa.values.empty()) {
            to.set_abscissa(&to, abscissa.name.c_str(), abscissa.unit.c_str(),
                            abscissa.values.data(), abscissa.values.size());
          }
          for (const Record::Series& one : record.series) {
            to.add_series(&to, one.name.c_str(), one.unit.c_str(), one.values.data(),
                          one.values.size());
          }
          for (const Record::File& one : record.files) {
            to.add_file(&to, one.name.c_str(), one.bytes.data(), one.bytes.size());
          }
        },
        [&](std::int32_t failure, const char* reason) {
          status = failure;
          std::snprintf(message, message_size, "%s", reason);
        });
    return status;
  }

  Problem& problem_;
  Description description_;
  std::vector<std::vector<const char*>> words_;
  std::vector<armwright_variable> variables_;
  std::vector<armwright_objective> objectives_;
  std::vector<armwright_constraint> constraints_;
  std::vector<armwright_metric> metrics_;
  struct armwright_user_problem raw_ {};
};

}  // namespace armwright::problem

// Exports a class derived from armwright::problem::Problem that has a default constructor. Once per
// library.
#define ARMWRIGHT_PROBLEM(Mine)                                                                    \
  extern "C" ARMWRIGHT_PROBLEM_EXPORT const struct armwright_user_problem* armwright_user_problem( \
      void) {                                                                                      \
    static Mine problem;                                                                           \
    static const ::armwright::problem::Exported exported(problem);                                 \
    return exported.raw();                                                                         \
  }
