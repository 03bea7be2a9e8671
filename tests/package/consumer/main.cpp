#include <armwright/base/text.hpp>
#include <armwright/optimizers/table/optimizer_table.hpp>
#include <cstdio>
#include <string>
#include <vector>

int main() {
  const std::vector<std::string> valid = {"ga", "random"};
  std::puts(armwright::describe_unknown("optimizer", "gaa", valid).c_str());
  // The modules lie beside this program, if the build has their libraries.
  for (const char* name : {"ceres:lm", "pagmo:de"}) {
    const armwright::OptimizerRow& row = armwright::find_optimizer(name);
    if (row.unavailable.empty()) {
      row.make(armwright::Options::parse(row.name, row.options, {}));
    } else if (row.unavailable.find("built without") == std::string::npos) {
      std::puts(row.unavailable.c_str());
      return 1;
    }
  }
}
