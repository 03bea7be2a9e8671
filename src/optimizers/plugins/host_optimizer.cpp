#include "optimizers/plugins/host_optimizer.hpp"

#include <fmt/format.h>

#include <memory>
#include <utility>

#include "base/error.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "optimizers/plugins/plugin_messages.hpp"

namespace armwright {
namespace {

class ForeignOptimizer : public Optimizer {
 public:
  explicit ForeignOptimizer(std::string name) : name_(std::move(name)) {}

  void minimize(Evaluator& /*evaluator*/, std::uint64_t /*seed*/) override {
    throw Error(ErrorKind::usage, explain_host_optimizer(name_));
  }

 private:
  std::string name_;
};

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
  const auto refuse = [&](std::string_view why) {
    throw Error(ErrorKind::bad_data,
                fmt::format("optimizer '{}': its description {}", sanitize(name), sanitize(why)));
  };
  if (!is_host_name(name)) {
    refuse(
        fmt::format("is not needed; only of an optimizer in Python, whose name begins with "
                    "'{}', one is recorded",
                    kPythonPrefix));
  }
  OptimizerRow row;
  try {
    check_json_depth(description, name);
    row = read_description(nlohmann::json::parse(description));
  } catch (const ProtocolError& error) {
    refuse(fmt::format("is wrong: it {}", error.what()));
  } catch (const nlohmann::json::exception& error) {
    refuse(fmt::format("is no JSON ({})", error.what()));
  }
  row.name = name;
  row.description = description;
  row.isolated = {};
  row.unavailable = explain_host_optimizer(name);
  row.make = [name](const Options&) -> std::unique_ptr<Optimizer> {
    return std::make_unique<ForeignOptimizer>(name);
  };
  return row;
}

}  // namespace armwright
