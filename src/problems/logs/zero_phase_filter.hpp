// A low-pass filter without phase shift: a Butterworth filter of fourth order, forward and backward.
// The gain at the frequency f is 1 / (1 + (tan(pi f T) / tan(pi f_c T))^8), T the period and f_c the
// cutoff: 1/2 at the cutoff, and no delay. The bilinear transform makes the digital filter of two
// sections of second order (Oppenheim and Schafer, Discrete-Time Signal Processing, 7.1).
#pragma once

#include <Eigen/Core>
#include <array>

namespace armwright {

class ZeroPhaseFilter {
 public:
  // 0 < cutoff_hz < 1 / (2 period_s).
  ZeroPhaseFilter(double cutoff_hz, double period_s);

  // Returns the filtered samples. Both ends are continued by three periods of the cutoff, as far as
  // there are samples: by the samples there, turned about the last one. The filter starts in the
  // steady state for the first value. Still, samples within a period of an end are less accurate.
  Eigen::VectorXd apply(const Eigen::VectorXd& samples) const;

 private:
  struct Section {
    double b0, b1, b2, a1, a2;
  };
  void run(Eigen::VectorXd& samples) const;

  std::array<Section, 2> sections_{};
  Eigen::Index padding_;
};

}  // namespace armwright
