// Test cases as JSON or CSV: what is read has no fault, and is the same read back from either.
#include <fmt/format.h>

#include "base/text.hpp"
#include "fuzz/harness.hpp"
#include "sim/tracking/test_case.hpp"

namespace armwright::fuzz {
namespace {

std::string write_json(const std::vector<TestCase>& cases) {
  std::string text;
  for (const TestCase& one : cases) {
    std::string points;
    for (const Eigen::Vector3d& p : one.points_m) {
      points += fmt::format("{}[{},{},{}]", points.empty() ? "" : ",", format_exact(p.x()),
                            format_exact(p.y()), format_exact(p.z()));
    }
    text += fmt::format("{}[{}]", text.empty() ? "" : ",", points);
  }
  return "{\"cases\":[" + text + "]}";
}

std::string write_csv(const std::vector<TestCase>& cases) {
  std::string text = "case,point,x_m,y_m,z_m\n";
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (std::size_t k = 0; k < cases[i].points_m.size(); ++k) {
      const Eigen::Vector3d& p = cases[i].points_m[k];
      text += fmt::format("{},{},{},{},{}\n", i, k, format_exact(p.x()), format_exact(p.y()),
                          format_exact(p.z()));
    }
  }
  return text;
}

}  // namespace

void fuzz_test_cases(std::string_view input) {
  is_read([&] {
    const std::vector<TestCase> cases = parse_test_cases(input, "cases.json");
    require(!cases.empty(), "a set without a case");
    for (const TestCase& one : cases) {
      require(!find_fault(one), "a case with a fault");
    }
    const std::string hash = TestSet::make_from_cases(cases).name();
    for (const std::string& text : {write_json(cases), write_csv(cases)}) {
      const std::vector<TestCase> again = parse_test_cases(text, "again");
      require(TestSet::make_from_cases(again).name() == hash, "another set is read back");
    }
  });
}

}  // namespace armwright::fuzz
