// What a row of the table of optimizers says, in words for its user: the same ones on the terminal
// and on the pages under docs/optimizers.
#pragma once

#include <string>
#include <vector>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

struct CapabilityWords {
  const char* name;  // as plugins declare it
  bool Capabilities::*member;
  const char* with;  // what it means for the user to have it, and not to
  const char* without;
};

const std::vector<CapabilityWords>& capability_words();

// Of those it has, in that order.
std::vector<std::string> list_capabilities(const Capabilities& capabilities);

// What having it, or not, means for this row.
std::string describe_capability(const OptimizerRow& row, const CapabilityWords& words);

// What the problem must offer: "at least 2 objectives"; empty if any will do.
std::vector<std::string> list_requirements(const Requirements& requirements);

// Where it runs, as the end of a sentence that begins with "it runs".
std::string describe_isolation(const OptimizerRow& row);

const char* get_option_type(const OptionValue& value);
// "2 to 100000"; empty for choices, texts and truth values
std::string describe_range(const OptionSpec& option);

}  // namespace armwright
