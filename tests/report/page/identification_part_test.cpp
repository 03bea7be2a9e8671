// The part of a page that shows an identification, from a hand-written identification.json.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "base/expect_error.hpp"
#include "base/file.hpp"
#include "base/folder_checksums.hpp"
#include "base/temporary_folder.hpp"
#include "report/page/data_contract.hpp"
#include "report/page/run_parts.hpp"
#include "report/page/unpack.hpp"
#include "study/run/run_folder.hpp"

namespace armwright {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// A motion of two joints: the first one moves by 1 rad/s, the second one rests at 0.5 rad.
json make_motion(const std::string& log, double period_s, int rows) {
  json times = json::array(), moving = json::array(), resting = json::array(),
       efforts = json::array();
  for (int k = 0; k < rows; ++k) {
    times.push_back(k * period_s);
    moving.push_back(k * period_s);
    resting.push_back(0.5);
    efforts.push_back(10.0 * k);
  }
  const json both = {efforts, efforts};
  return {{"log", log},       {"times_s", times},     {"positions", {moving, resting}},
          {"recorded", both}, {"model_before", both}, {"model_after", both}};
}

json make_set(const std::string& log) {
  const json joint = {{"joint", "joint_1"},  {"unit", "N m"},    {"deviation", 3.0},
                      {"rms_before", 2.0},   {"rms_after", 1.0}, {"whiteness_p", nullptr},
                      {"independent_s", 0.4}};
  return {{"logs", {log}}, {"joints", {joint, joint}}, {"error_before", 0.6}, {"error_after", 0.3}};
}

json make_identification() {
  return {{"robot", "planar2"},
          {"doubts", {"a doubt"}},
          {"undetermined", json::array()},
          {"parameters",
           {{{"name", "payload mass"},
             {"unit", "kg"},
             {"before", 1.0},
             {"start", 2.0},
             {"value", 2.0},
             {"standard_error", 0.1},
             {"lower", 1.8},
             {"upper", 2.2},
             {"determined", true},
             {"at_bound", false}}}},
          {"correlations", json::array()},
          {"condition", 10.0},
          {"fitted", make_set("/logs/a.csv")},
          {"held_back", make_set("b.csv")},
          {"motions", {make_motion("/logs/a.csv", 0.02, 51), make_motion("b.csv", 0.04, 26)}}};
}

class IdentificationPart : public testing::Test {
 protected:
  void keep(const json& identification) {
    write_file_atomically(folder_.path() / kIdentificationFile, identification.dump());
  }
  // Returns the page, and the notes in notes_.
  json make_part(const std::string& urdf = "planar2.urdf",
                 const std::string& kind = "identification") {
    RecordedRun run;
    run.folder = run.input_folder = folder_.path();
    run.configuration = {{"problem", {{"kind", kind}, {"robot", {{"urdf", urdf}}}}}};
    json page = {{"title", ""},
                 {"subtitle", ""},
                 {"identification", nullptr},
                 {"robots", json::array()},
                 {"replays", json::array()}};
    notes_.clear();
    add_identification(run, page, notes_);
    return page;
  }

  const TemporaryFolder folder_;
  std::vector<std::string> notes_;
};

TEST_F(IdentificationPart, HasWhatTheContractSays) {
  keep(make_identification());
  const json page = make_part();
  EXPECT_EQ(page["title"], "The plant of planar2");
  EXPECT_EQ(page["subtitle"], "identified from a.csv; held back: b.csv");
  const json& found = page["identification"];
  EXPECT_EQ(list_keys(found), read_contract("Identification"));
  EXPECT_EQ(list_keys(found["fitted"]), read_contract("FitSet"));
  EXPECT_EQ(list_keys(found["fitted"]["joints"][0]), read_contract("JointFit"));
  EXPECT_EQ(list_keys(found["parameters"][0]), read_contract("FittedParameter"));
  EXPECT_EQ(list_keys(found["motions"][0]), read_contract("RecordedMotion"));
  const json& replay = page["replays"][0];
  EXPECT_EQ(list_keys(replay), read_contract("ReplaySet"));
  EXPECT_EQ(list_keys(replay["designs"][0]), read_contract("DesignInfo"));
  EXPECT_EQ(list_keys(replay["cases"][0]), read_contract("ReplayCase"));
  EXPECT_EQ(list_keys(replay["cases"][0]["motions"][0]), read_contract("Motion"));
  EXPECT_EQ(found["doubts"], json({"a doubt"}));
}

TEST_F(IdentificationPart, TheMotionsKnowTheirLogs) {
  keep(make_identification());
  const json page = make_part();
  const json& motions = page["identification"]["motions"];
  ASSERT_EQ(motions.size(), 2u);
  EXPECT_EQ(motions[0]["held_back"], false);
  EXPECT_EQ(motions[1]["held_back"], true);
  EXPECT_EQ(motions[1]["period_s"], 0.04);
  // The replay begins with what was not fitted.
  EXPECT_EQ(motions[1]["id"], page["replays"][0]["cases"][0]["id"]);
  EXPECT_EQ(page["replays"][0]["cases"][0]["label"], "b.csv, held back");
}

TEST_F(IdentificationPart, AllMotionsAreReplayedWithTheShortestPeriod) {
  keep(make_identification());
  const json replay = make_part()["replays"][0];
  EXPECT_EQ(replay["task"]["control_period_s"], 0.02);
  for (const json& one : replay["cases"]) {
    EXPECT_EQ(one["steps"], 50) << one["label"];
    EXPECT_EQ(one["start_q"], json({0.0, 0.5}));
    EXPECT_THAT(one["points_m"], IsEmpty());  // there is no target
    const auto q = unpack_f32(one["motions"][0]["q"]);
    ASSERT_EQ(q.size(), 100u);
    for (std::size_t k = 0; k < 50; ++k) {  // row k is at the end of period k
      EXPECT_NEAR(q[2 * k], 0.02 * static_cast<double>(k + 1), 1e-6) << one["label"] << k;
      EXPECT_NEAR(q[2 * k + 1], 0.5, 1e-7);
    }
  }
  const auto effort = unpack_f32(replay["cases"][0]["motions"][0]["effort"]);
  EXPECT_NEAR(effort[0], 5, 1e-4);  // between 0 and 10
}

TEST_F(IdentificationPart, WithoutTheRobotsFileOnlyTheArmIsMissing) {
  keep(make_identification());
  const json page = make_part("gone.urdf");
  EXPECT_THAT(page["replays"], IsEmpty());
  EXPECT_EQ(page["identification"]["motions"].size(), 2u);
  EXPECT_THAT(notes_,
              ElementsAre(HasSubstr("The arm is not shown, because its file cannot be read")));
  make_part("irb4600_40_255.urdf");
  EXPECT_THAT(notes_, ElementsAre(HasSubstr("other joints than the logs")));
}

TEST_F(IdentificationPart, NumbersThatDoNotExistAreGaps) {
  json identification = make_identification();
  identification["motions"][0]["recorded"][1][3] = nullptr;
  keep(identification);
  const auto recorded = unpack_f32(make_part()["identification"]["motions"][0]["recorded"]);
  EXPECT_TRUE(std::isnan(recorded[7]));
  EXPECT_EQ(recorded[6], 30);
}

TEST_F(IdentificationPart, OtherRunsHaveNone) {
  keep(make_identification());
  EXPECT_TRUE(make_part("planar2.urdf", "tracking")["identification"].is_null());
}

TEST_F(IdentificationPart, ADamagedFileIsNamedWithItsFault) {
  json identification = make_identification();
  identification["motions"][0]["positions"][0].erase(0);
  keep(identification);
  const auto expect_refused = [&](const std::string& fault) {
    const std::string said = error_of(ErrorKind::bad_data, [&] { make_part(); });
    EXPECT_THAT(said,
                HasSubstr("identification.json: is not an identification that armwright wrote"));
    EXPECT_THAT(said, HasSubstr(fault));
  };
  expect_refused("a joint has 50 of 51 samples");
  identification = make_identification();
  identification["motions"][1] = make_motion("b.csv", 0.02, 1);
  keep(identification);
  expect_refused("the motion 'b.csv' has no positions");
  identification.erase("fitted");
  keep(identification);
  expect_refused("'fitted' not found");
  FolderChecksums checksums(folder_.path());
  checksums.cover(kIdentificationFile);
  checksums.save();
  keep(make_identification());
  EXPECT_THAT(error_of(ErrorKind::bad_data, [&] { make_part(); }),
              HasSubstr("identification.json"));
}

}  // namespace
}  // namespace armwright
