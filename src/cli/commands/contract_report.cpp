#include "cli/commands/contract_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "cli/list/list_views.hpp"
#include "cli/terminal/format.hpp"
#include "cli/terminal/table.hpp"
#include "cli/terminal/terminal.hpp"

namespace armwright {
namespace {

using nlohmann::json;

const char* to_string(ContractOutcome outcome) {
  switch (outcome) {
    case ContractOutcome::held:
      return "held";
    case ContractOutcome::broken:
      return "BROKEN";
    case ContractOutcome::exempt:
      return "exempt";
  }
  return "?";
}

}  // namespace

int report_contract(const CheckedThing& thing, const std::vector<NamedCheck>& checks, bool as_json,
                    Session& session) {
  const Style style = make_style(Stream::out, session.color);
  Table table({{"promise", false}, {"", false}, {"why", false}});
  json findings = json::array();
  int broken = 0;
  for (const NamedCheck& check : checks) {
    if (!as_json) {
      write_message(fmt::format("{}: {} ...", check.name, check.promise));
    }
    const ContractFinding finding = check.run();
    broken += finding.outcome == ContractOutcome::broken ? 1 : 0;
    table.add_row({check.promise, to_string(finding.outcome), sanitize(finding.detail)});
    findings.push_back({{"check", check.name},
                        {"promise", check.promise},
                        {"outcome", to_string(finding.outcome)},
                        {"detail", sanitize(finding.detail)}});
    if (finding.ends) {
      break;
    }
  }
  if (as_json) {
    write_stdout(json{{thing.kind, thing.name}, {"broken", broken}, {"checks", findings}}.dump(1) +
                 "\n");
  } else {
    write_stdout(format_title(style, sanitize(thing.name), sanitize(thing.summary)) +
                 table.format(style, 2) +
                 (broken == 0 ? "It keeps every promise.\n"
                              : style.red(fmt::format("{} of {} promises are broken.\n", broken,
                                                      checks.size()))));
  }
  return broken == 0 ? exit_code::kDone : exit_code::kFailed;
}

}  // namespace armwright
