#include "optimizers/plugins/recorded_optimizer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "optimizers/interface/capability_table.hpp"
#include "optimizers/plugins/plugin_messages.hpp"
#include "optimizers/plugins/plugin_process.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::string_view kProgramPrefix = "exec:";

class RecordedOptimizer : public Optimizer {
 public:
  explicit RecordedOptimizer(std::string why) : why_(std::move(why)) {}

  void minimize(Evaluator& /*evaluator*/, std::uint64_t /*seed*/) override {
    throw Error(ErrorKind::usage, why_);
  }

 private:
  std::string why_;
};

// Makes the row's optimizer one that throws Error{usage} with this text.
void forbid_runs(OptimizerRow& row, const std::string& why) {
  row.make = [why](const Options&) -> std::unique_ptr<Optimizer> {
    return std::make_unique<RecordedOptimizer>(why);
  };
}

std::string explain_recorded_plugin(std::string_view name) {
  return fmt::format("optimizer '{}' is known only from a study's record here, so it cannot run",
                     sanitize(name));
}

// Reads a description. The descriptions of shared libraries lack a name.
OptimizerRow read_recorded_row(const std::string& name, const std::string& description) {
  const auto refuse = [&](std::string_view why) {
    throw Error(ErrorKind::bad_data,
                fmt::format("optimizer '{}': its description {}", sanitize(name), sanitize(why)));
  };
  OptimizerRow row;
  try {
    check_json_depth(description, name);
    json message = json::parse(description);
    if (message.is_object() && !message.contains("name")) {
      message["name"] = "plugin";
    }
    row = read_description(message);
  } catch (const ProtocolError& error) {
    refuse(fmt::format("is wrong: it {}", error.what()));
  } catch (const json::exception& error) {
    refuse(fmt::format("is no JSON ({})", error.what()));
  }
  row.description = description;
  return row;
}

}  // namespace

bool is_host_name(std::string_view name) {
  return name.starts_with(kPythonPrefix);
}

std::string explain_host_optimizer(std::string_view name) {
  return fmt::format(
      "optimizer '{}' is a class in somebody's Python program, and runs only there: "
      "armwright.optimize() and armwright.compare() take it as it is, and the same call goes on "
      "with what was begun. For the command line a script can serve it: armwright.serve(CLASS), "
      "then --optimizer 'exec:python3 SCRIPT' (docs/python.md)",
      sanitize(name));
}

OptimizerRow read_host_row(const std::string& name, const std::string& description) {
  OptimizerRow row = read_recorded_row(name, description);
  row.name = name;
  row.isolated = {};
  row.unavailable = explain_host_optimizer(name);
  forbid_runs(row, row.unavailable);
  return row;
}

std::string make_description(const OptimizerRow& row) {
  json message = {{"type", "description"},
                  {"protocol", kPluginProtocol},
                  {"summary", row.summary},
                  {"source", row.source},
                  {"capabilities", json::array()},
                  {"options", json::array()},
                  {"requirements",
                   {{"objectives", row.requirements.objectives},
                    {"variables", row.requirements.variables},
                    {"residuals", row.requirements.residuals}}}};
  if (!row.name.empty()) {
    message["name"] = row.name;
  }
  for (const CapabilityRow& capability : kCapabilityTable) {
    if (row.capabilities.*capability.member) {
      message["capabilities"].push_back(capability.name);
    }
  }
  for (const OptionSpec& spec : row.options) {
    json option = {{"name", spec.name}, {"description", spec.description}};
    std::visit([&option](const auto& value) { option["default"] = value; }, spec.fallback);
    if (option["default"].is_number()) {
      option["lower"] = spec.lower;
      option["upper"] = spec.upper;
    } else if (!spec.choices.empty()) {
      option["choices"] = spec.choices;
    }
    message["options"].push_back(std::move(option));
  }
  std::string text = message.dump(-1, ' ', false, json::error_handler_t::replace);
  try {
    read_recorded_row(row.name, text);
  } catch (const Error&) {
    return "";
  }
  return text;
}

OptimizerRow read_plugin_row(const std::string& name, const std::string& description) {
  OptimizerRow row = read_recorded_row(name, description);
  if (!name.starts_with(kProgramPrefix)) {
    row.name = name;  // a program has the name that it gives itself
  }
  forbid_runs(row, explain_recorded_plugin(name));
  return row;
}

OptimizerRow make_undescribed_row(const std::string& name, std::span<const std::string> options) {
  OptimizerRow row;
  row.name = name;
  row.summary = "a plugin without a recorded description";
  row.capabilities.generations = true;
  row.capabilities.local = true;
  for (const std::string& option : options) {
    OptionSpec spec{
        .name = option.substr(0, option.find('=')), .description = "", .fallback = std::string()};
    if (std::ranges::count(row.options, spec.name, &OptionSpec::name) == 0) {
      row.options.push_back(std::move(spec));
    }
  }
  forbid_runs(row, explain_recorded_plugin(name));
  return row;
}

}  // namespace armwright
