// The samples of a log against the motion that it has: filter, derivatives, resampling.
#include "problems/logs/log_samples.hpp"

#include <gmock/gmock.h>

#include "problems/logs/log_motion.hpp"
#include "problems/logs/zero_phase_filter.hpp"

namespace armwright {
namespace {

using testing::ElementsAre;

// Rows of a motion without a file. Efforts are the positions times 100.
template <typename Calc>
MotionLog make_log(const std::vector<double>& times_s, const Calc& calc) {
  MotionLog log;
  log.name = "log";
  log.times_s = times_s;
  log.positions.resize(static_cast<Eigen::Index>(times_s.size()), 1);
  for (std::size_t i = 0; i < times_s.size(); ++i) {
    log.positions(static_cast<Eigen::Index>(i), 0) = calc(times_s[i]);
  }
  log.efforts = 100 * log.positions;
  return log;
}

std::vector<double> make_times(std::size_t count, double period_s) {
  std::vector<double> times_s;
  for (std::size_t i = 0; i < count; ++i) {
    times_s.push_back(static_cast<double>(i) * period_s);
  }
  return times_s;
}

// The gain of the header of ZeroPhaseFilter.
double calc_gain(double frequency_hz, double cutoff_hz, double period_s) {
  const double ratio = std::tan(std::numbers::pi * frequency_hz * period_s) /
                       std::tan(std::numbers::pi * cutoff_hz * period_s);
  return 1 / (1 + std::pow(ratio, 8));
}

TEST(ZeroPhaseFilter, SinesHaveTheGainOfTheFilterAndNoDelay) {
  constexpr double kPeriod_s = 0.004, kCutoff_hz = 8;
  for (const double frequency_hz : {1.0, 5.0, 8.0, 12.0, 20.0}) {
    Eigen::VectorXd sine(4000), cosine(4000);
    for (Eigen::Index i = 0; i < 4000; ++i) {
      const double angle = 2 * std::numbers::pi * frequency_hz * static_cast<double>(i) * kPeriod_s;
      sine[i] = std::sin(angle);
      cosine[i] = std::cos(angle);
    }
    const Eigen::VectorXd filtered = ZeroPhaseFilter(kCutoff_hz, kPeriod_s).apply(sine);
    // Ten seconds in the middle: whole periods, so that sine and cosine are orthogonal.
    const auto middle = [](const Eigen::VectorXd& v) { return v.segment(750, 2500); };
    const double in_phase = middle(filtered).dot(middle(sine)) / 1250;
    const double shifted = middle(filtered).dot(middle(cosine)) / 1250;
    // Transients of the ends have died out after three seconds: e^(-3 s * 2 pi 8 Hz * 0.38).
    EXPECT_NEAR(in_phase, calc_gain(frequency_hz, kCutoff_hz, kPeriod_s), 1e-12) << frequency_hz;
    EXPECT_NEAR(shifted, 0, 1e-12) << frequency_hz;
  }
}

TEST(ZeroPhaseFilter, LinesPassUnchangedUpToTheEnds) {
  Eigen::VectorXd line(500);
  for (Eigen::Index i = 0; i < line.size(); ++i) {
    line[i] = 3 + 0.01 * static_cast<double>(i);
  }
  // The continued line begins 375 samples earlier in the steady state of a constant; what is left of
  // that after three periods of the cutoff is e^(-0.375 s... of the slowest pole) of 1 rad.
  EXPECT_LT((ZeroPhaseFilter(8, 0.004).apply(line) - line).cwiseAbs().maxCoeff(), 1e-3);
  const Eigen::VectorXd constant = Eigen::VectorXd::Constant(5, 7.5);
  EXPECT_LT((ZeroPhaseFilter(8, 0.004).apply(constant) - constant).cwiseAbs().maxCoeff(), 1e-12);
}

// scipy 1.10: filtfilt(*butter(4, 0.1), x, padlen=60)[0:200:33] of x[i] = sin(i^2 / 500).
TEST(ZeroPhaseFilter, AgreesWithScipy) {
  Eigen::VectorXd chirp(200);
  for (Eigen::Index i = 0; i < chirp.size(); ++i) {
    chirp[i] = std::sin(static_cast<double>(i * i) / 500);
  }
  const Eigen::VectorXd filtered = ZeroPhaseFilter(0.1, 0.5).apply(chirp);
  const double expected[] = {-8.72144949681e-05, 0.833592446667,   0.423431996714, 0.0370922205403,
                             0.00191798178247,   0.00369580695695, -0.480419333751};
  for (Eigen::Index i = 0; i < 7; ++i) {
    // scipy's filter has one section of order eight, which rounds differently.
    EXPECT_NEAR(filtered[33 * i], expected[i], 1e-9) << i;
  }
}

TEST(LogSamples, DerivativesOfASumOfSinesAreRight) {
  const Swing slow{0.3, 0.8, 0.4, 0.5}, fast{0, 0.1, 1.7, 1.9};
  const MotionLog log = make_log(
      make_times(2500, 0.002), [&](double t_s) { return slow.position(t_s) + fast.position(t_s); });
  const LogSamples samples = condition(log);
  EXPECT_THAT(
      samples.notes,
      ElementsAre("positions and efforts filtered at 8 Hz, zero phase (Butterworth of fourth "
                  "order, forward and backward)",
                  "0.24 s cut off at both ends",
                  "every 6th sample kept: 377 samples, 12 ms "
                  "apart"));
  EXPECT_NEAR(samples.period_s, 0.012, 1e-15);
  EXPECT_NEAR(samples.times_s[0], 0.24, 1e-12);
  EXPECT_EQ(samples.link_positions.size(), 0);
  // The filter takes (1.7 / 8)^8 = 4e-6 of the fast part. Differences over h = 2 ms leave out
  // (w h)^2 / 6 = 8e-5 of its rate and (w h)^2 / 12 of its acceleration. Near the ends, the turned
  // samples have another curvature than the motion: 0.5 % of the acceleration of 11 rad/s^2.
  for (Eigen::Index i = 0; i < samples.times_s.size(); ++i) {
    const double t_s = samples.times_s[i];
    const bool is_inside = t_s > 0.75 && t_s < 4.25;
    const double limit = is_inside ? 1 : 100;
    EXPECT_NEAR(samples.positions(i, 0), slow.position(t_s) + fast.position(t_s), 1e-6 * limit);
    EXPECT_NEAR(samples.rates(i, 0), slow.rate(t_s) + fast.rate(t_s), 1.2e-4 * limit);
    EXPECT_NEAR(samples.accelerations(i, 0), slow.acceleration(t_s) + fast.acceleration(t_s),
                6e-4 * limit);
    EXPECT_NEAR(samples.efforts(i, 0), 100 * samples.positions(i, 0), 1e-10);
  }
}

TEST(LogSamples, NoiseAboveTheCutoffIsRemoved) {
  const Swing swing{0, 1, 0.5, 0};
  const MotionLog log = make_log(make_times(2500, 0.002), [&](double t_s) {
    return swing.position(t_s) + 1e-3 * std::sin(2 * std::numbers::pi * 60 * t_s);
  });
  const LogSamples samples = condition(log);
  for (Eigen::Index i = 20; i + 20 < samples.times_s.size(); ++i) {
    // Without the filter the noise would have an acceleration of 142 rad/s^2.
    EXPECT_NEAR(samples.accelerations(i, 0), swing.acceleration(samples.times_s[i]), 1e-3);
  }
}

TEST(LogSamples, UnevenTimesAreResampled) {
  const Swing swing{0.1, 0.5, 0.5, 0.3};
  std::vector<double> times_s = make_times(2000, 0.004);
  for (std::size_t i = 1; i < times_s.size(); ++i) {
    times_s[i] += i % 3 == 0 ? 0.0008 : i % 3 == 1 ? -0.0003 : 0;
  }
  times_s.erase(times_s.begin() + 700, times_s.begin() + 702);  // the recorder lost two samples
  const MotionLog log = make_log(times_s, [&](double t_s) { return swing.position(t_s); });
  const LogSamples samples = condition(log);
  EXPECT_EQ(samples.notes.front(), "resampled from 2.9..12 ms to 4 ms, straight between samples");
  for (Eigen::Index i = 0; i < samples.times_s.size(); ++i) {
    const double t_s = samples.times_s[i];
    // A straight line over h = 12 ms leaves out at most h^2 / 8 of the acceleration.
    EXPECT_NEAR(samples.positions(i, 0), swing.position(t_s), 1e-4);
    EXPECT_NEAR(samples.rates(i, 0), swing.rate(t_s), 5e-3) << t_s;
  }
}

TEST(LogSamples, TimesThatAreOnlyRoundedAreEven) {
  std::vector<double> times_s = make_times(2000, 0.004);
  for (double& time_s : times_s) {
    time_s = std::round(time_s * 1e5 + 0.3) / 1e5;
  }
  const MotionLog log = make_log(times_s, [](double t_s) { return std::sin(t_s); });
  EXPECT_THAT(condition(log).notes.front(), testing::StartsWith("positions and efforts filtered"));
}

TEST(LogSamples, PeriodCutAndCutoffAreChosen) {
  const MotionLog log = make_log(make_times(1000, 0.004), [](double t_s) { return std::sin(t_s); });
  const LogSamples all = condition(log, {.cutoff_hz = 4, .cut_s = 0.5, .period_s = 0.004});
  EXPECT_THAT(
      all.notes,
      ElementsAre("positions and efforts filtered at 4 Hz, zero phase (Butterworth of fourth "
                  "order, forward and backward)",
                  "0.5 s cut off at both ends"));
  EXPECT_EQ(all.times_s.size(), 1000 - 2 * 125);
  const LogSamples fewer = condition(log, {.cutoff_hz = 4, .cut_s = 0.5, .period_s = 0.008});
  EXPECT_EQ(fewer.notes.back(), "every 2nd sample kept: 375 samples, 8 ms apart");
  const Eigen::VectorXd each_second = all.positions(Eigen::seqN(0, 375, 2), 0);
  EXPECT_EQ(fewer.positions, each_second);
  // At ten samples per period of the cutoff there is nothing to leave out.
  EXPECT_EQ(condition(log, {.cutoff_hz = 30}).period_s, 0.004);
}

TEST(LogSamples, LinkPositionsAreFilteredLikeTheMotors) {
  MotionLog log = make_log(make_times(1000, 0.004), [](double t_s) { return std::sin(3 * t_s); });
  log.positions.conservativeResize(Eigen::NoChange, 2);
  log.efforts.conservativeResize(Eigen::NoChange, 2);
  log.positions.col(1) = log.efforts.col(1) = log.positions.col(0);
  log.link_positions = log.positions;
  log.link_positions.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const LogSamples samples = condition(log);
  EXPECT_EQ(samples.link_positions.col(1), samples.positions.col(1));
  EXPECT_TRUE(samples.link_positions.col(0).array().isNaN().all());
}

TEST(LogSamples, ImpossibleWishesAreRefused) {
  const MotionLog log = make_log(make_times(1000, 0.004), [](double t_s) { return std::sin(t_s); });
  const auto refuse = [&](const Conditioning& wish) {
    return usage_error_of([&] { condition(log, wish); });
  };
  EXPECT_EQ(refuse({.cutoff_hz = 0}), "the filter's cutoff in Hz is 0; it must be finite and > 0");
  EXPECT_EQ(refuse({.cut_s = -1}),
            "the time in s that is cut off at each end is -1; it must be finite and >= 0");
  EXPECT_EQ(refuse({.period_s = -1}),
            "the period in s of the samples is -1; it must be finite and >= "
            "0");
  EXPECT_EQ(
      refuse({.cutoff_hz = 101}),
      "log: has 250 samples per second, so the filter's cutoff may be 100 Hz at most; it is 101 "
      "Hz");
  EXPECT_EQ(refuse({.period_s = 0.002}),
            "log: has a period of 4 ms; samples every 2 ms are not possible");
  const MotionLog brief =
      make_log(make_times(200, 0.004), [](double t_s) { return std::sin(t_s); });
  EXPECT_EQ(
      error_of(ErrorKind::bad_data, [&] { condition(brief); }),
      "log: takes 0.796 s; behind the filter, 27 of at least 30 samples are left, 0.24 s are cut "
      "off at each end and samples are 12 ms apart; record a longer motion");
}

}  // namespace
}  // namespace armwright
