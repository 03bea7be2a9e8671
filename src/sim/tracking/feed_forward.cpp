#include "sim/tracking/feed_forward.hpp"

#include <algorithm>
#include <vector>

#include "sim/dynamics/chain_dynamics.hpp"
#include "sim/kinematics/kinematics.hpp"

namespace armwright::articulated {
namespace {

struct FeedForwardLevel;  // tags the code that this file instantiates
using FeedForwardNumber = lanes::Single<double, FeedForwardLevel>;
using AnyChain = ChainShape<0, kAnyShape, true>;

}  // namespace

void fill_feed_forward(const ChainModel& chain, FeedForward kind, double period_s,
                       TargetTable& table) {
  if (kind == FeedForward::none) {
    return;
  }
  const std::size_t n = table.joints;
  const auto joint_kind = [&](std::size_t i) {
    return (chain.flags()[i] & kPrismatic) == 0 ? JointKind::revolute : JointKind::prismatic;
  };
  const std::vector<FeedForwardNumber> model(chain.numbers().begin(), chain.numbers().end());
  std::vector<FeedForwardNumber> scratch(
      static_cast<std::size_t>(calc_dynamics_packs(chain.joints())), FeedForwardNumber(0));
  FeedForwardNumber* memory = scratch.data();
  ChainDynamics<FeedForwardNumber, AnyChain> dynamics(
      AnyChain(chain.joints(), chain.flags().data(), chain.tilted_gravity()), model.data(), memory);
  // The state at the start of the period, and the acceleration in it.
  std::vector<FeedForwardNumber> q(n), rate(n, FeedForwardNumber(0)),
      acceleration(n, FeedForwardNumber(0));
  const double* before = table.start_rad.data();
  table.feed_forward_n_m.resize(table.angles_rad.size());
  for (int step = 0; step < table.steps; ++step) {
    const double* const target = table.angles(step).data();
    std::vector<FeedForwardNumber> next = rate;
    if (kind == FeedForward::inverse_dynamics) {
      for (std::size_t i = 0; i < n; ++i) {
        next[i] = calc_displacement(joint_kind(i), before[i], target[i]) / period_s;
        acceleration[i] = (next[i].v - rate[i].v) / period_s;
      }
    }
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = before[i];
    }
    dynamics.set_posture(q.data(), true);
    dynamics.calc_equations(q.data(), rate.data());
    double* const efforts = table.feed_forward_n_m.data() + static_cast<std::size_t>(step) * n;
    for (std::size_t i = 0; i < n; ++i) {
      double effort = dynamics.bias(static_cast<int>(i)).v;
      for (std::size_t j = 0; j < n; ++j) {
        effort +=
            dynamics.mass(static_cast<int>(std::max(i, j)), static_cast<int>(std::min(i, j))).v *
            acceleration[j].v;
      }
      efforts[i] = effort;
    }
    rate = next;
    before = target;
  }
}

}  // namespace armwright::articulated
