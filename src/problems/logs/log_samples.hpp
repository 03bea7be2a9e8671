// Makes samples for a fit of a recorded motion: at an even period, filtered, with rates and
// accelerations.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "problems/logs/motion_log.hpp"

namespace armwright {

struct Conditioning {
  // The filter's frequency. Positions and efforts pass the same filter, so that both sides of the
  // equation of motion are filtered alike.
  double cutoff_hz = 8;
  double cut_s = 0.24;  // left out at each end, where the filter lacks samples of one side
  // Between the samples that are kept, at least the recorded period; 0: the longest one with ten
  // samples per period of the cutoff, since others add nothing that the filter has not removed.
  double period_s = 0;
};

// One row per sample, one column per joint.
struct LogSamples {
  double period_s = 0;
  Eigen::VectorXd times_s;  // of the log
  Eigen::MatrixXd positions, rates, accelerations, efforts;
  Eigen::VectorXd effort_factors;  // as MotionLog::effort_factors
  // As MotionLog::link_positions: empty, or NaN in some columns.
  Eigen::MatrixXd link_positions, link_rates, link_accelerations;
  std::vector<std::string> notes;  // what was done, one line each
};

// Resamples the log if its times are uneven (straight between samples), filters it, differentiates
// the filtered positions by central differences at the full rate, cuts both ends and keeps every n-th
// sample. Throws Error{usage} if a value is negative or the cutoff is above 0.4 of the sampling rate,
// and Error{bad_data} if fewer than 30 samples are left.
LogSamples condition(const MotionLog& log, const Conditioning& conditioning = {});

}  // namespace armwright
