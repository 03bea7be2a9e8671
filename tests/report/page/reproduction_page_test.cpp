// Checks the page of a reproduction: it has all keys of its type and the figures that have results,
// and it says which ones are missing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "base/expect_error.hpp"
#include "report/page/page_data.hpp"
#include "report/reproduction/reproduction.hpp"
#include "report/reproduction/small_reproduction.hpp"
#include "study/run/run_observer.hpp"
#include "study/statistics/summary.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class Silent final : public RunObserver {
 public:
  void on_progress(const Progress& /*progress*/) override {}
  void on_message(const std::string& /*message*/) override {}
};

class ReproductionPageTest : public testing::Test {
 protected:
  void reproduce(const ReproductionRequest& request) {
    ReproductionPlan plan = plan_reproduction(request);
    ReproductionFolder folder(path(), plan);
    ASSERT_TRUE(execute_reproduction(plan, &folder, "armwright", 1, stop_, observer_));
  }
  std::string make_page(const PageOptions& options = {}) {
    return make_reproduction_page(path(), options, stop_, observer_).value();
  }
  std::filesystem::path path() const { return small_.path() / "reproduction"; }

  SmallReproduction small_;
  StopSignal stop_;
  Silent observer_;
};

std::set<std::string> get_keys(const json& object) {
  std::set<std::string> keys;
  for (const auto& [key, value] : object.items()) {
    keys.insert(key);
  }
  return keys;
}

std::string join_notes(const json& page) {
  std::string text;
  for (const json& note : page["notes"]) {
    text += note.get<std::string>() + "\n";
  }
  return text;
}

TEST_F(ReproductionPageTest, HasAllKeysAndWhatWasComputed) {
  reproduce(small_.request());
  const std::string text = make_page();
  const json page = json::parse(text);
  EXPECT_EQ(get_keys(page),
            (std::set<std::string>{"format", "kind",      "title",    "subtitle", "program",
                                   "folder", "command",   "finished", "progress", "watched",
                                   "notes",  "facts",     "robots",   "replays",  "rows",
                                   "runs",   "responses", "signals",  "sweep",    "momentary"}));
  EXPECT_EQ(page["kind"], "reproduction");
  EXPECT_EQ(page["finished"], true);
  EXPECT_TRUE(page["progress"].is_null());
  EXPECT_THAT(page["command"].get<std::string>(), HasSubstr("--cases 2"));

  const ReproductionRecord record = load_reproduction(path());
  const json& row = page["rows"][0];
  EXPECT_EQ(row["label"], "A.5");
  EXPECT_EQ(row["published_error_m"], *record.results.at("A.5").part.published_error_m);
  EXPECT_EQ(row["mean_m"], *record.results.at("A.5").calc_summary().mean);
  EXPECT_EQ(row["command"],
            "armwright evaluate table-a5 --problem q1-complex --set task.ik_bug=true --set "
            "physics.engine=ode --cases 2");
  EXPECT_EQ(row["standard_error_m"],
            calc_mean_and_error(record.results.at("A.5").case_errors).standard_error);
  EXPECT_EQ(row["reason"], "");
  for (const json& one : page["rows"]) {
    EXPECT_EQ(one["reason"], one["label"] == "A.9" ? "The reason." : "") << one["label"];
  }
  EXPECT_EQ(page["runs"][0]["reason"], "The reason.");
  EXPECT_EQ(page["rows"].back()["label"], "A.11 (Q3)");
  ASSERT_EQ(page["runs"].size(), 2);
  EXPECT_EQ(page["runs"][0]["name"], "T1");
  EXPECT_EQ(page["runs"][0]["folder"], (path() / "runs" / "tiny").string());
  EXPECT_THAT(page["runs"][1]["command"].get<std::string>(),
              AllOf(HasSubstr("winner.toml"), HasSubstr("--set task.ik_bug=false")));

  ASSERT_EQ(page["responses"].size(), 1);
  const json& response = page["responses"][0];
  EXPECT_EQ(response["distances_m"].size(), 25);
  EXPECT_EQ(response["counted"][0], false);
  ASSERT_EQ(response["series"].size(), 2);
  EXPECT_EQ(response["series"][0]["mean_m"].size(), 25);
  EXPECT_EQ(response["series"][1]["published_mean_m"], 0.0126);
  EXPECT_EQ(page["sweep"]["values"].size(), 11);
  EXPECT_EQ(page["sweep"]["nominal"], 1.5);
  EXPECT_EQ(page["sweep"]["values"][0], 0.5);
  EXPECT_EQ(page["sweep"]["series"][0]["mean_m"].size(), 11);
  EXPECT_EQ(page["signals"]["curves"].size(), 5);

  ASSERT_EQ(page["replays"].size(), 1);
  EXPECT_EQ(page["replays"][0]["cases"][0]["id"], "train/1:1");
  EXPECT_EQ(page["replays"][0]["cases"][1]["set"], "test/2");
  ASSERT_EQ(page["momentary"].size(), 1);
  EXPECT_EQ(
      page["momentary"][0],
      (json{{"name", "Ramp"}, {"replay", "ramp"}, {"design", "table-a8"}, {"case", "train/1:1"}}));
  EXPECT_EQ(page["robots"].size(), 1);
  EXPECT_EQ(text, make_page());
}

TEST_F(ReproductionPageTest, SaysWhatIsMissing) {
  ReproductionRequest request = small_.request();
  request.tables = {"A.8"};
  reproduce(request);
  {
    // The reproduction is planned, but interrupted before its first result.
    request.tables = {"A.7", "A.8"};
    const ReproductionFolder folder(path(), plan_reproduction(request));
  }
  PageOptions options;
  options.simulate = false;
  const json page = json::parse(make_page(options));
  EXPECT_EQ(page["finished"], false);
  EXPECT_EQ(page["progress"], (json{{"done", 1}, {"total", 2}, {"unit", "results"}}));
  EXPECT_THAT(join_notes(page), AllOf(HasSubstr("1 of 2 results"), HasSubstr("T1 (Fig. 1)"),
                                      HasSubstr("Fig. 6.16"), HasSubstr("not simulated")));
  EXPECT_THAT(page["replays"], IsEmpty());
  EXPECT_THAT(page["momentary"], IsEmpty());
  EXPECT_THAT(page["sweep"]["values"], IsEmpty());
  ASSERT_EQ(page["responses"].size(), 1);
  EXPECT_EQ(page["responses"][0]["series"].size(), 1);
}

TEST_F(ReproductionPageTest, RecordsFurtherCasesAndRefusesWhatIsNone) {
  ReproductionRequest request = small_.request();
  request.tables = {"A.8"};
  reproduce(request);
  PageOptions options;
  options.cases = {"test/7:3"};
  const json page = json::parse(make_page(options));
  EXPECT_EQ(page["replays"][0]["cases"].back()["id"], "test/7:3");
  options.cases = {"test/7"};
  EXPECT_THAT(usage_error_of([&] { make_page(options); }),
              AllOf(HasSubstr("'test/7'"), HasSubstr("test/2:17")));
  stop_.request(StopReason::interrupted);
  EXPECT_EQ(make_reproduction_page(path(), {}, stop_, observer_), std::nullopt);
}

}  // namespace
}  // namespace armwright
