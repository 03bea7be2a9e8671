// A recorded motion: what is read has finite numbers at rising times, and so have its samples. After
// "cdr:", the rest is the message of each sample: without the frame of a file, the fuzzer gets deeper.
#include <Eigen/Core>

#include "fuzz/harness.hpp"
#include "problems/logs/bag.hpp"
#include "problems/logs/bag_log.hpp"
#include "problems/logs/log_check.hpp"
#include "problems/logs/log_samples.hpp"

namespace armwright::fuzz {
namespace {

constexpr int kMessages = 60;

RobotModel make_two_joints() {
  RobotModel robot;
  robot.joints = {
      {.name = "a", .lower = -3, .upper = 3, .plant = {}},
      {.name = "b", .kind = JointKind::prismatic, .lower = -1, .upper = 1, .plant = {}}};
  robot.links.resize(2);
  return robot;
}

MotionLog read_any(std::string_view input, const RobotModel& robot) {
  const LogOptions options{.gear_ratios = {{"1", 100}, {"b", -3.5}}};
  constexpr std::string_view kMessage = "cdr:";
  if (!input.starts_with(kMessage)) {
    return parse_log(std::string(input), "log", robot, options);
  }
  input.remove_prefix(kMessage.size());
  const bool is_state = !input.starts_with('c');
  Bag bag;
  bag.file = "bag";
  bag.add_topic("/t", is_state ? kJointStateType : kControllerStateType, "cdr", "");
  for (int i = 0; i < kMessages; ++i) {
    bag.add_message(0, i * 4'000'000, input.substr(is_state ? 0 : 1));
  }
  return check_recording(read_bag_log(bag, LogColumns(robot, options)), robot);
}

}  // namespace

void fuzz_log(std::string_view input) {
  static const RobotModel robot = make_two_joints();
  MotionLog log;
  if (!is_read([&] { log = read_any(input, robot); })) {
    return;
  }
  const auto rows = static_cast<Eigen::Index>(log.sample_count());
  require(rows > 0 && log.positions.rows() == rows && log.positions.cols() == 2,
          "positions of other samples");
  require(log.efforts.rows() == rows && log.efforts.cols() == 2, "efforts of other samples");
  require(log.positions.allFinite() && log.efforts.allFinite(), "a sample that is no number");
  for (std::size_t i = 1; i < log.sample_count(); ++i) {
    require(log.times_s[i] > log.times_s[i - 1], "times that do not rise");
  }
  for (const std::string& note : log.notes) {
    check_message(note);
  }
  is_read([&] {
    const LogSamples samples = condition(log, {.cut_s = 0.05});
    require(samples.period_s > 0 && samples.times_s.size() == samples.accelerations.rows(),
            "samples without their times");
    for (const std::string& note : samples.notes) {
      check_message(note);
    }
  });
}

}  // namespace armwright::fuzz
