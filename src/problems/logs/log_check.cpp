#include "problems/logs/log_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "problems/logs/motion_faults.hpp"

namespace armwright {
namespace {

constexpr std::size_t kFewestSamples = 50;
constexpr double kLongestGap_periods = 5;
constexpr double kLongestPeriod_s = 0.1;
[[noreturn]] void refuse_log(const std::string& message) {
  throw Error(ErrorKind::bad_data, message);
}

double calc_median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Checks the times and returns the median of the periods.
double check_times(const Recording& recording) {
  const std::vector<double>& times_s = recording.times_s;
  const std::string column = quote_name(recording.time_name);
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    if (!std::isfinite(times_s[i])) {
      refuse_log(fmt::format("{}: column {} has no finite number; each sample needs its time",
                             recording.locate(i), column));
    }
  }
  if (times_s.size() < kFewestSamples) {
    refuse_log(
        fmt::format("{}: has {} samples; a log needs {} or more, and a motion of some seconds",
                    recording.file, times_s.size(), kFewestSamples));
  }
  std::vector<double> periods_s;
  std::optional<std::size_t> first;
  std::size_t repeated = 0, backward = 0;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    const double period_s = times_s[i] - times_s[i - 1];
    repeated += period_s == 0 ? 1 : 0;
    backward += period_s < 0 ? 1 : 0;
    if (period_s > 0) {
      periods_s.push_back(period_s);
    } else if (!first) {
      first = i;
    }
  }
  if (first) {
    refuse_log(fmt::format(
        "{}: column {} is {:.9g} s after {:.9g} s in the {} before; times must rise ({} repeated "
        "and {} backward in this log); remove these rows, or split the log there",
        recording.locate(*first), column, times_s[*first], times_s[*first - 1],
        recording.topic.empty() ? "line" : "message", repeated, backward));
  }
  const double period_s = calc_median(periods_s);
  if (period_s > kLongestPeriod_s) {
    refuse_log(fmt::format(
        "{}: samples are {} apart by column {}; at least {:g} per second are needed; if its times "
        "are in milliseconds, say --unit time=ms",
        recording.file, describe_number(period_s, "s"), column, 1 / kLongestPeriod_s));
  }
  std::size_t gaps = 0;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    if (times_s[i] - times_s[i - 1] > kLongestGap_periods * period_s) {
      ++gaps;
      first = first ? first : i;
    }
  }
  if (first) {
    const double gap_s = times_s[*first] - times_s[*first - 1];
    refuse_log(fmt::format(
        "{}: column {} jumps from {:.9g} s to {:.9g} s, which is {:.3g} periods of {}; gaps may "
        "have "
        "{:g} periods (longer ones in this log: {}); split the log there and give both parts",
        recording.locate(*first), column, times_s[*first - 1], times_s[*first], gap_s / period_s,
        describe_number(1e3 * period_s, "ms"), kLongestGap_periods, gaps));
  }
  return period_s;
}

// Leaves out optional columns without any number and refuses all others that lack one.
void check_numbers(Recording& recording) {
  std::erase_if(recording.columns, [&](const RecordedColumn& column) {
    const bool is_needed =
        column.quantity == LogQuantity::position || column.quantity == LogQuantity::effort;
    const bool is_empty =
        std::ranges::none_of(column.values, [](double value) { return std::isfinite(value); });
    if (!is_needed && is_empty) {
      recording.notes.push_back(
          fmt::format("column {} has no numbers and was left out", quote_name(column.name)));
    }
    return !is_needed && is_empty;
  });
  for (const RecordedColumn& column : recording.columns) {
    std::size_t bad = 0, first = 0, last = 0;
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      if (!std::isfinite(column.values[i])) {
        first = bad == 0 ? i : first;
        last = i;
        ++bad;
      }
    }
    if (bad == column.values.size() && bad > 0) {
      refuse_log(
          fmt::format("{}: column {} has no finite number at all; {} of every joint are "
                      "needed; record them, or name another column by --column",
                      recording.file, quote_name(column.name),
                      column.quantity == LogQuantity::effort ? "efforts" : "positions"));
    }
    if (bad > 0) {
      refuse_log(fmt::format(
          "{}: column {} has no finite number (empty, NaN or infinite) in {} rows, the last in {}; "
          "each sample needs one; cut the log before and behind these rows",
          recording.locate(first), quote_name(column.name), bad, recording.name_row(last)));
    }
  }
}

MotionLog make_log(Recording& recording, const RobotModel& robot) {
  MotionLog log;
  log.name = recording.file;
  log.times_s = recording.times_s;
  log.notes = recording.notes;
  const auto rows = static_cast<Eigen::Index>(log.times_s.size());
  const auto joints = static_cast<Eigen::Index>(robot.joint_count());
  log.effort_factors.setOnes(joints);
  for (RecordedColumn& column : recording.columns) {
    Eigen::MatrixXd* const goals[] = {&log.positions, &log.velocities, &log.efforts,
                                      &log.link_positions, &log.references};
    Eigen::MatrixXd& goal = *goals[static_cast<std::size_t>(column.quantity)];
    if (goal.size() == 0) {
      goal.setConstant(rows, joints, std::numeric_limits<double>::quiet_NaN());
    }
    if (column.quantity == LogQuantity::effort) {
      log.effort_factors[column.joint] = column.factor;
    }
    goal.col(column.joint) = Eigen::Map<const Eigen::VectorXd>(column.values.data(), rows);
    column.values = {};  // their names are still needed
  }
  return log;
}

}  // namespace

MotionLog check_recording(Recording recording, const RobotModel& robot) {
  const double period_s = check_times(recording);
  check_numbers(recording);
  MotionLog log = make_log(recording, robot);
  const std::vector<std::string> faults = find_motion_faults(recording, robot, log, period_s);
  if (faults.size() == 1) {
    refuse_log(fmt::format("{}: {}", recording.file, faults.front()));
  }
  if (!faults.empty()) {
    refuse_log(fmt::format("{}: {} things to mend:\n  {}", recording.file, faults.size(),
                           join(faults, "\n  ")));
  }
  return log;
}

}  // namespace armwright
