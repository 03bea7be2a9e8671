// What a log is refused for although its file is whole: numbers that cannot be what they are taken
// for. Each test changes a good log in one way.
#include <gmock/gmock.h>

#include <limits>

#include "problems/logs/log_motion.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kDeg = 180 / std::numbers::pi;

TEST(LogCheck, ShortLogsAreRefused) {
  EXPECT_EQ(refuse_table(make_log_table(49)),
            "log.csv: has 49 samples; a log needs 50 or more, and a motion of some seconds");
  EXPECT_EQ(parse_table(make_log_table(50)).sample_count(), 50u);
}

TEST(LogCheck, TimesMustRise) {
  LogTable table = make_log_table();
  auto& times_s = table.at("time_s");
  times_s[100] = times_s[99];
  times_s[500] = times_s[490];
  EXPECT_EQ(refuse_table(table),
            "log.csv:102: column 'time_s' is 0.396 s after 0.396 s in the line before; times must "
            "rise (1 repeated and 1 backward in this log); remove these rows, or split the log "
            "there");
  times_s[100] = kNan;
  EXPECT_EQ(refuse_table(table),
            "log.csv:102: column 'time_s' has no finite number; each sample needs its time");
}

TEST(LogCheck, GapsAreRefused) {
  LogTable table = make_log_table();
  for (std::size_t i = 300; i < 1001; ++i) {
    table.at("time_s")[i] += 0.016;  // five periods of 4 ms are possible
  }
  EXPECT_NO_THROW(parse_table(table));
  for (std::size_t i = 300; i < 1001; ++i) {
    table.at("time_s")[i] += 0.1;
  }
  EXPECT_EQ(
      refuse_table(table),
      "log.csv:302: column 'time_s' jumps from 1.196 s to 1.316 s, which is 30 periods of 4 ms; "
      "gaps may have 5 periods (longer ones in this log: 1); split the log there and give both "
      "parts");
}

TEST(LogCheck, TimesInMillisecondsAreNoticed) {
  LogTable table = make_log_table();
  table.scale("time_s", 1000);
  EXPECT_EQ(
      refuse_table(table),
      "log.csv: samples are 4 s apart by column 'time_s'; at least 10 per second are needed; if "
      "its times are in milliseconds, say --unit time=ms");
  EXPECT_NO_THROW(parse_table(table, {.units = {{"time", "ms"}}}));
}

TEST(LogCheck, EachSampleNeedsFiniteNumbers) {
  LogTable table = make_log_table();
  table.at("position_2_rad")[10] = kNan;
  table.at("position_2_rad")[20] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(
      refuse_table(table),
      "log.csv:12: column 'position_2_rad' has no finite number (empty, NaN or infinite) in 2 "
      "rows, the last in line 22; each sample needs one; cut the log before and behind these "
      "rows");
  table.at("position_2_rad").assign(1001, kNan);
  EXPECT_EQ(
      refuse_table(table),
      "log.csv: column 'position_2_rad' has no finite number at all; positions of every joint "
      "are needed; record them, or name another column by --column");
  table = make_log_table();
  table.at("velocity_2_rad_per_s").assign(1001, kNan);
  const MotionLog log = parse_table(table);
  EXPECT_TRUE(std::isnan(log.velocities(5, 1)));
  EXPECT_THAT(log.notes, testing::ElementsAre(
                             "column 'velocity_2_rad_per_s' has no numbers and was left out"));
}

TEST(LogCheck, DegreesAreNotTakenForRadians) {
  LogTable table = make_log_table();
  table.scale("position_1_rad", kDeg);
  table.scale("position_2_rad", kDeg);
  EXPECT_EQ(
      refuse_table(table),
      "log.csv: the positions look like degrees: 'position_1_rad' goes from -45.84 to 57.3, and "
      "joint 'shoulder' from -2.5 to 2.5 rad; 'position_2_rad' goes from -17.19 to 63.03, and "
      "joint 'elbow' from -1 to 2 rad; radians are expected; say --unit position=deg");
  EXPECT_NO_THROW(parse_table(table, {.units = {{"position", "deg"}}}));
}

TEST(LogCheck, DegreesWithinTheRangeAreFoundByTheirRates) {
  LogTable table = make_log_table();
  table.scale("position_1_rad", kDeg / 50);
  table.scale("velocity_1_rad_per_s", 1 / 50.0);
  EXPECT_EQ(
      refuse_table(table),
      "log.csv: 'velocity_1_rad_per_s' and 'position_1_rad' do not match: the position changes "
      "57.3 times as fast as the velocity says; if the positions are in degrees, say --unit "
      "position_1=deg");
  table = make_log_table();
  table.scale("velocity_1_rad_per_s", kDeg);
  EXPECT_THAT(
      refuse_table(table),
      HasSubstr("0.0175 times as fast as the velocity says; if the velocities are in degrees "
                "per second, say --unit velocity_1=deg/s"));
  EXPECT_NO_THROW(parse_table(table, {.units = {{"velocity_1", "deg/s"}}}));
}

TEST(LogCheck, PositionsStayInTheJointsRange) {
  LogTable table = make_log_table();
  for (double& position : table.at("position_2_rad")) {
    position -= 1;
  }
  EXPECT_THAT(
      refuse_table(table),
      testing::MatchesRegex(
          "log.csv: 'position_2_rad' is -1.03. rad in line [0-9]+, and the range of joint "
          "'elbow' is -1 to 2 rad \\([0-9]+ samples are outside\\); other joints' columns, "
          "another zero or direction of the joint and degrees look like this; --column says which "
          "column is which, --unit position=deg that they are degrees"));
}

TEST(LogCheck, SwappedPositionsAreFoundByTheirRates) {
  LogTable table = make_log_table();
  std::swap(table.at("position_1_rad"), table.at("position_2_rad"));
  const std::string message = refuse_table(table);
  EXPECT_THAT(message,
              HasSubstr("log.csv: 2 things to mend:\n  'velocity_1_rad_per_s' and "
                        "'position_1_rad' do not match, but 'velocity_2_rad_per_s' has the "
                        "rates of this position: columns seem to be swapped; --column says "
                        "which column is which\n  'velocity_2_rad_per_s'"));
}

TEST(LogCheck, SwappedPositionsAreFoundByTheirReferences) {
  LogTable table = make_log_table();
  for (int joint = 1; joint <= 2; ++joint) {
    table.remove(fmt::format("velocity_{}_rad_per_s", joint));
    table.names.push_back(fmt::format("reference_{}_rad", joint));
    table.columns.push_back(table.at(fmt::format("position_{}_rad", joint)));
  }
  EXPECT_NO_THROW(parse_table(table));
  std::swap(table.at("position_1_rad"), table.at("position_2_rad"));
  EXPECT_THAT(refuse_table(table),
              HasSubstr("'position_1_rad' follows 'reference_2_rad' and not 'reference_1_rad': "
                        "columns seem to be swapped; --column says which column is which"));
}

TEST(LogCheck, AWrongSignOfARateIsNamed) {
  LogTable table = make_log_table();
  table.scale("velocity_3_m_per_s", -1);
  EXPECT_EQ(
      refuse_table(table),
      "log.csv: 'velocity_3_m_per_s' and 'position_3_m' do not match: the position changes -1 "
      "times as fast as the velocity says; one of them has the wrong sign; correct it in the "
      "file, or leave out the velocity");
}

TEST(LogCheck, RatesOfAnotherMotionAreRefused) {
  LogTable table = make_log_table();
  auto& rates = table.at("velocity_1_rad_per_s");
  for (std::size_t i = 0; i < rates.size(); ++i) {
    rates[i] = std::sin(0.031 * static_cast<double>(i));
  }
  EXPECT_THAT(refuse_table(table),
              testing::MatchesRegex(
                  "log.csv: 'velocity_1_rad_per_s' and 'position_1_rad' do not match: the rates of "
                  "the position have a correlation of -?0.[0-9]+ with the velocity; check whether "
                  "both belong to the same joint, or leave out the velocity"));
}

// A rate that the drive filters comes 15 ms late, and encoders count whole steps.
TEST(LogCheck, DelayedAndRoundedNumbersPass) {
  LogTable table = make_log_table();
  for (int j = 0; j < 2; ++j) {
    auto& rates = table.at(fmt::format("velocity_{}_rad_per_s", j + 1));
    auto& positions = table.at(fmt::format("position_{}_rad", j + 1));
    auto& efforts = table.at(fmt::format("effort_{}_n_m", j + 1));
    for (std::size_t i = 0; i < rates.size(); ++i) {
      rates[i] = kSwings[j].rate(static_cast<double>(i) * kLogPeriod_s - 0.015);
      positions[i] = std::round(positions[i] / 1e-4) * 1e-4;
      efforts[i] = std::round(efforts[i] / 5) * 5;  // stays at its extreme for a while
    }
  }
  EXPECT_NO_THROW(parse_table(table));
}

TEST(LogCheck, ClippedEffortsAreRefused) {
  LogTable table = make_log_table();
  for (double& effort : table.at("effort_2_n_m")) {
    effort = std::clamp(effort, -200.0, 260.0);
  }
  EXPECT_THAT(
      refuse_table(table),
      testing::MatchesRegex(
          "log.csv: 'effort_2_n_m' is exactly 260 in [0-9]+ samples, [0-9]+ of them from line "
          "[0-9]+ to line [0-9]+: it is clipped; such samples do not show the effort of the "
          "arm; record a slower motion, or with a wider range"));
}

TEST(LogCheck, AJointAtRestIsANoteAndARobotAtRestAnError) {
  LogTable table = make_log_table();
  table.at("position_2_rad").assign(1001, 0.5);
  table.at("velocity_2_rad_per_s").assign(1001, 0);
  table.at("effort_2_n_m").assign(1001, 40);
  EXPECT_THAT(parse_table(table).notes,
              testing::ElementsAre("joint 'elbow' rests: this log says little of it"));
  for (const char* name : {"position_1_rad", "position_3_m"}) {
    table.at(name).assign(1001, 0.3);
  }
  EXPECT_EQ(refuse_table(table),
            "log.csv: the robot rests: no joint moves by more than 0.002 rad (or m), by "
            "'position_1_rad' to 'position_3_m'; record a motion; `armwright excite` proposes one");
}

TEST(LogCheck, LinkPositionsAreNearTheMotors) {
  LogTable table = make_log_table();
  table.names.push_back("link_position_1_rad");
  table.columns.push_back(table.at("position_1_rad"));
  for (double& position : table.at("link_position_1_rad")) {
    position += 0.3;
  }
  EXPECT_THAT(refuse_table(table),
              testing::MatchesRegex(
                  "log.csv: 'link_position_1_rad' and 'position_1_rad' differ by 0.3 rad in line "
                  "[0-9]+; a gear yields by less than 0.02; the difference is nearly constant "
                  "\\(0.3\\), so the encoders have different zeros; subtract it in the file"));
  for (double& position : table.at("link_position_1_rad")) {
    position = 1.1 * (position - 0.3);
  }
  EXPECT_THAT(refuse_table(table),
              HasSubstr("check units, signs, and whether both belong to this joint"));
}

TEST(LogCheck, SeveralFaultsAreListedTogether) {
  LogTable table = make_log_table();
  table.scale("velocity_1_rad_per_s", -1);
  for (double& position : table.at("position_2_rad")) {
    position += 2;
  }
  EXPECT_THAT(refuse_table(table), HasSubstr("log.csv: 2 things to mend:\n  'position_2_rad' is "));
  EXPECT_THAT(refuse_table(table), HasSubstr("\n  'velocity_1_rad_per_s' and "));
}

}  // namespace
}  // namespace armwright
