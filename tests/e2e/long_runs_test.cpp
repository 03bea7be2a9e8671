// What docs/reliability.md promises of ten million evaluations, seen at the growth from a hundred
// thousand of them to four hundred thousand: one run's memory differs from the next one's by 1.5 MiB,
// which that distance leaves at 48 MiB of the promise.
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"
#include "study/journal/journal.hpp"

namespace armwright {
namespace {

constexpr double kTenMillion = 1e7;
constexpr double kPromise_bytes = 500.0 * (1 << 20);

// The memory that a thing takes for ten million, from what it takes for fewer, in proportion.
double extrapolate(const std::array<std::size_t, 2>& evaluations,
                   const std::array<std::size_t, 2>& memory_bytes) {
  const double growth =
      (static_cast<double>(memory_bytes[1]) - static_cast<double>(memory_bytes[0])) /
      static_cast<double>(evaluations[1] - evaluations[0]);
  return static_cast<double>(memory_bytes[1]) +
         growth * (kTenMillion - static_cast<double>(evaluations[1]));
}

TEST(LongRuns, OfTenMillionEvaluationsStayBelowFiveHundredMebibytes) {
  const TemporaryFolder folder;
  const std::array<std::size_t, 2> evaluations = {100'000, 400'000};
  std::array<std::size_t, 2> first{};
  std::array<std::size_t, 2> again{};
  std::array<std::size_t, 2> shown{};
  std::array<std::size_t, 2> exported{};
  std::array<std::size_t, 2> page_bytes{};
  for (std::size_t i = 0; i < 2; ++i) {
    const std::string name = std::to_string(evaluations[i]);
    const auto run = [&](const std::vector<std::string>& arguments, std::size_t& memory_bytes) {
      const Outcome outcome = run_program(folder.path(), arguments);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      memory_bytes = outcome.most_memory_bytes;
    };
    const std::vector<std::string> optimize = {"optimize", "sphere", "--optimizer", "ga",
                                               "--budget", name,     "--out",       name};
    run(optimize, first[i]);
    std::filesystem::remove(folder / name / "result.json");
    run(optimize, again[i]);  // all of it is replayed
    run({"report", name, "--out", name + ".html"}, shown[i]);
    run({"export", name, "--format", "csv", "--out", name + "-csv"}, exported[i]);
    page_bytes[i] = std::filesystem::file_size(folder / (name + ".html"));
  }
  EXPECT_LT(extrapolate(evaluations, first), kPromise_bytes);
  EXPECT_LT(extrapolate(evaluations, again), kPromise_bytes);
  EXPECT_LT(extrapolate(evaluations, shown), kPromise_bytes);
  EXPECT_LT(extrapolate(evaluations, exported), kPromise_bytes);
  // A page shows as many points of a long run as of a longer one.
  EXPECT_LT(page_bytes[1], page_bytes[0] + (std::size_t{64} << 10));
}

}  // namespace
}  // namespace armwright
