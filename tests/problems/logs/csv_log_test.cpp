// Logs as CSV: which columns are taken, in which units, and what a file is refused for.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>

#include "base/temporary_folder.hpp"
#include "base/text.hpp"
#include "problems/logs/log_motion.hpp"

namespace armwright {
namespace {

using testing::HasSubstr;

void expect_motion(const MotionLog& log) {
  ASSERT_EQ(log.sample_count(), 1001u);
  ASSERT_EQ(log.positions.cols(), 3);
  ASSERT_EQ(log.efforts.rows(), 1001);
  // Twelve digits are written.
  for (Eigen::Index i = 0; i < 1001; i += 125) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double t_s = static_cast<double>(i) * kLogPeriod_s;
      const Swing& swing = kSwings[j];
      EXPECT_NEAR(log.positions(i, j), swing.position(t_s), 1e-11);
      EXPECT_NEAR(log.efforts(i, j), 30 * swing.acceleration(t_s) + 20 * swing.position(t_s), 1e-8);
    }
  }
}

TEST(CsvLog, OurOwnNamesNeedNoOption) {
  const MotionLog log = parse_table(make_log_table());
  expect_motion(log);
  EXPECT_EQ(log.name, "log.csv");
  EXPECT_NEAR(log.velocities(0, 1), kSwings[1].rate(0), 1e-11);
  EXPECT_EQ(log.link_positions.size(), 0);
  EXPECT_EQ(log.references.size(), 0);
  EXPECT_TRUE(log.notes.empty());
}

TEST(CsvLog, NamesOfJointsAreUnderstoodInManyForms) {
  LogTable table = make_log_table();
  table.rename("time_s", "Time [s]");
  table.rename("position_1_rad", "shoulder.position");
  table.rename("position_2_rad", "position_elbow_rad");
  table.rename("position_3_m", "lift/position (m)");
  table.rename("effort_1_n_m", "shoulder/effort");
  table.rename("effort_2_n_m", "\"Elbow Effort [Nm]\"");
  table.rename("effort_3_n", "effort_lift");
  expect_motion(parse_table(table));
}

TEST(CsvLog, UnitsInNamesAreConverted) {
  LogTable table = make_log_table();
  const double deg = 180 / std::numbers::pi;
  table.scale("position_1_rad", deg);
  table.rename("position_1_rad", "position_1_deg");
  table.scale("velocity_1_rad_per_s", deg);
  table.rename("velocity_1_rad_per_s", "velocity_1_deg_per_s");
  table.scale("position_3_m", 1000);
  table.rename("position_3_m", "position_3_mm");
  table.scale("time_s", 1000);
  table.rename("time_s", "time_ms");
  const MotionLog log = parse_table(table);
  expect_motion(log);
  EXPECT_NEAR(log.times_s.back(), 4, 1e-12);
}

TEST(CsvLog, OptionsGiveColumnsUnitsAndSigns) {
  LogTable table = make_log_table();
  const double deg = 180 / std::numbers::pi;
  for (const char* joint : {"1", "2"}) {
    const std::string name = fmt::format("position_{}_rad", joint);
    table.scale(name, deg);
    table.rename(name, fmt::format("q{}", joint));
    table.remove(fmt::format("velocity_{}_rad_per_s", joint));
  }
  table.rename("time_s", "stamp");
  table.scale("stamp", 1e6);
  table.scale("effort_2_n_m", -1);
  LogOptions options;
  set_log_option(options, "column", "position_1", "q1");
  set_log_option(options, "column", "position_elbow", "q2");
  set_log_option(options, "column", "time", "stamp");
  set_log_option(options, "unit", "position", "deg");
  set_log_option(options, "unit", "time", "us");
  set_log_option(options, "sign", "elbow", "-1");
  const MotionLog log = parse_table(table, options);
  expect_motion(log);
  EXPECT_TRUE(std::isnan(log.velocities(0, 0))) << "this joint has none";
  EXPECT_NEAR(log.velocities(0, 2), kSwings[2].rate(0), 1e-11);
}

TEST(CsvLog, OtherNamesOfJointsAreGivenInTheRobotsOrder) {
  LogTable table = make_log_table();
  table.rename("position_1_rad", "a1.position");
  table.rename("position_2_rad", "a2.position");
  table.rename("position_3_m", "a3.position");
  expect_motion(parse_table(table, {.joints = {"a1", "a2", "a3"}}));
  // Even if they are the robot's names of other joints.
  table.rename("a1.position", "elbow.position");
  table.rename("a2.position", "shoulder.position");
  expect_motion(parse_table(table, {.joints = {"elbow", "shoulder", "a3"}}));
  EXPECT_EQ(usage_error_of([&] {
              parse_table(table, {.joints = {"a1", "a2"}});
            }),
            "--joints has 2 names, but the robot has 3 joints: 'shoulder', 'elbow', 'lift'");
}

TEST(CsvLog, MotorTorquesNeedGearRatios) {
  LogTable table = make_log_table();
  table.scale("effort_1_n_m", -7.0 / 1798);
  table.rename("effort_1_n_m", "motor_torque_1_n_m");
  LogOptions options;
  set_log_option(options, "gear-ratio", "1", "1798/7");
  set_log_option(options, "sign", "1", "-1");
  expect_motion(parse_table(table, options));
  EXPECT_EQ(refuse_table(table),
            "log.csv:1: column 'motor_torque_1_n_m' has the torque of the motor of joint "
            "'shoulder'; the effort at the joint is this torque times the gear ratio, which is "
            "missing; give it by --gear-ratio 1=RATIO (motor angle per joint position)");
  table.rename("effort_3_n", "motor_torque_lift_n_m");
  set_log_option(options, "gear-ratio", "lift", "1");
  expect_motion(parse_table(table, options));
}

TEST(CsvLog, LinkPositionsAndReferencesAreOptional) {
  LogTable table = make_log_table();
  table.names.push_back("link_position_1_rad");
  table.columns.push_back(table.at("position_1_rad"));
  table.names.push_back("reference_2_rad");
  table.columns.push_back(table.at("position_2_rad"));
  const MotionLog log = parse_table(table);
  EXPECT_EQ(log.link_positions.col(0), log.positions.col(0));
  EXPECT_TRUE(std::isnan(log.link_positions(0, 1)));
  EXPECT_EQ(log.references.col(1), log.positions.col(1));
}

TEST(CsvLog, SeparatorsCommentsAndMarksOfOtherProgramsAreRead) {
  const LogTable table = make_log_table();
  const RobotModel robot = make_log_robot();
  expect_motion(parse_log(table.to_csv(';'), "log.csv", robot));
  expect_motion(parse_log("\xEF\xBB\xBF# recorded on Monday\n\n" + table.to_csv('\t') + "\n\n",
                          "log.csv", robot));
  std::string text;
  for (const char c : table.to_csv()) {
    text += c == '\n' ? "\r\n" : std::string(1, c);
  }
  expect_motion(parse_log(text, "log.csv", robot));
}

TEST(CsvLog, ColumnsThatNobodyNeedsMayHoldAnything) {
  LogTable table = make_log_table();
  std::string text = table.to_csv();
  std::string wide;
  for (const std::string& line : split(text, '\n')) {
    wide += line.empty() ? "" : line + (wide.empty() ? ",comment\n" : ",\"a, b\"\n");
  }
  expect_motion(parse_log(wide, "log.csv", make_log_robot()));
}

TEST(CsvLog, AMissingColumnIsNamedWithTheMappingToType) {
  LogTable table = make_log_table();
  table.rename("time_s", "t0");
  table.rename("position_1_rad", "q1[deg]");
  table.remove("effort_3_n");
  EXPECT_EQ(refuse_table(table),
            "log.csv:1: there is no column for 'time', 'position_1', 'effort_3'; the columns are "
            "'t0', 'q1[deg]', 'position_2_rad', 'position_3_m', 'velocity_1_rad_per_s', "
            "'velocity_2_rad_per_s', 'velocity_3_m_per_s', 'effort_1_n_m', 'effort_2_n_m'; say "
            "which is which by --column time=COLUMN --column position_1=COLUMN --column "
            "effort_3=COLUMN");
}

TEST(CsvLog, OptionsThatDoNotFitAreRefused) {
  const LogTable table = make_log_table();
  const auto refuse = [&](const LogOptions& options) {
    return usage_error_of([&] { parse_table(table, options); });
  };
  EXPECT_THAT(refuse({.columns = {{"position_1", "positon_1_rad"}}}),
              HasSubstr("log.csv:1: there is no column 'positon_1_rad', which --column position_1 "
                        "names; did you mean 'position_1_rad'?; the columns are 'time_s', "));
  EXPECT_EQ(
      refuse({.columns = {{"angle_1", "time_s"}}}),
      "--column: unknown name 'angle_1'; the names are time, position_N, velocity_N, effort_N, "
      "motor_torque_N, link_position_N and reference_N, where N is the number or the name of "
      "a joint (joints: 'shoulder', 'elbow', 'lift')");
  EXPECT_EQ(
      refuse({.columns = {{"position", "position_1_rad"}}}),
      "--column position=position_1_rad: log.csv:1 has a column per joint, so the name needs a "
      "joint, such as position_1");
  EXPECT_EQ(refuse({.columns = {{"position_1", "time_s"}, {"position_2", "time_s"}}}),
            "--column position_1=time_s: this column stands for something else already");
  EXPECT_EQ(refuse({.gear_ratios = {{"wrist", 3}}}),
            "--gear-ratio: the robot has no joint 'wrist'; its joints are 'shoulder', 'elbow', "
            "'lift', or 1 to 3");
  EXPECT_THAT(refuse({.signs = {{"4", 1}}}), HasSubstr("--sign: the robot has no joint '4'"));
  EXPECT_THAT(refuse({.units = {{"speed", "deg"}}}), HasSubstr("--unit: unknown name 'speed'"));
  EXPECT_EQ(refuse({.topic = "/joint_states"}),
            "--topic /joint_states: log.csv is a table and has no topics");
}

TEST(CsvLog, ValuesOfOptionsAreChecked) {
  LogOptions options;
  const auto refuse = [&](const char* option, const char* value) {
    return usage_error_of([&] { set_log_option(options, option, "1", value); });
  };
  EXPECT_EQ(refuse("unit", "grad"),
            "--unit 1=grad: 'grad' is not possible; units are rad, deg, m, mm, these per second "
            "(deg/s), N m, N, s, ms, us and ns");
  for (const char* ratio : {"0", "1/0", "x", "3/", "1e999"}) {
    EXPECT_EQ(
        refuse("gear-ratio", ratio),
        fmt::format("--gear-ratio 1={0}: '{0}' is not possible; a gear ratio is a number or a "
                    "fraction, such as 1798/7",
                    ratio));
  }
  EXPECT_EQ(refuse("sign", "2"), "--sign 1=2: '2' is not possible; a sign is 1 or -1");
}

TEST(CsvLog, UnitsMustFitTheJoint) {
  LogTable table = make_log_table();
  table.rename("position_1_rad", "position_1_mm");
  EXPECT_EQ(
      refuse_table(table),
      "log.csv:1: column 'position_1_mm' is in 'mm', but joint 'shoulder' turns; possible are "
      "rad, deg; say it by --unit position_1=UNIT");
  expect_motion(parse_table(table, {.units = {{"position_1", "rad"}}}));
  table = make_log_table();
  EXPECT_EQ(
      refuse_table(table, {.units = {{"time", "deg"}}}),
      "log.csv:1: column 'time_s' is in 'deg', which is no unit of time; possible are ns, us, "
      "ms, s; say it by --unit time=UNIT");
}

TEST(CsvLog, AmbiguousColumnsAreRefused) {
  LogTable table = make_log_table();
  table.rename("velocity_1_rad_per_s", "shoulder.position");
  EXPECT_EQ(refuse_table(table),
            "log.csv:1: the columns 'position_1_rad' and 'shoulder.position' both look like "
            "position_1; say which it is, for example by --column position_1=position_1_rad");
  expect_motion(parse_table(table, {.columns = {{"position_1", "position_1_rad"}}}));
  table = make_log_table();
  table.rename("velocity_1_rad_per_s", "time_ms");
  EXPECT_EQ(
      refuse_table(table),
      "log.csv:1: the columns 'time_s' and 'time_ms' both look like the time; say which it is, "
      "for example by --column time=time_s");
  expect_motion(parse_table(table, {.columns = {{"time", "time_s"}}}));
}

TEST(CsvLog, DamagedTextsAreRefusedWithTheLine) {
  const RobotModel robot = make_log_robot();
  const auto refuse = [&](const std::string& text) {
    return error_of(ErrorKind::bad_data, [&] { parse_log(text, "log.csv", robot); });
  };
  const std::string text = make_log_table().to_csv();
  const auto lines = split(text, '\n');
  const auto change = [&](std::size_t line, const std::string& content) {
    auto changed = lines;
    changed[line - 1] = content;
    return join(changed, "\n");
  };
  EXPECT_EQ(refuse(""),
            "log.csv: is empty; a log needs a line with the names of its columns and one "
            "line per sample");
  EXPECT_EQ(refuse(change(17, "")), "log.csv:17: the line is empty; remove it");
  EXPECT_EQ(refuse(change(17, "1,2,3")), "log.csv:17: there are 3 fields for 10 columns");
  EXPECT_EQ(
      refuse(text.substr(0, text.size() - 80)),
      "log.csv:1002: there are 5 fields for 10 columns; the file ends within this line, so the "
      "recording was cut off; remove the line or record again");
  EXPECT_EQ(refuse(change(17, "0,x,0,0,0,0,0,0,0,0")),
            "log.csv:17: column 'position_1_rad' is 'x', which is no number");
  std::string comma = text;
  std::ranges::replace(comma, ',', ';');
  std::ranges::replace(comma, '.', ',');
  EXPECT_THAT(refuse(comma), HasSubstr("which is no number; decimals need a point"));
  EXPECT_EQ(refuse(join(std::span(lines).subspan(1), "\n")),
            "log.csv:1: the first line has numbers; it must have the names of the columns, such as "
            "time_s,position_1_rad,effort_1_n_m");
  EXPECT_EQ(refuse(std::string("\0\1\2", 3)),
            "log.csv: is neither CSV nor a bag of ROS 2 (MCAP or sqlite3)");
  EXPECT_EQ(refuse("#ROSBAG V2.0\n"),
            "log.csv: is neither CSV nor a bag of ROS 2 (MCAP or sqlite3); it is a bag of ROS 1: "
            "convert it, for example by rosbags-convert");
}

TEST(CsvLog, FilesAreReadAndNamed) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.csv") << make_log_table().to_csv();
  const MotionLog log = read_log(folder / "a.csv", make_log_robot());
  expect_motion(log);
  EXPECT_EQ(log.name, (folder / "a.csv").string());
  EXPECT_THAT(error_of(ErrorKind::io, [&] { read_log(folder / "b.csv", make_log_robot()); }),
              HasSubstr("b.csv: cannot "));
  EXPECT_EQ(error_of(ErrorKind::bad_data, [&] { read_log(folder.path(), make_log_robot()); }),
            folder.path().string() +
                ": this folder has 0 bag files (.mcap, .db3); a log is one file; name the file");
}

}  // namespace
}  // namespace armwright
