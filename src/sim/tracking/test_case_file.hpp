// Test cases in files, and what makes a case usable at all. Coordinates are in metres, in the
// robot's base frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tracking/test_case.hpp"

namespace armwright {

struct CaseFault {
  std::size_t point;  // the point it shows at
  std::string what;   // reads on after "case N, point P "
};

// Too few points, a coordinate that is not finite or too far away to be in metres, a point equal to
// its predecessor.
std::optional<CaseFault> find_fault(const TestCase& test_case);

// JSON or CSV, told apart by the first character: '{' or '[' begins JSON. At most 256 MiB.
// Error{bad_data} names file, line (CSV), case and point; Error{io} if the file cannot be read.
// Top-level keys of the JSON other than "cases" are ignored.
std::vector<TestCase> read_test_cases(const std::filesystem::path& file);
// The same of a text; `name` is the file's in messages.
std::vector<TestCase> parse_test_cases(std::string_view text, const std::string& name);

}  // namespace armwright
