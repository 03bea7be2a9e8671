// The interface of optimizers. An OptimizerRow describes an optimizer: its name, its capabilities,
// its options, and a function that makes it. The shipped rows stand in optimizers/table;
// load_optimizer() makes rows of plugins as well. An optimizer minimises through the Evaluator that
// it gets and returns nothing. With the same seed it is deterministic, for any number of threads.
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
  bool bounds = true;  // proposes points inside the box (the evaluator also moves points into it)
  bool constraints = false;      // uses the constraint values
  bool multi_objective = false;  // uses every objective
  bool batch = false;            // evaluates several points per call
  bool noisy = false;            // works with objectives that change with the training cases
  bool residuals = false;        // uses the residual vector
  bool stochastic = false;       // uses its seed
  bool generations = false;      // declares generations, which a `fresh` schedule needs
  bool local = false;            // descends from the start and ends; `multistart:` can restart it
  bool sampling = false;         // does not learn from evaluations; it need not beat random search
  bool paced =
      false;  // plans with the whole budget: another budget changes the run from its beginning
  bool integer = false;      // proposes whole numbers for integers
  bool categorical = false;  // treats categories as words without an order
  bool growing = false;      // copes with training cases that become more; generations do anyway
};

// The least that a problem must have for an optimizer.
struct Requirements {
  int objectives = 1;
  int variables = 1;
  bool residuals = false;
};

// The most that a problem and a run may have for an optimizer; 0: any number.
struct Limits {
  int variables = 0;
  int evaluations = 0;
  std::string alternative = {};  // an optimizer without these limits
};

using OptionValue = std::variant<bool, std::int64_t, double, std::string>;

// One option of an optimizer. The type of `fallback`, its default, is the type of the option.
struct OptionSpec {
  std::string name;
  std::string description;
  OptionValue fallback;
  double lower = 0;  // of a number: the closed range that is allowed
  double upper = 0;
  std::vector<std::string> choices = {};  // of a text: the allowed values; empty: any text
  bool changes_result = true;             // false: a run may be resumed with another value
  // Newer than version 1.0: records leave out its default, as those of version 1.0 do.
  bool is_new = false;
};

// Limits of the descriptions that plugins give of themselves, for shared libraries and programs
// alike.
inline constexpr double kLargestInteger =
    9007199254740992;  // 2^53: doubles up to it tell integers apart
inline constexpr std::size_t kMaxOptions = 1000;
inline constexpr std::size_t kMaxChoices = 1000;  // per option

// A complete set of checked options: every declared option has a value of its type and within its
// range.
class Options {
 public:
  // Reads KEY=VALUE texts. Throws Error{usage} with the optimizer, the option, the value and what
  // is allowed.
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
// Returns whether the records of runs and studies name that value of the option: they leave out what
// changes no result, and the default of a new option.
bool is_recorded(std::span<const OptionSpec> specs, const std::string& option,
                 const OptionValue& value);

// A fault of the optimizer: it crashed, hung or broke its contract. The run keeps all evaluations
// and is marked as failed. Every other exception out of minimize() comes from the evaluator.
class OptimizerFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
  OptimizerFailure(const std::string& what, std::vector<std::string> printed)
      : std::runtime_error(what), printed_(std::move(printed)) {}

  // The last lines that its process printed, safe to show on a terminal.
  const std::vector<std::string>& printed() const { return printed_; }

 private:
  std::vector<std::string> printed_;
};

class Optimizer {
 public:
  virtual ~Optimizer() = default;
  // Minimises. Returns when evaluator.stopped() is true, or when there is nothing more to try.
  // Throws OptimizerFailure and every exception of the evaluator.
  virtual void minimize(Evaluator& evaluator, std::uint64_t seed) = 0;
  // Checks whether the options of this optimizer fit the problem. explain_unsuitable() has checked
  // before what does not depend on options. Throws Error{usage} that says what to do.
  virtual void check_problem(const ProblemDescription& /*problem*/) const {}
  // Returns the files that its options name and that decide what it does: file -> SHA-256, as
  // OptimizerRow::input_hashes. Throws Error{usage} and Error{io}.
  virtual std::map<std::string, std::string> list_inputs() const { return {}; }
  // For optimizers in a process of their own: writes what the process prints to `file` from now on.
  // Removes an earlier content. Throws Error{io}.
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
  Limits limits = {};
  std::string backend = {};  // the library that it needs: "NLopt (CMake option ...)"; empty: none
  // The integer option with which a paced optimizer is told for how many evaluations it plans; 0
  // stands for the budget. A run that is continued with a larger budget keeps the number with which
  // it began. A paced optimizer that leaves this empty cannot be continued.
  std::string pace_option = {};
  // When it runs in a child process (isolation.hpp): "always", "with local=cobyla". Empty: never.
  std::string isolated = {};
  // The problems, or the arms of problems, on which defaults of its options were chosen, by
  // measurements of this project. On them it has an advantage in comparisons.
  std::vector<std::string> tuned_on = {};
  // How these defaults were chosen, a clause for the optimizer's page. Empty without tuned_on.
  std::string tuning = {};
  std::string unfit = {};        // why no build offers it; empty: builds offer it
  std::string unavailable = {};  // why it cannot be used here; empty: it can
  // Of a plugin: file -> SHA-256, so that a resumed run recognises the plugin.
  std::map<std::string, std::string> input_hashes = {};
  // Describes a plugin or an optimizer of a host program, so that its recorded runs can be read
  // without it (plugins/recorded_optimizer.hpp). Empty for other optimizers.
  std::string description = {};
  // Of a plugin whose `name` is a path: the name that it gives itself, for tables.
  std::string short_name = {};
};

}  // namespace armwright
