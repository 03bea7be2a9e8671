#include "optimizers/plugins/plugin_messages.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.hpp"
#include "optimizers/plugins/plugin_process.hpp"

namespace armwright {
namespace {

using nlohmann::json;

// Writes the type first, for readers.
using OrderedJson = nlohmann::ordered_json;

// Names of problems come from files; every name can be sent.
std::string to_line(const OrderedJson& message) {
  return message.dump(-1, ' ', false, OrderedJson::error_handler_t::replace);
}

std::vector<double> read_point(const json& list, const std::string& what,
                               const ProblemDescription& problem) {
  if (!list.is_array()) {
    throw ProtocolError(fmt::format("sent {} that is no list: {}", what, quote(list)));
  }
  if (list.size() != problem.variables.size()) {
    throw ProtocolError(fmt::format("sent {} of {} coordinates; the problem has {} variables", what,
                                    list.size(), problem.variables.size()));
  }
  std::vector<double> point;
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (!list[i].is_number() || !std::isfinite(list[i].get<double>())) {
      throw ProtocolError(fmt::format("sent {} whose coordinate {} ({}) is {}, not a finite number",
                                      what, i + 1, sanitize(problem.variables[i].name),
                                      quote(list[i])));
    }
    point.push_back(list[i].get<double>());
  }
  return point;
}

void check_inside(const std::vector<double>& point, const std::string& what,
                  const ProblemDescription& problem) {
  for (std::size_t i = 0; i < point.size(); ++i) {
    const DecisionVariable& variable = problem.variables[i];
    if (point[i] < variable.lower || point[i] > variable.upper) {
      throw ProtocolError(fmt::format(
          "declares the capability \"bounds\" and sent {} whose coordinate {} ({}) is {}, outside "
          "{} to {}",
          what, i + 1, sanitize(variable.name), format_exact(point[i]),
          format_exact(variable.lower), format_exact(variable.upper)));
    }
  }
}

OrderedJson describe_quantities(std::span<const Quantity> quantities) {
  OrderedJson list = OrderedJson::array();
  for (const Quantity& quantity : quantities) {
    list.push_back({{"name", quantity.name}, {"unit", quantity.unit}});
  }
  return list;
}

// The protocol's spelling has no blanks, unlike the one for readers.
const char* get_status_name(EvaluationStatus status) {
  return status == EvaluationStatus::timed_out ? "timed_out" : to_string(status);
}

}  // namespace

std::string make_hello() {
  return to_line({{"type", "hello"}, {"protocol", kPluginProtocol}});
}

std::string make_quit() {
  return to_line({{"type", "quit"}});
}

std::string make_minimize(const ProblemDescription& problem, std::uint64_t seed,
                          const Options& options, std::span<const std::string> own_options,
                          std::int64_t remaining) {
  OrderedJson variables = OrderedJson::array();
  for (const DecisionVariable& variable : problem.variables) {
    variables.push_back(
        {{"name", variable.name},
         {"unit", variable.unit},
         {"lower", variable.lower},
         {"upper", variable.upper},
         {"start", variable.start},
         {"scale", variable.scale == Scale::logarithmic ? "logarithmic" : "linear"}});
    if (variable.type != VariableType::real) {
      variables.back()["type"] = to_string(variable.type);
    }
    if (variable.type == VariableType::category) {
      variables.back()["choices"] = variable.choices;
    }
  }
  OrderedJson values = OrderedJson::object();
  for (const auto& [name, value] : options.values()) {
    if (std::ranges::count(own_options, name) == 0) {
      values[name] = std::visit([](const auto& v) { return OrderedJson(v); }, value);
    }
  }
  return to_line({{"type", "minimize"},
                  {"seed", seed},
                  {"options", values},
                  {"problem",
                   {{"name", problem.name},
                    {"variables", variables},
                    {"objectives", describe_quantities(problem.objectives)},
                    {"objective_weights", problem.objective_weights},
                    {"constraints", describe_quantities(problem.constraints)},
                    {"has_residuals", problem.has_residuals}}},
                  {"remaining", remaining}});
}

std::string make_tell(std::span<const Score> scores, std::int64_t remaining, bool stopped,
                      bool with_residuals) {
  OrderedJson list = OrderedJson::array();
  for (const Score& score : scores) {
    OrderedJson one = {{"objectives", score.objectives},
                       {"constraints", score.constraint_values},
                       {"status", get_status_name(score.status)},
                       {"clipped", score.clipped}};
    if (with_residuals) {
      one["residuals"] = score.residuals;
    }
    list.push_back(std::move(one));
  }
  return to_line(
      {{"type", "tell"}, {"scores", list}, {"remaining", remaining}, {"stopped", stopped}});
}

AskMessage read_ask(const json& message, const ProblemDescription& problem, bool inside) {
  AskMessage ask;
  if (const auto generation = message.find("generation"); generation != message.end()) {
    ask.begins_generation = *generation == true;
  }
  const json& points = require(message, "points", "a question");
  if (!points.is_array() || points.empty()) {
    throw ProtocolError(
        fmt::format("asked for no points: \"points\" is {}, not a list of points", quote(points)));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::string what =
        points.size() == 1 ? "a point" : fmt::format("point {} of {}", i + 1, points.size());
    ask.points.push_back(read_point(points[i], what, problem));
    if (inside) {
      check_inside(ask.points.back(), what, problem);
    }
  }
  return ask;
}

std::vector<double> read_recommendation(const json& message, const ProblemDescription& problem) {
  return read_point(require(message, "x", "a recommendation"), "a recommended point", problem);
}

}  // namespace armwright
