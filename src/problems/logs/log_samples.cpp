#include "problems/logs/log_samples.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/read_limit.hpp"
#include "base/text.hpp"
#include "problems/logs/zero_phase_filter.hpp"

namespace armwright {
namespace {

constexpr double kSamplesPerCutoffPeriod = 10;
constexpr double kHighestCutoff_share = 0.4;  // of the sampling rate
constexpr Eigen::Index kFewestKept = 30;
// Times that are printed with few digits differ from even ones by as much.
constexpr double kEvenWithin_periods = 0.02;
constexpr double kMostResampled = 1e8;

// The even times of a log.
struct EvenTimes {
  double start_s = 0, period_s = 0;
  Eigen::Index count = 0;
  bool are_recorded = false;  // the log has these times itself
};

std::string describe_ms(double time_s) {
  return fmt::format("{:.4g}", 1e3 * time_s);
}

EvenTimes choose_times(const MotionLog& log, std::vector<std::string>& notes) {
  const std::vector<double>& times_s = log.times_s;
  const auto count = static_cast<Eigen::Index>(times_s.size());
  const double whole_s = times_s.back() - times_s.front();
  EvenTimes even{times_s.front(), whole_s / static_cast<double>(count - 1), count, true};
  std::vector<double> periods_s;
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    periods_s.push_back(times_s[i] - times_s[i - 1]);
    const double expected_s = even.start_s + static_cast<double>(i) * even.period_s;
    even.are_recorded = even.are_recorded &&
                        std::abs(times_s[i] - expected_s) <= kEvenWithin_periods * even.period_s;
  }
  if (even.are_recorded) {
    return even;
  }
  std::ranges::sort(periods_s);
  const double shortest_s = periods_s.front(), longest_s = periods_s.back();
  // The mean period, with lost samples counted.
  const double median_s = periods_s[periods_s.size() / 2];
  double steps = 0;
  for (const double period_s : periods_s) {
    steps += std::max(1.0, std::round(period_s / median_s));
  }
  even.period_s = whole_s / steps;
  // Clocks have whole microseconds.
  const double rounded_s = std::round(1e6 * even.period_s) * 1e-6;
  if (std::abs(rounded_s / even.period_s - 1) < 1e-2) {
    even.period_s = rounded_s;
  }
  const double resampled = std::floor(whole_s / even.period_s * (1 + 1e-12)) + 1;
  if (!(resampled < kMostResampled)) {
    throw Error(ErrorKind::bad_data,
                fmt::format("{}: {:.3g} samples at a period of {} s are too many", log.name,
                            resampled, even.period_s));
  }
  even.count = static_cast<Eigen::Index>(resampled);
  notes.push_back(fmt::format("resampled from {}..{} ms to {} ms, straight between samples",
                              describe_ms(shortest_s), describe_ms(longest_s),
                              describe_ms(even.period_s)));
  return even;
}

Eigen::VectorXd resample(const MotionLog& log, const Eigen::VectorXd& values,
                         const EvenTimes& even) {
  if (even.are_recorded) {
    return values;
  }
  Eigen::VectorXd resampled(even.count);
  std::size_t next = 1;
  for (Eigen::Index i = 0; i < even.count; ++i) {
    const double time_s = even.start_s + static_cast<double>(i) * even.period_s;
    while (next + 1 < log.times_s.size() && log.times_s[next] < time_s) {
      ++next;
    }
    const double from_s = log.times_s[next - 1];
    const double share = std::clamp((time_s - from_s) / (log.times_s[next] - from_s), 0.0, 1.0);
    const auto at = static_cast<Eigen::Index>(next);
    resampled[i] = values[at - 1] + share * (values[at] - values[at - 1]);
  }
  return resampled;
}

void check_conditioning(const Conditioning& conditioning) {
  const auto fail = [](const char* name, double value, const char* allowed) {
    throw Error(ErrorKind::usage,
                fmt::format("the {} is {:g}; it must be {}", name, value, allowed));
  };
  if (!(conditioning.cutoff_hz > 0) || !std::isfinite(conditioning.cutoff_hz)) {
    fail("filter's cutoff in Hz", conditioning.cutoff_hz, "finite and > 0");
  }
  if (!(conditioning.cut_s >= 0) || !std::isfinite(conditioning.cut_s)) {
    fail("time in s that is cut off at each end", conditioning.cut_s, "finite and >= 0");
  }
  if (!(conditioning.period_s >= 0) || !std::isfinite(conditioning.period_s)) {
    fail("period in s of the samples", conditioning.period_s, "finite and >= 0");
  }
}

}  // namespace

LogSamples condition(const MotionLog& log, const Conditioning& conditioning) {
  check_conditioning(conditioning);
  LogSamples samples;
  const EvenTimes even = choose_times(log, samples.notes);
  const double rate_hz = 1 / even.period_s;
  if (conditioning.cutoff_hz > kHighestCutoff_share * rate_hz) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: has {:.4g} samples per second, so the filter's cutoff may be {:.4g} Hz "
                    "at most; it is {:g} Hz",
                    log.name, rate_hz, kHighestCutoff_share * rate_hz, conditioning.cutoff_hz));
  }
  const double wanted_s = conditioning.period_s > 0
                              ? conditioning.period_s
                              : 1 / (kSamplesPerCutoffPeriod * conditioning.cutoff_hz);
  if (conditioning.period_s > 0 && conditioning.period_s < even.period_s * (1 - 1e-6)) {
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: has a period of {} ms; samples every {} ms are not possible", log.name,
                    describe_ms(even.period_s), describe_ms(conditioning.period_s)));
  }
  const auto stride =
      static_cast<Eigen::Index>(std::clamp(std::floor(wanted_s / even.period_s + 1e-6), 1.0, 1e9));
  // Central differences need a neighbour at each side.
  const double cut = std::clamp(std::round(conditioning.cut_s / even.period_s), 1.0, 1e9);
  const auto first = static_cast<Eigen::Index>(cut);
  const Eigen::Index kept = even.count > 2 * first ? (even.count - 2 * first - 1) / stride + 1 : 0;
  if (kept < kFewestKept) {
    throw Error(
        ErrorKind::bad_data,
        fmt::format(
            "{}: takes {:.4g} s; behind the filter, {} of at least {} samples are left, {:g} s "
            "are cut off at each end and samples are {} ms apart; record a longer motion",
            log.name, log.times_s.back() - log.times_s.front(), kept, kFewestKept,
            conditioning.cut_s, describe_ms(static_cast<double>(stride) * even.period_s)));
  }
  samples.notes.push_back(
      fmt::format("positions and efforts filtered at {:g} Hz, zero phase (Butterworth of fourth "
                  "order, forward and "
                  "backward)",
                  conditioning.cutoff_hz));
  samples.notes.push_back(
      fmt::format("{:.4g} s cut off at both ends", static_cast<double>(first) * even.period_s));
  if (stride > 1) {
    samples.notes.push_back(fmt::format("every {}{} sample kept: {} samples, {} ms apart", stride,
                                        stride == 2   ? "nd"
                                        : stride == 3 ? "rd"
                                                      : "th",
                                        kept,
                                        describe_ms(static_cast<double>(stride) * even.period_s)));
  }
  samples.period_s = static_cast<double>(stride) * even.period_s;
  samples.times_s.resize(kept);
  for (Eigen::Index i = 0; i < kept; ++i) {
    samples.times_s[i] = even.start_s + static_cast<double>(first + i * stride) * even.period_s;
  }
  const ZeroPhaseFilter filter(conditioning.cutoff_hz, even.period_s);
  const auto filtered = [&](const Eigen::MatrixXd& values, Eigen::Index joint) {
    check_reading();
    return filter.apply(resample(log, values.col(joint), even));
  };
  const auto keep = [&](const Eigen::VectorXd& values) {
    return values(Eigen::seqN(first, kept, stride)).eval();
  };
  samples.effort_factors = log.effort_factors;
  const Eigen::Index joints = log.positions.cols();
  for (Eigen::MatrixXd* goal :
       {&samples.positions, &samples.rates, &samples.accelerations, &samples.efforts}) {
    goal->resize(kept, joints);
  }
  if (log.link_positions.size() > 0) {
    for (Eigen::MatrixXd* goal :
         {&samples.link_positions, &samples.link_rates, &samples.link_accelerations}) {
      goal->setConstant(kept, joints, std::numeric_limits<double>::quiet_NaN());
    }
  }
  const auto differentiate = [&](const Eigen::MatrixXd& recorded, Eigen::Index j,
                                 Eigen::MatrixXd& positions, Eigen::MatrixXd& rates,
                                 Eigen::MatrixXd& accelerations) {
    const Eigen::VectorXd position = filtered(recorded, j);
    for (Eigen::Index i = 0; i < kept; ++i) {
      const Eigen::Index at = first + i * stride;
      const double before = position[at - 1], here = position[at], behind = position[at + 1];
      positions(i, j) = here;
      rates(i, j) = (behind - before) / (2 * even.period_s);
      accelerations(i, j) = (behind - 2 * here + before) / (even.period_s * even.period_s);
    }
  };
  for (Eigen::Index j = 0; j < joints; ++j) {
    differentiate(log.positions, j, samples.positions, samples.rates, samples.accelerations);
    samples.efforts.col(j) = keep(filtered(log.efforts, j));
    if (log.link_positions.size() > 0 && std::isfinite(log.link_positions(0, j))) {
      differentiate(log.link_positions, j, samples.link_positions, samples.link_rates,
                    samples.link_accelerations);
    }
  }
  return samples;
}

}  // namespace armwright
