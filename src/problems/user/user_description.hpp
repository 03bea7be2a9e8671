// The description of a problem that a user has written: its variables, objectives, constraints,
// metrics and cases. Programs give it as JSON (docs/problem-protocol.md), problem files as tables.
// Both give the same struct, and check_description() checks both.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// The version of the protocol between armwright and the programs of problems.
inline constexpr int kProblemProtocol = 1;

// The types of variables, in the order in which problem.h numbers them.
inline constexpr std::array kVariableTypes = {VariableType::real, VariableType::integer,
                                              VariableType::category};
std::vector<std::string> list_type_names();

// One of the numbers that are minimised or maximised.
struct UserObjective {
  Quantity quantity;
  bool is_maximised = false;
  double weight = 1;  // > 0; of the weighted sum where one number is needed
  // What a failed training case counts as, in the objective's own direction. Nothing: a candidate
  // with a failed case has no objectives.
  std::optional<double> penalty;
  // No case has a better value, in the objective's own direction. Races can give candidates up.
  std::optional<double> bound;
};

// A number that is limited: met if it is <= the limit, or <= 0 without a limit.
struct UserConstraint {
  Quantity quantity;
  std::optional<double> limit;  // > 0
};

struct UserDescription {
  std::string name;
  std::string summary;
  // Changes if the problem computes something else; empty: the program does not say.
  std::string version;
  std::vector<DecisionVariable> variables;
  std::vector<UserObjective> objectives;
  std::vector<UserConstraint> constraints;
  std::vector<Quantity> metrics;
  bool has_residuals = false;  // the objective is the sum of their squares
  // How many cases there are. 0: as many as asked for, because a case is made from its number.
  std::int64_t training_cases = 1;
  std::int64_t validation_cases = 1;  // >= 1
  std::int64_t test_cases = 1;        // >= 1
  // How the objectives of several cases are combined: their worst value, or their mean.
  bool takes_worst_case = false;
  bool is_deterministic = true;  // the same question has the same answer
  bool has_records = false;      // Problem::record_case() has signals or files
};

// Says what is wrong with a description. `field` is the field as JSON and problem files name it,
// "variables[2].lower"; `fault` completes a sentence that begins with it: "is 3; it must be ...".
using RefuseField = std::function<void(const std::string& field, const std::string& fault)>;

// Checks what concerns several fields. Calls `refuse`, which must throw, for the first fault.
void check_description(const UserDescription& description, const RefuseField& refuse);

// Reads the message "problem" of a program. Starts that are left out lie in the middle of the
// bounds. Throws ProtocolError.
UserDescription read_user_description(const nlohmann::json& message);
// Returns the description as one line of JSON, with every field in a fixed order. Equal
// descriptions have equal texts, and read_user_description() reads them.
std::string to_json(const UserDescription& description);

// Reads a text that to_json() made. Throws Error{bad_data}, with the problem's name, for others.
UserDescription read_recorded_description(const std::string& recorded, std::string_view name);

// Throws Error{bad_data}, with the differences, if a problem describes itself differently now.
void check_same_description(std::string_view name, const UserDescription& recorded,
                            const UserDescription& now);

// Returns whether all evaluations of a decision vector are the same: the problem has one case and
// answers it the same way each time.
bool has_single_case(const UserDescription& description);

// Returns the value of a category's word. Returns nothing if the word is none of its choices.
std::optional<double> find_word(const DecisionVariable& variable, std::string_view word);

// Returns the middle of a variable's bounds, or the middle of their logarithms; of a type with whole
// numbers, the nearest whole number.
double choose_start(const DecisionVariable& variable);

// Returns the description that optimizers and reports see. An objective that is maximised is
// minimised with the opposite sign and called "-NAME"; a metric has it as it is. A constraint with
// a limit is met where value / limit - 1 <= 0.
ProblemDescription make_description(const UserDescription& description);

}  // namespace armwright
