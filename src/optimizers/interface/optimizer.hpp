// Optimizers as rows: name, what it can do, its options, and how to make one. The shipped ones
// stand in one explicit table; load_optimizer() makes a row of a user's plugin as well. An
// optimizer minimises through the Evaluator it is handed and returns nothing; it is deterministic
// given its seed, whatever the number of threads.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "optimizers/interface/evaluator.hpp"

namespace armwright {

struct Capabilities {
  bool bounds =
      true;  // proposes points inside the box by itself (the evaluator clips all the same)
  bool constraints = false;      // uses the constraint values
  bool multi_objective = false;  // uses more than the first objective
  bool batch = false;            // asks for several points at a time
  bool noisy = false;            // copes with objectives that change with the training cases
  bool residuals = false;        // uses the residual vector
  bool stochastic = false;       // uses its seed
  bool generations = false;      // declares generations, so that a `fresh` schedule can serve it
  bool local = false;  // descends from the start and ends by itself: `multistart:` can restart it
  bool sampling = false;  // learns nothing from what it has seen; no contest with random search
  bool paced = false;     // divides the budget up beforehand: a larger one changes the run from its
                          // beginning, not from its end
};

// What a problem must offer for an optimizer to make sense on it.
struct Requirements {
  int objectives = 1;
  int variables = 1;
  bool residuals = false;
};

using OptionValue = std::variant<bool, std::int64_t, double, std::string>;

// One option: the default's type is the option's type.
struct OptionSpec {
  std::string name;
  std::string description;
  OptionValue fallback;
  double lower = 0;  // numbers: the closed range allowed
  double upper = 0;
  std::vector<std::string> choices = {};  // text: what is allowed; empty: anything
  bool changes_result = true;             // false: a run may be resumed with another value
};

// Options that have been checked: every declared name has a value of the right type within its
// range.
class Options {
 public:
  // `assignments` are KEY=VALUE texts. Error{usage} names the optimizer, the option, what was found
  // and what is allowed.
  static Options parse(std::string_view optimizer, std::span<const OptionSpec> specs,
                       std::span<const std::string> assignments);

  bool get_bool(const std::string& name) const;
  std::int64_t get_integer(const std::string& name) const;
  double get_number(const std::string& name) const;
  const std::string& get_text(const std::string& name) const;
  const std::map<std::string, OptionValue>& values() const { return values_; }

 private:
  std::map<std::string, OptionValue> values_;
};
std::string to_text(const OptionValue& value);

// The optimizer itself is at fault: it crashed, hung, broke its own word. The run keeps what was
// evaluated and is marked as failed; every other exception out of minimize() is the evaluator's.
class OptimizerFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  OptimizerFailure(const std::string& what, std::vector<std::string> printed)
      : std::runtime_error(what), printed_(std::move(printed)) {}

  // The last lines that its process printed, fit for a terminal.
  const std::vector<std::string>& printed() const { return printed_; }

 private:
  std::vector<std::string> printed_;
};

class Optimizer {
 public:
  virtual ~Optimizer() = default;
  // Returns when evaluator.stopped() or when it has nothing more to try. Throws OptimizerFailure,
  // and whatever the evaluator throws.
  virtual void minimize(Evaluator& evaluator, std::uint64_t seed) = 0;
  // Whether it can work on the problem with the options it was made with; explain_unsuitable() has
  // asked already what does not depend on them. Error{usage} says what to do.
  virtual void check_problem(const ProblemDescription& /*problem*/) const {}
  // For those that run in processes of their own: where what these print goes from now on. What is
  // there already is removed. Error{io}.
  virtual void log_to(const std::filesystem::path& /*file*/) {}
};

struct OptimizerRow {
  std::string name;
  std::string summary;  // one line
  std::string source;   // author, year, title
  Capabilities capabilities;
  std::vector<OptionSpec> options;
  std::function<std::unique_ptr<Optimizer>(const Options& options)> make;
  Requirements requirements = {};
  std::string backend = {};  // what the build must have: "NLopt (CMake option ...)"; empty: nothing
  // When it runs in a child process (isolation.hpp): "always", "with local=cobyla"; empty: never.
  std::string isolated = {};
  std::string unfit = {};        // why it is offered in no build; empty: it is
  std::string unavailable = {};  // why it cannot be used here, whatever the reason; empty if it can
  std::map<std::string, std::string> input_hashes =
      {};  // of a plugin: file -> SHA-256, so that a resumed run knows it again
  // Of an optimizer that lives in a program that uses this library: what it says of itself, so that
  // what is recorded of it can be read without that program (foreign_optimizer.hpp).
  std::string description = {};
};

}  // namespace armwright
