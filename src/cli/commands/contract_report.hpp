// Runs the checks of a contract and prints what they find, for check-plugin and check-problem.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/terminal/session.hpp"
#include "study/contract/contract.hpp"

namespace armwright {

struct NamedCheck {
  std::string name;
  std::string promise;
  std::function<ContractFinding()> run;
};

struct CheckedThing {
  std::string kind;  // "optimizer", the key of its name in JSON
  std::string name;
  std::string summary;
};

// Returns the exit code of the command: kFailed if a promise is broken.
int report_contract(const CheckedThing& thing, const std::vector<NamedCheck>& checks, bool as_json,
                    Session& session);

}  // namespace armwright
