#include <fmt/format.h>

#include "base/error.hpp"
#include "base/text.hpp"
#include "parts.hpp"
#include "study/run/run_folder.hpp"

namespace armwright::python {

std::filesystem::path Place::choose(const std::string& name) const {
  if (!out) {
    return choose_run_folder("results", name, another);
  }
  auto path = std::filesystem::path(*out).lexically_normal();
  if (!path.has_filename()) {
    path = path.parent_path();  // "results/mine/"
  }
  return choose_run_folder(path.parent_path(), path.filename().string(), another);
}

std::int64_t check_number(std::string_view name, std::int64_t value, std::int64_t lower,
                          std::int64_t upper) {
  if (value < lower || value > upper) {
    throw Error(ErrorKind::usage, fmt::format("{} is {}; it must be an integer from {} to {}", name,
                                              value, lower, upper));
  }
  return value;
}

Schedule parse_schedule(const std::string& text) {
  const auto schedule = read_schedule(text);
  if (!schedule) {
    throw Error(ErrorKind::usage,
                fmt::format("schedule is '{}'; it must be {}", sanitize(text), kScheduleForms));
  }
  return *schedule;
}

}  // namespace armwright::python
