#include "problems/logs/zero_phase_filter.hpp"

#include <cmath>
#include <numbers>

namespace armwright {

ZeroPhaseFilter::ZeroPhaseFilter(double cutoff_hz, double period_s)
    : padding_(static_cast<Eigen::Index>(std::ceil(std::min(3 / (cutoff_hz * period_s), 1e9)))) {
  const double k = std::tan(std::numbers::pi * cutoff_hz * period_s);
  for (std::size_t i = 0; i < sections_.size(); ++i) {
    // Each section has a pair of the filter's poles, at pi/8 and 3 pi/8 from the real axis.
    const double damping = 2 * std::cos((2.0 * static_cast<double>(i) + 1) * std::numbers::pi / 8);
    const double scale = 1 / (1 + damping * k + k * k);
    sections_[i] = {k * k * scale, 2 * k * k * scale, k * k * scale, 2 * (k * k - 1) * scale,
                    (1 - damping * k + k * k) * scale};
  }
}

void ZeroPhaseFilter::run(Eigen::VectorXd& samples) const {
  for (const Section& section : sections_) {
    // The state (transposed direct form II) in which the first value has always been there. The
    // section's gain at rest is 1.
    double second = (section.b2 - section.a2) * samples[0];
    double first = (section.b1 - section.a1) * samples[0] + second;
    for (double& sample : samples) {
      const double input = sample;
      sample = section.b0 * input + first;
      first = section.b1 * input - section.a1 * sample + second;
      second = section.b2 * input - section.a2 * sample;
    }
  }
}

Eigen::VectorXd ZeroPhaseFilter::apply(const Eigen::VectorXd& samples) const {
  const Eigen::Index count = samples.size();
  const Eigen::Index padding = std::min(padding_, count - 1);
  Eigen::VectorXd padded(count + 2 * padding);
  padded.segment(padding, count) = samples;
  for (Eigen::Index i = 1; i <= padding; ++i) {
    padded[padding - i] = 2 * samples[0] - samples[i];
    padded[padding + count - 1 + i] = 2 * samples[count - 1] - samples[count - 1 - i];
  }
  run(padded);
  padded.reverseInPlace();
  run(padded);
  padded.reverseInPlace();
  return padded.segment(padding, count);
}

}  // namespace armwright
