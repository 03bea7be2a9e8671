#include "problems/logs/motion_faults.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

// The largest motion of a joint at rest: noise of an encoder, and a controller that holds the joint.
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

std::string quote_column(const Checked& checked, LogQuantity quantity, Eigen::Index joint) {
  for (const RecordedColumn& column : checked.recording.columns) {
    if (column.quantity == quantity && column.joint == joint) {
      return quote_name(column.name);
    }
  }
  return fmt::format("{}_{}", kQuantityNames[static_cast<std::size_t>(quantity)], joint + 1);
}

// Returns the factor from the file's efforts to those at the joint.
double get_factor(const Checked& checked, Eigen::Index joint) {
  const auto& columns = checked.recording.columns;
  const auto found = std::ranges::find_if(columns, [&](const RecordedColumn& column) {
    return column.quantity == LogQuantity::effort && column.joint == joint;
  });
  return found->factor;
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
        "outside); other joints' columns, another zero or direction of the joint and degrees look "
        "like this; --column says which column is which, --unit position=deg that they are degrees",
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
  // Returns the changes of a position that has these rates.
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

// Returns the other joint whose `changes` match best; nothing if none matches clearly better than
// `own_match`. The joints of a synchronous motion all match each other.
std::optional<Eigen::Index> find_match(const Eigen::VectorXd& moved,
                                       const std::vector<Eigen::VectorXd>& changes,
                                       Eigen::Index joint, double own_match) {
  constexpr double kClearly = 0.1;
  std::optional<Eigen::Index> best;
  double best_match = std::max(kMatch, std::abs(own_match) + kClearly);
  for (std::size_t k = 0; k < changes.size(); ++k) {
    const double match = changes[k].size() > 0 ? std::abs(calc_match(moved, changes[k])) : 0;
    if (static_cast<Eigen::Index>(k) != joint && match > best_match) {
      best = static_cast<Eigen::Index>(k);
      best_match = match;
    }
  }
  return best;
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
    const auto other = find_match(moved, integrated, j, match);
    if (!other && match > kNoMatch && factor > 1 / kMostFactor && factor < kMostFactor) {
      continue;
    }
    if (!other && std::abs(match) > kNoMatch) {
      checked.faults.push_back(
          fmt::format("{} do not match: the position changes {:.3g} times as "
                      "fast as the velocity says; {}",
                      names, factor, describe_factor(factor, j)));
      continue;
    }
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
    const double match = own.size() > 0 ? calc_match(moved, own) : 1;
    const auto other = find_match(moved, wanted, j, match);
    if (moves && other) {
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
            quote_column(checked, LogQuantity::effort, j), extreme / get_factor(checked, j),
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
    throw Error(
        ErrorKind::bad_data,
        fmt::format(
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

std::vector<std::string> find_motion_faults(const Recording& recording, const RobotModel& robot,
                                            MotionLog& log, double period_s) {
  Checked checked{recording, robot, log, period_s, {}};
  const std::vector<bool> rests = find_rest(checked);
  if (!find_degrees(checked)) {
    check_ranges(checked);
    check_rates(checked);
    check_references(checked);
    check_deflections(checked);
  }
  check_clipping(checked, rests);
  return checked.faults;
}

}  // namespace armwright
