#include "study/run/run_times.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/json_text.hpp"
#include "base/text.hpp"
#include "study/run/json_values.hpp"

namespace armwright {
namespace {

using nlohmann::json;

constexpr std::size_t kTimesLimit_bytes = 4096;

double to_seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

double measure_cpu_s() {
  double sum = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    ::getrusage(who, &usage);
    sum += to_seconds(usage.ru_utime) + to_seconds(usage.ru_stime);
  }
  return sum;
}

// Returns a time. Throws std::out_of_range if it is negative or not finite.
double check_time(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) {
    throw std::out_of_range("a time must be finite and not negative");
  }
  return seconds;
}

double round_to_ms(double seconds) {
  return std::round(1000 * seconds) / 1000;
}

}  // namespace

std::optional<RunTimes> load_times(const std::filesystem::path& folder) {
  const auto file = folder / kTimesFile;
  if (!path_exists(file)) {
    return std::nullopt;
  }
  const std::string text = read_json_file(file, kTimesLimit_bytes);
  try {
    const json j = json::parse(text);
    RunTimes times{.wall_s = check_time(j.at("wall_s").get<double>()),
                   .cpu_s = optional_from_json(j.at("cpu_s")),
                   .lives = whole_from_json(j.at("lives"))};
    check_time(times.cpu_s.value_or(0));
    return times;
  } catch (const std::exception& error) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: is damaged ({}); remove it: it has nothing but the time that the "
                            "run took",
                            file.string(), sanitize(error.what())));
  }
}

std::optional<RunTimes> find_times(const std::filesystem::path& folder) {
  try {
    return load_times(folder);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_data) {
      throw;
    }
    return std::nullopt;
  }
}

RunClock::RunClock() : begun_cpu_s_(measure_cpu_s()) {}

void RunClock::add_to(const Folder& folder, bool simulates) const {
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begun_;
  const RunTimes before = find_times(folder.path()).value_or(RunTimes{.cpu_s = 0});
  const json times = {
      {"wall_s", round_to_ms(before.wall_s + wall.count())},
      {"cpu_s", simulates && before.cpu_s
                    ? json(round_to_ms(*before.cpu_s + measure_cpu_s() - begun_cpu_s_))
                    : json(nullptr)},
      {"lives", before.lives + 1}};
  write_file_atomically(folder, kTimesFile, times.dump(2) + "\n");
}

}  // namespace armwright
