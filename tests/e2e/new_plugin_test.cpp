// A plugin from nothing, as docs/tutorials/add-an-optimizer.md has it; in Python, which needs no
// installed package to build against.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliNewPlugin : public testing::Test {
 protected:
  Outcome run(const std::vector<std::string>& arguments) {
    return run_program(folder_.path(), arguments);
  }
  TemporaryFolder folder_;
};

TEST_F(CliNewPlugin, InPythonItRunsAsItIs) {
  const Outcome made = run({"new-plugin", "--language", "python", "mine"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_EQ(made.out, "mine/mine.py\nmine/README.md\nmine/test.sh\n");
  const std::vector<std::string> optimize = {
      "optimize", "sphere", "--optimizer", "exec:python3 mine/mine.py", "--budget", "600",
      "--out",    "run",    "--json"};
  const Outcome first = run(optimize);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const json result = json::parse(first.out);
  EXPECT_EQ(result["optimizer"], "mine");
  // The sphere's start is worth more than 30: it does optimize.
  EXPECT_LT(result["winner"]["test"]["objectives"][0].get<double>(), 1);
}

TEST_F(CliNewPlugin, EveryLanguageHasItsFilesWithTheNameFilledIn) {
  for (const auto& [language, suffix] : std::vector<std::pair<std::string, std::string>>{
           {"c++", ".cpp"}, {"c", ".c"}, {"python", ".py"}}) {
    const std::string name = "my_" + suffix.substr(1);
    ASSERT_EQ(run({"new-plugin", "--language", language, name}).exit_code, 0);
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / name)) {
      EXPECT_THAT(read_text(entry.path()), HasSubstr(name)) << entry.path();
      EXPECT_THAT(read_text(entry.path()), testing::Not(testing::ContainsRegex("@[A-Z]+@")));
    }
    EXPECT_TRUE(std::filesystem::exists(folder_ / (name + "/" + name + suffix)));
    EXPECT_EQ(std::filesystem::exists(folder_ / (name + "/CMakeLists.txt")), language != "python");
    EXPECT_EQ(access((folder_ / (name + "/test.sh")).c_str(), X_OK), 0);
  }
}

TEST_F(CliNewPlugin, OverwritesNothingAndRefusesBadNames) {
  ASSERT_EQ(run({"new-plugin", "mine"}).exit_code, 0);
  const std::string before = read_text(folder_ / "mine/mine.cpp");
  const Outcome again = run({"new-plugin", "--language", "c", "mine"});
  EXPECT_EQ(again.exit_code, 2);
  EXPECT_THAT(again.err, HasSubstr("'mine' exists already and is not overwritten"));
  EXPECT_EQ(read_text(folder_ / "mine/mine.cpp"), before);
  for (const char* name : {"../x", "Mine", "1st", "a-b", "test", "ga"}) {
    const Outcome outcome = run({"new-plugin", name});
    EXPECT_EQ(outcome.exit_code, 2) << name;
    EXPECT_THAT(outcome.err, HasSubstr("NAME is '")) << name;
  }
  EXPECT_THAT(run({"new-plugin", "--language", "pyton", "other"}).err,
              HasSubstr("did you mean 'python'?"));
  for (const std::string& entry : folder_.list()) {  // beside what the tests' program leaves there
    EXPECT_TRUE(entry == "mine" || entry.starts_with(".streams")) << entry;
  }
}

}  // namespace
}  // namespace armwright
