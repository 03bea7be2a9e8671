// Optimizers as rows of one explicit table: name, what it can do, its options, and how to make one.
// An optimizer minimises through the Evaluator it is handed and returns nothing; it is
// deterministic given its seed, whatever the number of threads.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "optimizers/evaluator.hpp"

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

class Optimizer {
 public:
  virtual ~Optimizer() = default;
  // Returns when evaluator.stopped() or when it has nothing more to try.
  virtual void minimize(Evaluator& evaluator, std::uint64_t seed) = 0;
};

struct OptimizerRow {
  std::string name;
  std::string summary;  // one line
  std::string source;   // author, year, title
  Capabilities capabilities;
  std::vector<OptionSpec> options;
  std::unique_ptr<Optimizer> (*make)(const Options& options);
};

const std::vector<OptimizerRow>& optimizer_table();
std::vector<std::string> optimizer_names();
const OptimizerRow& find_optimizer(std::string_view name);  // Error{usage} if there is none

}  // namespace armwright
