#include "problems/logs/log_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::size_t kFewestSamples = 50;
constexpr double kLongestGap_periods = 5;
constexpr double kLongestPeriod_s = 0.1;
// Of what a joint at rest shows: noise of an encoder, and a controller that holds the joint.
constexpr double kRest = 2e-3;  // rad or m
// How far beyond its range a joint may be: overshoot, and rounded limits in robot files.
constexpr double kBeyondRange = 0.03;  // rad or m
constexpr double kDegPerRad = 180 / std::numbers::pi;
// A gear that carries its effort limit twists by a few mrad; 0.02 rad is a degree.
constexpr double kMostDeflection = 0.02;  // rad or m

struct Checked {
  const Recording& recording;
  const RobotModel& robot;
  MotionLog& log;
  double period_s;
  std::vector<std::string> faults;
};

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
        "{:g} periods ({} longer ones in this log); split the log there and give both parts",
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
  for (RecordedColumn& column : recording.columns) {
    Eigen::MatrixXd* const goals[] = {&log.positions, &log.velocities, &log.efforts,
                                      &log.link_positions, &log.references};
    Eigen::MatrixXd& goal = *goals[static_cast<std::size_t>(column.quantity)];
    if (goal.size() == 0) {
      goal.setConstant(rows, joints, std::numeric_limits<double>::quiet_NaN());
    }
    goal.col(column.joint) = Eigen::Map<const Eigen::VectorXd>(column.values.data(), rows);
    column.values = {};  // their names are still needed
  }
  return log;
}

std::string quote_column(const Checked& checked, LogQuantity quantity, Eigen::Index joint) {
  for (const RecordedColumn& column : checked.recording.columns) {
    if (column.quantity == quantity && column.joint == joint) {
      return quote_name(column.name);
    }
  }
  return fmt::format("{}_{}", kQuantityNames[static_cast<std::size_t>(quantity)], joint + 1);
}

const Joint& get_joint(const Checked& checked, Eigen::Index joint) {
  return checked.robot.joints[static_cast<std::size_t>(joint)];
}

const char* get_unit(const Checked& checked, Eigen::Index joint) {
  return get_joint(checked, joint).kind == JointKind::revolute ? "rad" : "m";
}

// Finds positions that are in degrees. Returns whether there are any: other checks of positions then
// say nothing new.
bool find_degrees(Checked& checked) {
  std::vector<std::string> found;
  for (Eigen::Index j = 0; j < checked.log.positions.cols(); ++j) {
    const Joint& joint = get_joint(checked, j);
    const double low = checked.log.positions.col(j).minCoeff();
    const double high = checked.log.positions.col(j).maxCoeff();
    const bool is_beyond = high > joint.upper + kBeyondRange || low < joint.lower - kBeyondRange;
    const bool fits_as_degrees = high / kDegPerRad <= joint.upper + kBeyondRange &&
                                 low / kDegPerRad >= joint.lower - kBeyondRange;
    // A wrong zero or a wrong joint leads out of the range, too, but hardly by more than a turn.
    constexpr double kTurn_rad = 7;
    if (joint.kind == JointKind::revolute && is_beyond && fits_as_degrees &&
        std::max(high, -low) > kTurn_rad) {
      found.push_back(
          fmt::format("{} goes from {:.4g} to {:.4g}, and joint {} from {:.4g} to {:.4g} "
                      "rad",
                      quote_column(checked, LogQuantity::position, j), low, high,
                      quote_name(joint.name), joint.lower, joint.upper));
    }
  }
  if (!found.empty()) {
    checked.faults.push_back(fmt::format(
        "the positions look like degrees: {}; radians are expected; say --unit position=deg",
        join(found, "; ")));
  }
  return !found.empty();
}

void check_ranges(Checked& checked) {
  for (Eigen::Index j = 0; j < checked.log.positions.cols(); ++j) {
    const Joint& joint = get_joint(checked, j);
    const auto column = checked.log.positions.col(j);
    const auto outside =
        (column.array() > joint.upper + kBeyondRange || column.array() < joint.lower - kBeyondRange)
            .eval();
    if (!outside.any()) {
      continue;
    }
    Eigen::Index first = 0;
    outside.cast<int>().maxCoeff(&first);
    checked.faults.push_back(fmt::format(
        "{} is {:.4g} {} in {}, and the range of joint {} is {:.4g} to {:.4g} {} ({} samples are "
        "outside); columns of other joints, another zero or another direction of the joint look "
        "like this; --column says which column is which, --joints which joint",
        quote_column(checked, LogQuantity::position, j), column[first], get_unit(checked, j),
        checked.recording.name_row(static_cast<std::size_t>(first)), quote_name(joint.name),
        joint.lower, joint.upper, get_unit(checked, j), outside.count()));
  }
}

// The changes of a quantity over windows of about 0.1 s, over which noise and delays count little.
class Changes {
 public:
  explicit Changes(const Checked& checked)
      : times_s_(checked.log.times_s),
        window_(static_cast<std::size_t>(
            std::clamp(0.1 / checked.period_s, 4.0, static_cast<double>(times_s_.size()) / 5))) {}

  Eigen::VectorXd calc(const Eigen::MatrixXd& values, Eigen::Index joint) const {
    return make([&](Eigen::Index from, Eigen::Index to) {
      return values(to, joint) - values(from, joint);
    });
  }
  // Of a position whose rates these are.
  Eigen::VectorXd integrate(const Eigen::MatrixXd& rates, Eigen::Index joint) const {
    return make([&](Eigen::Index from, Eigen::Index to) {
      double sum = 0;
      for (Eigen::Index i = from; i < to; ++i) {
        const auto at = static_cast<std::size_t>(i);
        sum += (times_s_[at + 1] - times_s_[at]) * (rates(i, joint) + rates(i + 1, joint)) / 2;
      }
      return sum;
    });
  }

 private:
  template <typename Calc>
  Eigen::VectorXd make(const Calc& calc) const {
    const std::size_t count = (times_s_.size() - 1) / window_;
    Eigen::VectorXd changes(static_cast<Eigen::Index>(count));
    for (std::size_t i = 0; i < count; ++i) {
      changes[static_cast<Eigen::Index>(i)] = calc(static_cast<Eigen::Index>(i * window_),
                                                   static_cast<Eigen::Index>((i + 1) * window_));
    }
    return changes;
  }

  const std::vector<double>& times_s_;
  std::size_t window_;
};

// Returns the correlation about zero; 0 if one of them rests.
double calc_match(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  const double size = a.norm() * b.norm();
  return size > 0 ? a.dot(b) / size : 0;
}

constexpr double kMatch = 0.9;  // a correlation of the same motion; delays of 20 ms cost little
constexpr double kNoMatch = 0.7;

// Returns the other joint whose `changes` match; nothing if none does.
std::optional<Eigen::Index> find_match(const Eigen::VectorXd& own,
                                       const std::vector<Eigen::VectorXd>& changes,
                                       Eigen::Index joint) {
  for (std::size_t k = 0; k < changes.size(); ++k) {
    if (static_cast<Eigen::Index>(k) != joint && changes[k].size() > 0 &&
        std::abs(calc_match(own, changes[k])) > kMatch) {
      return static_cast<Eigen::Index>(k);
    }
  }
  return std::nullopt;
}

std::string describe_factor(double factor, Eigen::Index joint) {
  const auto is_near = [&](double value) { return std::abs(factor / value - 1) < 0.1; };
  if (is_near(kDegPerRad)) {
    return fmt::format("if the positions are in degrees, say --unit position_{}=deg", joint + 1);
  }
  if (is_near(1 / kDegPerRad)) {
    return fmt::format("if the velocities are in degrees per second, say --unit velocity_{}=deg/s",
                       joint + 1);
  }
  if (is_near(-1)) {
    return "one of them has the wrong sign; correct it in the file, or leave out the velocity";
  }
  return "check their units, and whether both are at the joint's side of the gear";
}

void check_rates(Checked& checked) {
  const MotionLog& log = checked.log;
  if (log.velocities.size() == 0) {
    return;
  }
  const Changes window(checked);
  const Eigen::Index joints = log.positions.cols();
  std::vector<Eigen::VectorXd> integrated(static_cast<std::size_t>(joints));
  for (Eigen::Index j = 0; j < joints; ++j) {
    if (std::isfinite(log.velocities(0, j))) {
      integrated[static_cast<std::size_t>(j)] = window.integrate(log.velocities, j);
    }
  }
  for (Eigen::Index j = 0; j < joints; ++j) {
    const Eigen::VectorXd& expected = integrated[static_cast<std::size_t>(j)];
    if (expected.size() == 0) {
      continue;
    }
    const Eigen::VectorXd moved = window.calc(log.positions, j);
    const double rms_moved = std::sqrt(moved.squaredNorm() / static_cast<double>(moved.size()));
    const double rms_expected =
        std::sqrt(expected.squaredNorm() / static_cast<double>(moved.size()));
    if (std::max(rms_moved, rms_expected) < kRest) {
      continue;
    }
    const double match = calc_match(moved, expected);
    const double factor = moved.dot(expected) / std::max(expected.squaredNorm(), 1e-300);
    constexpr double kMostFactor = 1.25;
    const std::string names =
        fmt::format("{} and {}", quote_column(checked, LogQuantity::velocity, j),
                    quote_column(checked, LogQuantity::position, j));
    if (match > kNoMatch && factor > 1 / kMostFactor && factor < kMostFactor) {
      continue;
    }
    if (std::abs(match) > kMatch) {
      checked.faults.push_back(
          fmt::format("{} do not match: the position changes {:.3g} times as "
                      "fast as the velocity says; {}",
                      names, factor, describe_factor(factor, j)));
      continue;
    }
    const auto other = find_match(moved, integrated, j);
    checked.faults.push_back(
        other
            ? fmt::format("{} do not match, but {} has the rates of this position: columns seem to "
                          "be swapped; --column says which column is which",
                          names, quote_column(checked, LogQuantity::velocity, *other))
            : fmt::format("{} do not match: the rates of the position have a correlation of {:.2f} "
                          "with the velocity; check whether both belong to the same joint, or "
                          "leave out the velocity",
                          names, match));
  }
}

// A reference may differ from the position, but it does not follow another joint's.
void check_references(Checked& checked) {
  const MotionLog& log = checked.log;
  if (log.references.size() == 0) {
    return;
  }
  const Changes window(checked);
  const Eigen::Index joints = log.positions.cols();
  std::vector<Eigen::VectorXd> wanted(static_cast<std::size_t>(joints));
  for (Eigen::Index j = 0; j < joints; ++j) {
    if (std::isfinite(log.references(0, j))) {
      wanted[static_cast<std::size_t>(j)] = window.calc(log.references, j);
    }
  }
  for (Eigen::Index j = 0; j < joints; ++j) {
    const Eigen::VectorXd moved = window.calc(log.positions, j);
    const Eigen::VectorXd& own = wanted[static_cast<std::size_t>(j)];
    const bool moves = moved.norm() > kRest * std::sqrt(static_cast<double>(moved.size()));
    const auto other = find_match(moved, wanted, j);
    if (own.size() > 0 && moves && other && std::abs(calc_match(moved, own)) < kNoMatch) {
      checked.faults.push_back(
          fmt::format("{} follows {} and not {}: columns seem to be swapped; --column says which "
                      "column is which",
                      quote_column(checked, LogQuantity::position, j),
                      quote_column(checked, LogQuantity::reference, *other),
                      quote_column(checked, LogQuantity::reference, j)));
    }
  }
}

// A drive or a recorder that cuts efforts off gives many equal samples at the extreme value, which
// the effort enters or leaves by more than the step of its numbers.
void check_clipping(Checked& checked, const std::vector<bool>& rests) {
  constexpr Eigen::Index kFewestEqual = 8;
  constexpr double kShortest_s = 0.02;
  const double rows_at_least =
      std::min(kShortest_s / checked.period_s, static_cast<double>(checked.log.times_s.size()));
  const auto fewest = std::max(kFewestEqual, static_cast<Eigen::Index>(rows_at_least));
  for (Eigen::Index j = 0; j < checked.log.efforts.cols(); ++j) {
    if (rests[static_cast<std::size_t>(j)]) {
      continue;
    }
    const auto column = checked.log.efforts.col(j);
    const Eigen::Index rows = column.size();
    double step = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 1; i < rows; ++i) {
      const double change = std::abs(column[i] - column[i - 1]);
      step = change > 0 ? std::min(step, change) : step;
    }
    for (const double extreme : {column.maxCoeff(), column.minCoeff()}) {
      Eigen::Index run = 0, begin = 0, longest = 0;
      for (Eigen::Index i = 0; i < rows; ++i) {
        run = column[i] == extreme ? run + 1 : 0;
        if (run > longest) {
          longest = run;
          begin = i - run + 1;
        }
      }
      const Eigen::Index end = begin + longest;
      const double enters = begin > 0 ? std::abs(extreme - column[begin - 1]) : 0;
      const double leaves = end < rows ? std::abs(extreme - column[end]) : 0;
      if (longest >= fewest && std::max(enters, leaves) > 2.5 * step) {
        checked.faults.push_back(fmt::format(
            "{} is exactly {:.6g} in {} samples, {} of them from {} to {}: it is clipped; such "
            "samples do not show the effort of the arm; record a slower motion, or with a wider "
            "range",
            quote_column(checked, LogQuantity::effort, j), extreme,
            (column.array() == extreme).count(), longest,
            checked.recording.name_row(static_cast<std::size_t>(begin)),
            checked.recording.name_row(static_cast<std::size_t>(end - 1))));
        break;
      }
    }
  }
}

void check_deflections(Checked& checked) {
  const MotionLog& log = checked.log;
  for (Eigen::Index j = 0; j < log.link_positions.cols(); ++j) {
    if (!std::isfinite(log.link_positions(0, j))) {
      continue;
    }
    const Eigen::ArrayXd difference = log.link_positions.col(j) - log.positions.col(j);
    Eigen::Index worst = 0;
    if (difference.abs().maxCoeff(&worst) <= kMostDeflection) {
      continue;
    }
    const double mean = difference.mean();
    const bool is_constant = (difference - mean).abs().maxCoeff() <= kMostDeflection;
    checked.faults.push_back(fmt::format(
        "{} and {} differ by {:.4g} {} in {}; a gear yields by less than {:g}; {}",
        quote_column(checked, LogQuantity::link_position, j),
        quote_column(checked, LogQuantity::position, j), difference[worst], get_unit(checked, j),
        checked.recording.name_row(static_cast<std::size_t>(worst)), kMostDeflection,
        is_constant
            ? fmt::format("the difference is nearly constant ({:.4g}), so the encoders have "
                          "different zeros; subtract it in the file",
                          mean)
            : "check units, signs, and whether both belong to this joint"));
  }
}

// Returns which joints rest.
std::vector<bool> find_rest(Checked& checked) {
  std::vector<bool> rests;
  std::vector<std::string> names;
  for (Eigen::Index j = 0; j < checked.log.positions.cols(); ++j) {
    const auto column = checked.log.positions.col(j);
    rests.push_back(column.maxCoeff() - column.minCoeff() < kRest);
    if (rests.back()) {
      names.push_back(get_joint(checked, j).name);
    }
  }
  if (names.size() == rests.size()) {
    refuse_log(fmt::format(
        "{}: the robot rests: no joint moves by more than {:g} rad (or m), by {} to "
        "{}; record a motion; `armwright excite` proposes one",
        checked.recording.file, kRest, quote_column(checked, LogQuantity::position, 0),
        quote_column(checked, LogQuantity::position, checked.log.positions.cols() - 1)));
  }
  if (!names.empty()) {
    checked.log.notes.push_back(fmt::format(
        "joint{} {} rest{}: this log says little of {}", names.size() == 1 ? "" : "s",
        list_quoted(names), names.size() == 1 ? "s" : "", names.size() == 1 ? "it" : "them"));
  }
  return rests;
}

}  // namespace

MotionLog check_recording(Recording recording, const RobotModel& robot) {
  const double period_s = check_times(recording);
  check_numbers(recording);
  MotionLog log = make_log(recording, robot);
  Checked checked{recording, robot, log, period_s, {}};
  const std::vector<bool> rests = find_rest(checked);
  if (!find_degrees(checked)) {
    check_ranges(checked);
    check_rates(checked);
    check_references(checked);
    check_deflections(checked);
  }
  check_clipping(checked, rests);
  if (checked.faults.size() == 1) {
    refuse_log(fmt::format("{}: {}", recording.file, checked.faults.front()));
  }
  if (!checked.faults.empty()) {
    refuse_log(fmt::format("{}: {} things to mend:\n  {}", recording.file, checked.faults.size(),
                           join(checked.faults, "\n  ")));
  }
  return log;
}

}  // namespace armwright
