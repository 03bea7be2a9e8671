// What a plugin that is a program of its own says, line by line: its description, then what it asks
// and recommends. A description makes a row whose options have defaults that they allow.
#include <cmath>

#include "base/text.hpp"
#include "fuzz/harness.hpp"
#include "optimizers/plugins/plugin_messages.hpp"
#include "process/line_process.hpp"

namespace armwright::fuzz {
namespace {

const ProblemDescription& get_problem() {
  static const ProblemDescription problem = [] {
    ProblemDescription made;
    made.name = "bowl";
    made.variables = {{"x", "m", -1, 1, 0.5, Scale::linear},
                      {"p", "", 1, 100, 10, Scale::logarithmic}};
    made.objectives = {{"error", "m"}};
    return made;
  }();
  return problem;
}

void check_row(const OptimizerRow& row) {
  require(!row.name.empty() && sanitize(row.name) == row.name, "a name that is none");
  require(sanitize(row.summary) == row.summary && sanitize(row.source) == row.source,
          "a row is not printable");
  std::vector<std::string> assignments;
  for (const OptionSpec& spec : row.options) {
    require(std::isfinite(spec.lower) && std::isfinite(spec.upper), "a range without end");
    assignments.push_back(spec.name + "=" + to_text(spec.fallback));
  }
  Options parsed;
  try {
    parsed = Options::parse(row.name, row.options, assignments);
  } catch (const Error& error) {
    throw BrokenPromise(std::string("an option's default is not allowed: ") + error.what());
  }
  require(parsed.values() == Options::parse(row.name, row.options, {}).values(),
          "an option's default reads back as another");
  make_minimize(get_problem(), 1, parsed, {}, 100);
}

void check_point(const std::vector<double>& point) {
  require(point.size() == get_problem().variables.size(), "a point of another dimension");
  for (const double coordinate : point) {
    require(std::isfinite(coordinate), "a coordinate is not finite");
  }
}

void read_later(const nlohmann::json& message, bool bounds) {
  const std::string type = read_type(message);
  if (type == "ask") {
    for (const auto& point : read_ask(message, get_problem(), bounds).points) {
      check_point(point);
      require(!bounds || (point[0] >= -1 && point[0] <= 1 && point[1] >= 1 && point[1] <= 100),
              "a point lies outside the bounds");
    }
  } else if (type == "recommend") {
    check_point(read_recommendation(message, get_problem()));
  }
}

}  // namespace

void fuzz_messages(std::string_view input) {
  if (input.size() > LineProcess::kLongestLine) {
    return;  // never gets here
  }
  bool described = false;
  bool bounds = false;
  for (const std::string& line : split(input, '\n')) {
    is_read<ProtocolError>([&] {
      const nlohmann::json message = read_message(line);
      if (described) {
        read_later(message, bounds);
      } else {
        const OptimizerRow row = read_description(message);
        check_row(row);
        described = true;
        bounds = row.capabilities.bounds;
      }
    });
  }
}

}  // namespace armwright::fuzz
