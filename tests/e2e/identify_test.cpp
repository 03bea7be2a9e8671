// armwright identify: what it says of recordings that cannot be fitted, and that neither a kill nor the number of threads
// changes the plant that it finds.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <ranges>
#include <sstream>
#include <thread>

#include "base/temporary_folder.hpp"
#include "e2e/program.hpp"

namespace armwright {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

// A recording as text: the names of its columns, and rows of fields.
struct Recording {
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> rows;

  static std::vector<std::string> split_line(const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream text(line);
    for (std::string field; std::getline(text, field, ',');) {
      fields.push_back(field);
    }
    return fields;
  }
  static Recording read() {
    std::istringstream text(
        read_text(std::string(ARMWRIGHT_CONFIGS) + "/logs/kr300/trajectory-A.csv"));
    Recording all;
    std::string line;
    std::getline(text, line);
    all.names = split_line(line);
    while (std::getline(text, line)) {
      all.rows.push_back(split_line(line));
    }
    return all;
  }
  std::size_t find(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  }
  void change(const std::string& name, const std::function<double(double)>& function) {
    const std::size_t column = find(name);
    for (auto& row : rows) {
      row.at(column) = std::to_string(function(std::stod(row.at(column))));
    }
  }
  void swap(const std::string& one, const std::string& other) {
    for (auto& row : rows) {
      row.at(find(one)).swap(row.at(find(other)));
    }
  }
  void write(const std::filesystem::path& file) const {
    std::ofstream out(file);
    const auto put = [&](const std::vector<std::string>& fields) {
      for (std::size_t i = 0; i < fields.size(); ++i) {
        out << (i == 0 ? "" : ",") << fields[i];
      }
      out << '\n';
    };
    put(names);
    std::ranges::for_each(rows, put);
  }
};

Outcome identify(const TemporaryFolder& folder, const std::string& log) {
  return run_program(folder.path(),
                     {"identify", log, "--robot", "kr300", "--quiet", "--payload", "200"});
}

// The command refuses the log with these words behind the log's name, and leaves nothing.
void expect_refusal(const TemporaryFolder& folder, const std::string& log,
                    const std::vector<std::string>& words) {
  const Outcome refused = identify(folder, log);
  EXPECT_EQ(refused.exit_code, 4) << refused.err;
  EXPECT_THAT(refused.err, StartsWith("armwright: error: " + (folder / log).string() + ":"));
  for (const std::string& word : words) {
    EXPECT_THAT(refused.err, HasSubstr(word));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "results"));
}

struct BadLog {
  const char* name;
  std::function<void(Recording&)> spoil;
  std::vector<std::string> words;
};

void PrintTo(const BadLog& log, std::ostream* out) {
  *out << log.name;
}

class IdentifyRefuses : public testing::TestWithParam<BadLog> {};

TEST_P(IdentifyRefuses, ABadLogWithTheColumnTheRowsAndTheOption) {
  const TemporaryFolder folder;
  Recording recording = Recording::read();
  GetParam().spoil(recording);
  recording.write(folder / "log.csv");
  expect_refusal(folder, "log.csv", GetParam().words);
}

const BadLog kBadLogs[] = {
    {"gap",
     [](Recording& log) { log.rows.erase(log.rows.begin() + 100, log.rows.begin() + 130); },
     {"csv:102: column 'time_s' jumps from 0.396 s to 0.52 s", "split the log there"}},
    {"backward_time",
     [](Recording& log) { std::swap(log.rows[100], log.rows[101]); },
     {"csv:103: column 'time_s' is 0.4 s after 0.404 s in the line before", "remove these rows"}},
    {"degrees",
     [](Recording& log) { log.change("position_4_rad", [](double q) { return q * 57.29578; }); },
     {"look like degrees: 'position_4_rad' goes from -56.6 to 0.69", "say --unit position=deg"}},
    {"swapped_positions",
     [](Recording& log) { log.swap("position_1_rad", "position_2_rad"); },
     {"'velocity_1_rad_per_s' and 'position_1_rad' do not match, but 'velocity_2_rad_per_s' has",
      "columns seem to be swapped; --column says which column is which"}},
    {"swapped_torques",
     [](Recording& log) { log.swap("motor_torque_1_n_m", "motor_torque_2_n_m"); },
     {"the efforts of joints 'joint_1' and 'joint_2' are swapped",
      "name their columns with --column"}},
    {"opposite_torque",
     [](Recording& log) { log.change("motor_torque_2_n_m", std::negate<>()); },
     {"the efforts of joint 'joint_2' have the opposite sign", "give --sign joint_2=-1"}},
    {"clipped_torque",
     [](Recording& log) {
       log.change("motor_torque_2_n_m", [](double u) { return std::clamp(u, -6.0, 6.0); });
     },
     {"'motor_torque_2_n_m' is exactly -6 in", "from line 1487 to line 2502: it is clipped",
      "record a slower motion"}},
    {"rest",
     [](Recording& log) {
       for (std::size_t i = 1; i < log.names.size(); ++i) {
         log.change(log.names[i], [](double) { return 0.1; });
       }
     },
     {"the robot rests: no joint moves by more than 0.002 rad", "`armwright excite` proposes one"}},
};

INSTANTIATE_TEST_SUITE_P(Logs, IdentifyRefuses, testing::ValuesIn(kBadLogs),
                         [](const auto& test) { return test.param.name; });

// A bag whose recording was not finished, and one without a topic.
TEST(Identify, RefusesATruncatedBagAndOneWithoutTheTopic) {
  const std::string mark("\x89MCAP0\r\n", 8);
  const auto make_record = [](char kind, const std::string& content) {
    std::string size(8, '\0');
    size[0] = static_cast<char>(content.size());
    return kind + size + content;
  };
  const std::string header = make_record(1, std::string(8, '\0'));
  const TemporaryFolder folder;
  std::ofstream(folder / "truncated.mcap") << mark << header.substr(0, header.size() - 2);
  expect_refusal(folder, "truncated.mcap",
                 {"ends at byte 23, within the record that begins at byte 8", "mcap recover FILE"});
  std::ofstream(folder / "empty.mcap") << mark << header << make_record(15, std::string(4, '\0'))
                                       << make_record(2, std::string(20, '\0')) << mark;
  expect_refusal(folder, "empty.mcap", {"the bag has no topic at all"});
}

TEST(Identify, NeedsARobotAndFitsFrictionAndArmatureOfIt) {
  const TemporaryFolder folder;
  Recording::read().write(folder / "log.csv");
  const Outcome refused = run_program(folder.path(), {"identify", "log.csv"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--robot is required: the URDF or MJCF file of the robot"));
  const Outcome fitted =
      run_program(folder.path(), {"identify", "log.csv", "--robot", "kr300", "--quiet"});
  ASSERT_EQ(fitted.exit_code, 0) << fitted.err;
  EXPECT_THAT(fitted.out, AllOf(HasSubstr("\njoint_6.coulomb"), HasSubstr("\njoint_6.armature"),
                                HasSubstr("\nFitted: log.csv\n")));
  EXPECT_THAT(fitted.out, testing::Not(testing::AnyOf(HasSubstr("payload"), HasSubstr("breakaway"),
                                                      HasSubstr("Held back"))));
}

// The optimizer is one that asks for many sets of parameters, so that there is something to kill.
TEST(Identify, ComesToTheSamePlantAfterAKillAndOnAnyNumberOfThreads) {
  const TemporaryFolder folder;
  Recording::read().write(folder / "log.csv");
  const auto make = [](const std::string& out, const std::string& jobs) {
    return std::vector<std::string>{"identify", "log.csv",  "--robot", "kr300",  "--optimizer",
                                    "cmaes",    "--budget", "300",     "--jobs", jobs,
                                    "--out",    out,        "--quiet"};
  };
  ASSERT_EQ(run_program(folder.path(), make("whole", "1")).exit_code, 0);
  {
    Program program(folder.path(), make("killed", "2"));
    constexpr std::size_t kSomeRecords_bytes = 20000;  // of about 110000
    const std::filesystem::path journal = folder / "killed" / "journal";
    const auto has_some = [&] {
      return exists(journal) && file_size(journal) >= kSomeRecords_bytes;
    };
    while (!has_some() && program.is_running()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    program.send(SIGKILL);
    ASSERT_EQ(program.wait().exit_code, -SIGKILL);
  }
  ASSERT_FALSE(std::filesystem::exists(folder / "killed" / "plant.toml"));
  const Outcome last = run_program(folder.path(), make("killed", "2"));
  EXPECT_EQ(last.exit_code, 0) << last.err;
  for (const char* file : {"plant.toml", "identification.json", "result.json"}) {
    EXPECT_EQ(read_text(folder / "whole" / file), read_text(folder / "killed" / file)) << file;
  }
}

}  // namespace
}  // namespace armwright
