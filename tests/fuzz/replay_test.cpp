// The corpus of every fuzzer and the inputs that once were a bug, in an ordinary build.
#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

#include "base/file.hpp"
#include "fuzz/harness.hpp"

namespace armwright::fuzz {
namespace {

namespace fs = std::filesystem;

struct HarnessRow {
  const char* name;  // of its folder below corpus/ and regressions/
  void (*run)(std::string_view input);
};

constexpr HarnessRow kHarnesses[] = {
    {"problem", fuzz_problem},
    {"study", fuzz_study},
    {"design", fuzz_design},
    {"urdf", fuzz_urdf},
    {"test_cases", fuzz_test_cases},
    {"messages", fuzz_messages},
    {"descriptor", fuzz_descriptor},
    {"journal", fuzz_journal},
    {"records", fuzz_records},
    {"manifest", fuzz_manifest},
    {"export_csv", fuzz_export_csv},
    {"export_json", fuzz_export_json},
    {"path", fuzz_path},
    {"gains", fuzz_gains},
    {"log", fuzz_log},
    {"http_request", fuzz_http_request},
};

constexpr std::size_t kLargestInput_bytes = std::size_t{16} << 20;
// Of processor time, so that a busy machine does not count: fuzzers allow 2 s with sanitizers.
constexpr double kLongest_s = 5;

std::vector<fs::path> list_inputs(const std::string& kind, const std::string& name) {
  std::vector<fs::path> files;
  const fs::path folder = fs::path(ARMWRIGHT_FUZZ_INPUTS) / kind / name;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

class Replay : public testing::TestWithParam<HarnessRow> {
 protected:
  static void run(const std::vector<fs::path>& files) {
    for (const fs::path& file : files) {
      const std::string input = read_file(file, kLargestInput_bytes);
      const std::clock_t before = std::clock();
      try {
        GetParam().run(input);
      } catch (const std::exception& error) {
        ADD_FAILURE() << file << ": neither read nor refused: " << error.what();
      }
      const auto spent_s = static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
      EXPECT_LT(spent_s, kLongest_s) << file;
    }
  }
};

TEST_P(Replay, Corpus) {
  const auto files = list_inputs("corpus", GetParam().name);
  EXPECT_FALSE(files.empty());
  run(files);
}

TEST_P(Replay, Regressions) {
  run(list_inputs("regressions", GetParam().name));
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Replay, testing::ValuesIn(kHarnesses),
                         [](const auto& row) { return std::string(row.param.name); });

// A folder that no harness reads would be tested by nobody.
TEST(FuzzInputs, BelongToHarnesses) {
  for (const char* kind : {"corpus", "regressions"}) {
    for (const auto& entry : fs::directory_iterator(fs::path(ARMWRIGHT_FUZZ_INPUTS) / kind)) {
      EXPECT_TRUE(std::ranges::any_of(kHarnesses, [&](const HarnessRow& row) {
        return entry.path().filename() == row.name;
      })) << entry.path();
    }
  }
}

}  // namespace
}  // namespace armwright::fuzz
