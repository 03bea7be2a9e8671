#include <armwright/base/text.hpp>
#include <cstdio>
#include <string>
#include <vector>

int main() {
  const std::vector<std::string> valid = {"ga", "random"};
  std::puts(armwright::describe_unknown("optimizer", "gaa", valid).c_str());
}
