// Logs as bags of ROS 2, in every format, and what damaged or unsuitable bags are refused for.
#include <gmock/gmock.h>

#include <fstream>
#include <limits>

#include "base/hash.hpp"
#include "base/text.hpp"
#include "problems/logs/bag_writer.hpp"
#include "problems/logs/log_motion.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::int64_t kStart_ns = 1'700'000'000'500'000'000;
constexpr std::int64_t kPeriod_ns = 4'000'000;
constexpr int kCount = 300;
constexpr const char* kNewDefinition =
    "std_msgs/Header header\nstring[] joint_names\n# set "
    "point\ntrajectory_msgs/JointTrajectoryPoint "
    "reference\ntrajectory_msgs/JointTrajectoryPoint feedback\n"
    "trajectory_msgs/JointTrajectoryPoint error\ntrajectory_msgs/JointTrajectoryPoint output\n"
    "string[] multi_dof_joint_names\n"
    "trajectory_msgs/MultiDOFJointTrajectoryPoint multi_dof_reference\n"
    "====\nMSG: trajectory_msgs/JointTrajectoryPoint\nfloat64[] positions\n";

double calc_effort(std::size_t joint, double t_s) {
  return 30 * kSwings[joint].acceleration(t_s) + 20 * kSwings[joint].position(t_s);
}

struct Sample {
  std::vector<double> positions, rates, efforts;
};

// In the order of the message's joints: lift, gripper, shoulder, elbow.
const std::vector<std::string> kNames = {"lift", "gripper", "shoulder", "elbow"};
Sample make_sample(double t_s) {
  Sample sample;
  for (const std::size_t j : {2, 0, 0, 1}) {
    sample.positions.push_back(kSwings[j].position(t_s));
    sample.rates.push_back(kSwings[j].rate(t_s));
    sample.efforts.push_back(calc_effort(j, t_s));
  }
  sample.positions[1] = 0.02;  // the gripper, which the robot does not have
  return sample;
}

struct StateOptions {
  bool is_big_endian = false;
  std::vector<std::string> names = kNames;
  bool has_stamps = true;
  bool has_rates = true;
  bool has_efforts = true;
};

std::vector<WrittenMessage> make_states(const StateOptions& options = {}) {
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < kCount; ++i) {
    const Sample sample = make_sample(i * kLogPeriod_s);
    CdrWriter writer(options.is_big_endian);
    writer.add_header(options.has_stamps ? kStart_ns + i * kPeriod_ns : 0);
    writer.add_names(options.names);
    writer.add_numbers(sample.positions);
    writer.add_numbers(options.has_rates ? sample.rates : std::vector<double>());
    writer.add_numbers(options.has_efforts ? sample.efforts : std::vector<double>());
    messages.push_back({0, kStart_ns + i * kPeriod_ns + 1'000'000, writer.message()});
  }
  return messages;
}

// With the efforts in the feedback, or in the output.
std::vector<WrittenMessage> make_controller_states(bool has_output, bool has_measured) {
  std::vector<WrittenMessage> messages;
  for (int i = 0; i < kCount; ++i) {
    const Sample sample = make_sample(i * kLogPeriod_s);
    const Sample wanted = make_sample((i + 2) * kLogPeriod_s);
    CdrWriter writer(false);
    writer.add_header(kStart_ns + i * kPeriod_ns);
    writer.add_names(kNames);
    writer.add_point(wanted.positions, wanted.rates, {});
    writer.add_point(sample.positions, sample.rates,
                     has_measured ? sample.efforts : std::vector<double>());
    writer.add_point({0, 0, 0, 0}, {0, 0, 0, 0}, {});
    if (has_output) {
      writer.add_point({}, {}, sample.efforts);
      writer.add_names({});
    }
    messages.push_back({0, kStart_ns + i * kPeriod_ns, writer.message()});
  }
  return messages;
}

const std::vector<WrittenTopic> kStateTopic = {
    {"/joint_states", "sensor_msgs/msg/JointState", "std_msgs/Header header\nstring[] name\n"}};
std::vector<WrittenTopic> make_controller_topic(const std::string& definition) {
  return {{"/arm/controller_state", "control_msgs/msg/JointTrajectoryControllerState", definition}};
}

void expect_states(const MotionLog& log) {
  ASSERT_EQ(log.sample_count(), static_cast<std::size_t>(kCount));
  for (int i = 0; i < kCount; i += 37) {
    EXPECT_NEAR(log.times_s[static_cast<std::size_t>(i)], i * kLogPeriod_s, 1e-12);
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(log.positions(i, j), kSwings[j].position(i * kLogPeriod_s));
      EXPECT_EQ(log.efforts(i, j), calc_effort(static_cast<std::size_t>(j), i * kLogPeriod_s));
    }
  }
}

MotionLog parse_bag(const std::string& content, const LogOptions& options = {}) {
  return parse_log(content, "bag", make_log_robot(), options);
}
std::string refuse_bag(const std::string& content, const LogOptions& options = {},
                       ErrorKind kind = ErrorKind::bad_data) {
  return error_of(kind, [&] { parse_bag(content, options); });
}

TEST(BagLog, McapIsReadWithEachCompression) {
  for (const char* compression : {"none", "", "lz4", "zstd"}) {
    SCOPED_TRACE(compression);
    const MotionLog log = parse_bag(make_mcap(kStateTopic, make_states(), compression));
    expect_states(log);
    EXPECT_EQ(log.velocities(1, 0), kSwings[0].rate(kLogPeriod_s));
    EXPECT_TRUE(log.notes.empty());
  }
}

TEST(BagLog, SqliteIsRead) {
  expect_states(parse_bag(make_sqlite_bag(kStateTopic, make_states())));
  expect_states(parse_bag(
      make_sqlite_bag(make_controller_topic(kNewDefinition), make_controller_states(true, true))));
}

TEST(BagLog, BothByteOrdersAreRead) {
  expect_states(parse_bag(make_mcap(kStateTopic, make_states({.is_big_endian = true}), "")));
}

TEST(BagLog, CompressedMessagesAndFilesAreRead) {
  auto messages = make_states();
  for (WrittenMessage& message : messages) {
    message.data = pack_zstd(message.data);
  }
  expect_states(parse_bag(make_sqlite_bag(kStateTopic, messages)));
  expect_states(parse_bag(pack_zstd(make_sqlite_bag(kStateTopic, make_states()))));
  expect_states(parse_bag(pack_zstd(make_mcap(kStateTopic, messages, "lz4"))));
}

TEST(BagLog, BothLayoutsOfAControllersStateAreRead) {
  const std::string old_definition =
      "std_msgs/Header header\nstring[] joint_names\ntrajectory_msgs/JointTrajectoryPoint desired\n"
      "trajectory_msgs/JointTrajectoryPoint actual\ntrajectory_msgs/JointTrajectoryPoint error # "
      "redundant\n";
  struct StateRow {
    bool is_new;
    std::string definition;
  };
  for (const StateRow& row : {StateRow{false, old_definition}, StateRow{true, kNewDefinition},
                              StateRow{false, ""}, StateRow{true, ""}}) {
    SCOPED_TRACE(row.definition);
    const MotionLog log = parse_bag(make_mcap(make_controller_topic(row.definition),
                                              make_controller_states(row.is_new, true), "zstd"));
    expect_states(log);
    EXPECT_EQ(log.references(0, 1), kSwings[1].position(2 * kLogPeriod_s));
  }
}

TEST(BagLog, EffortsOfTheControllerStandInForMeasuredOnes) {
  for (const std::string definition : {"", kNewDefinition}) {
    const std::string bag =
        make_mcap(make_controller_topic(definition), make_controller_states(true, false), "");
    const MotionLog log = parse_bag(bag);
    expect_states(log);
    EXPECT_THAT(log.notes,
                ElementsAre("'/arm/controller_state' has no measured efforts; efforts are those of "
                            "output.effort, which the controller asked for"));
    EXPECT_TRUE(parse_bag(bag, {.columns = {{"effort", "output.effort"}}}).notes.empty());
    EXPECT_EQ(refuse_bag(bag, {.columns = {{"effort", "feedback.effort"}}}),
              "bag: column 'feedback.effort of shoulder' has no finite number at all; efforts of "
              "every joint are needed; record them, or name another column by --column");
  }
}

TEST(BagLog, OptionsGiveFieldsMotorTorquesAndNames) {
  const std::string bag =
      make_mcap(kStateTopic, make_states({.names = {"j3", "g", "j1", "j2"}}), "");
  LogOptions options{.joints = {"j1", "j2", "j3"}};
  expect_states(parse_bag(bag, options));
  options.columns["motor_torque"] = "effort";
  options.gear_ratios = {{"1", 2}, {"elbow", 3}, {"j3", 4}};
  options.signs = {{"2", -1}};
  const MotionLog log = parse_bag(bag, options);
  EXPECT_EQ(log.efforts(5, 0), 2 * calc_effort(0, 5 * kLogPeriod_s));
  EXPECT_EQ(log.efforts(5, 1), -3 * calc_effort(1, 5 * kLogPeriod_s));
  EXPECT_EQ(refuse_bag(bag, {.columns = {{"effort", "torque"}}, .joints = options.joints},
                       ErrorKind::usage),
            "--column effort=torque: the messages of '/joint_states' have no such field; they have "
            "'position', 'velocity', 'effort'");
  EXPECT_EQ(
      refuse_bag(bag, {.columns = {{"effort_1", "effort"}}, .joints = options.joints},
                 ErrorKind::usage),
      "--column effort_1=effort: bag is a bag; there the names are position, velocity, effort, "
      "motor_torque and reference, for all joints together (--joints gives their names)");
}

TEST(BagLog, JointsMustBeThere) {
  EXPECT_EQ(
      refuse_bag(make_mcap(kStateTopic, make_states({.names = {"a", "b", "c", "d"}}), "")),
      "bag: the messages of '/joint_states' have the joints 'a', 'b', 'c', 'd', but the robot "
      "has 'shoulder', 'elbow', 'lift'; give the names of the robot's joints there, in the "
      "robot's order, by --joints NAME,NAME,...");
  EXPECT_EQ(refuse_bag(make_mcap(kStateTopic, make_states({.names = {"lift", "b", "c", "d"}}), "")),
            "bag, message 1 of '/joint_states': it lacks the joints 'shoulder', 'elbow'; it has "
            "'lift', 'b', 'c', 'd'; if the robot's joints have other names there, give them in the "
            "robot's order by --joints NAME,NAME,...");
}

TEST(BagLog, MessagesOfOtherPublishersAreLeftOut) {
  std::vector<WrittenMessage> messages = make_states();
  CdrWriter writer(false);
  writer.add_header(kStart_ns);
  writer.add_names({"gripper"});
  for (int i = 0; i < 3; ++i) {
    writer.add_numbers({0.1});
  }
  messages.insert(messages.begin() + 7, WrittenMessage{0, kStart_ns, writer.message()});
  const MotionLog log = parse_bag(make_mcap(kStateTopic, messages, ""));
  expect_states(log);
  EXPECT_THAT(log.notes,
              ElementsAre("1 of 301 messages of '/joint_states' have none of the robot's joints "
                          "and were left out"));
}

TEST(BagLog, TimesOfTheRecorderStandInForMissingStamps) {
  const MotionLog log =
      parse_bag(make_mcap(kStateTopic, make_states({.has_stamps = false}), "lz4"));
  expect_states(log);
  EXPECT_THAT(log.notes,
              ElementsAre("the headers of '/joint_states' have no time stamps; times are "
                          "those of the recorder"));
}

TEST(BagLog, ChecksNameTheMessage) {
  std::vector<WrittenMessage> messages = make_states({.has_rates = false});
  EXPECT_EQ(parse_bag(make_mcap(kStateTopic, messages, "")).velocities.size(), 0);
  messages.erase(messages.begin() + 100, messages.begin() + 140);
  EXPECT_THAT(
      refuse_bag(make_mcap(kStateTopic, messages, "")),
      HasSubstr("bag, message 101 of '/joint_states': column 'header.stamp' jumps from 0.396 "
                "s to 0.56 s, which is 41 periods of 4 ms"));
  EXPECT_THAT(refuse_bag(make_sqlite_bag(kStateTopic, make_states({.has_efforts = false}))),
              HasSubstr("bag: column 'effort of shoulder' has no finite number at all"));
}

TEST(BagLog, TheTopicMustBeClear) {
  std::vector<WrittenTopic> topics = kStateTopic;
  topics.push_back({"/camera", "sensor_msgs/msg/Image"});
  topics.push_back({"/sim/joint_states", "sensor_msgs/msg/JointState"});
  std::vector<WrittenMessage> messages = make_states();
  const std::string one = make_mcap(topics, messages, "");
  expect_states(parse_bag(one));
  expect_states(parse_bag(one, {.topic = "joint_states"}));
  EXPECT_EQ(
      refuse_bag(one, {.topic = "/states"}),
      "bag: there is no topic '/states' with messages of joints; possible types are "
      "sensor_msgs/msg/JointState and control_msgs/msg/JointTrajectoryControllerState; the bag "
      "has '/joint_states' (sensor_msgs/JointState, 300 messages), '/camera' "
      "(sensor_msgs/Image, 0 messages), '/sim/joint_states' (sensor_msgs/JointState, 0 "
      "messages)");
  messages.push_back({2, 0, messages[0].data});
  const std::string two = make_mcap(topics, messages, "");
  EXPECT_EQ(refuse_bag(two),
            "bag: 2 topics have messages of joints; choose one: --topic "
            "/joint_states, --topic /sim/joint_states");
  expect_states(parse_bag(two, {.topic = "/joint_states"}));
  EXPECT_THAT(refuse_bag(make_mcap({}, {}, "")), HasSubstr("the bag has no topic at all"));
  std::vector<WrittenTopic> encoded = kStateTopic;
  encoded[0].encoding = "json";
  EXPECT_EQ(refuse_bag(make_mcap(encoded, make_states(), "")),
            "bag: the messages of '/joint_states' are encoded as 'json'; only cdr is possible");
  EXPECT_EQ(
      refuse_bag(make_mcap(make_controller_topic("trajectory_msgs/JointTrajectoryPoint goal\n"),
                           make_controller_states(true, true), "")),
      "bag: the definition of '/arm/controller_state' in the bag has the points 'goal'; possible "
      "are "
      "desired, actual and error, or reference, feedback, error and output");
}

TEST(BagLog, DamagedMessagesAreNamed) {
  const auto refuse = [&](const std::string& data) {
    std::vector<WrittenMessage> messages = make_states();
    messages[41].data = data;
    return refuse_bag(make_mcap(kStateTopic, messages, ""));
  };
  const std::string good = make_states()[0].data;
  EXPECT_EQ(
      refuse("abc"),
      "bag, message 42 of '/joint_states': it has 3 bytes, which is no message in CDR (its topic "
      "has the type sensor_msgs/JointState)");
  EXPECT_EQ(
      refuse(std::string("\0\3\0\0abcd", 8)),
      "bag, message 42 of '/joint_states': it begins with the bytes 00 03; plain CDR begins with "
      "00 00 or 00 01 (its topic has the type sensor_msgs/JointState)");
  EXPECT_EQ(
      refuse(good.substr(0, 150)),
      "bag, message 42 of '/joint_states': its 150 bytes end within its fields; the message is "
      "cut off or of another type (its topic has the type sensor_msgs/JointState)");
  EXPECT_THAT(
      refuse(pack_zstd(good).substr(0, 60)),
      HasSubstr("bag, message 42 of '/joint_states': ends at byte 60, within a frame of zstd"));
  CdrWriter writer(false);
  writer.add_header(kStart_ns + 41 * kPeriod_ns);
  writer.add_names(kNames);
  writer.add_numbers({1, 2});
  writer.add_numbers({});
  writer.add_numbers({});
  EXPECT_EQ(refuse(writer.message()),
            "bag, message 42 of '/joint_states': it has 4 names and 2 values "
            "in position; they must be as many");
}

// The whole file at each of many lengths, and each of many bytes changed: it is read as it was, or
// refused.
TEST(BagLog, ATruncatedMcapIsRefusedAtEveryLength) {
  for (const char* compression : {"none", "zstd", "lz4"}) {
    const std::string bag = make_mcap(kStateTopic, make_states(), compression);
    for (std::size_t size = 9; size < bag.size(); size += 1 + bag.size() / 97) {
      const std::string message = refuse_bag(bag.substr(0, size));
      EXPECT_THAT(message, HasSubstr("bag: the file ")) << size;
    }
    EXPECT_THAT(
        refuse_bag(bag.substr(0, bag.size() - 500)),
        testing::MatchesRegex(
            "bag: the file ends at byte [0-9]+, within the record that begins at byte [0-9]+, "
            "or without a footer: the recording was not finished; the tool mcap repairs such "
            "files: mcap recover FILE -o REPAIRED"));
    EXPECT_THAT(refuse_bag(bag.substr(0, bag.size() - 3)),
                HasSubstr("with MCAP's mark; the file is damaged"));
  }
}

TEST(BagLog, DamagedChunksAreRefused) {
  std::string bag = make_mcap(kStateTopic, make_states(), "");
  bag[bag.size() / 2] = static_cast<char>(bag[bag.size() / 2] ^ 1);
  EXPECT_THAT(refuse_bag(bag), HasSubstr("is a chunk with a wrong checksum; the file is damaged"));
  for (const char* compression : {"zstd", "lz4"}) {
    std::string packed = make_mcap(kStateTopic, make_states(), compression);
    packed[packed.size() / 2] = static_cast<char>(packed[packed.size() / 2] ^ 0x10);
    EXPECT_THAT(refuse_bag(packed), testing::HasSubstr("bag: the record at byte "));
  }
  std::string unknown = make_mcap(kStateTopic, make_states(), "zstd");
  unknown.replace(unknown.find("zstd"), 4, "gzip");
  EXPECT_THAT(refuse_bag(unknown),
              HasSubstr("is compressed by 'gzip'; possible are zstd, lz4 and none"));
}

// A chunk of 100 bytes that claims to have a gibibyte.
TEST(BagLog, ClaimedSizesTakeNoMemory) {
  ByteWriter chunk;
  chunk.add(std::uint64_t{0});
  chunk.add(std::uint64_t{0});
  chunk.add(std::uint64_t{1} << 30);
  chunk.add(std::uint32_t{0});
  chunk.add_text("zstd");
  const std::string packed = pack_zstd("nothing");
  chunk.add(static_cast<std::uint64_t>(packed.size()));
  chunk.add_bytes(packed);
  const std::string header = std::string(kMcapMark) + make_record(1, std::string(8, '\0'));
  EXPECT_EQ(refuse_bag(header + make_record(6, chunk.text())),
            "bag: the record at byte 25 is a chunk of 7 bytes in place of 1073741824; the file is "
            "damaged");
  ByteWriter record;
  record.add(std::uint8_t{5});
  record.add(std::numeric_limits<std::uint64_t>::max());
  EXPECT_THAT(refuse_bag(header + record.text()), HasSubstr("bag: the file ends at byte 34"));
}

TEST(BagLog, ADamagedDatabaseIsRefused) {
  const std::string bag = make_sqlite_bag(kStateTopic, make_states());
  EXPECT_EQ(
      refuse_bag(bag.substr(0, 8192)),
      fmt::format("bag: the file ends at byte 8192, but its database has {} bytes: it was cut "
                  "off; copy or record it again",
                  bag.size()));
  EXPECT_THAT(refuse_bag(bag.substr(0, 50)), HasSubstr("bag: the file ends at byte 50, but"));
  std::string damaged = bag;
  damaged.replace(4096, 3000, 3000, '\xff');
  EXPECT_THAT(refuse_bag(damaged), HasSubstr("bag: SQLite cannot read it: "));
  std::string other = bag;
  for (std::size_t at = 0; (at = other.find("messages", at)) != std::string::npos; ++at) {
    other.replace(at, 8, "massages");
  }
  EXPECT_EQ(refuse_bag(other),
            "bag: is a database of SQLite without the tables 'topics' and "
            "'messages', so it is no bag of rosbag2");
}

TEST(BagLog, AFolderStandsForItsBag) {
  const TemporaryFolder folder;
  std::ofstream(folder / "metadata.yaml") << "rosbag2_bagfile_information:\n";
  std::ofstream(folder / "run_0.mcap", std::ios::binary)
      << make_mcap(kStateTopic, make_states(), "");
  const RobotModel robot = make_log_robot();
  const MotionLog log = read_log(folder.path(), robot);
  expect_states(log);
  EXPECT_EQ(log.sha256, calc_sha256_hex(make_mcap(kStateTopic, make_states(), "")));
  std::ofstream(folder / "run_1.db3.zstd") << "x";
  EXPECT_EQ(
      error_of(ErrorKind::bad_data, [&] { read_log(folder.path(), robot); }),
      folder.path().string() +
          ": this folder has 2 bag files (.mcap, .db3): 'run_0.mcap', 'run_1.db3.zstd'; a log is "
          "one file; give each file as a log of its own");
}

TEST(BagLog, MessagesBesideADatabaseAreNotForgotten) {
  const TemporaryFolder folder;
  std::ofstream(folder / "run.db3", std::ios::binary)
      << make_sqlite_bag(kStateTopic, make_states());
  const RobotModel robot = make_log_robot();
  std::ofstream(folder / "run.db3-wal") << "";
  expect_states(read_log(folder / "run.db3", robot));
  std::ofstream(folder / "run.db3-wal") << "messages";
  const std::string file = (folder / "run.db3").string();
  EXPECT_EQ(error_of(ErrorKind::bad_data, [&] { read_log(folder / "run.db3", robot); }),
            file +
                ": 'run.db3-wal' beside it has messages that the recorder did not store in the "
                "bag; store them: sqlite3 " +
                file + " 'PRAGMA wal_checkpoint(TRUNCATE)'");
}

}  // namespace
}  // namespace armwright
