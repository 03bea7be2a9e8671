// Efforts that an arm's model says in advance for a test case's targets, by discrete inverse
// dynamics. With theta_k the target at the end of control period k, theta_(-1) the start, h the
// period and differences the short way round,
//   v_k = (theta_k - theta_(k-1)) / h,   a_k = (v_k - v_(k-1)) / h,   v_(-1) = 0,
//   inverse_dynamics:  tau_k = M(theta_(k-1)) a_k + b(theta_(k-1), v_(k-1)),
//   gravity:           tau_k = b(theta_(k-1), 0):
// the efforts with which one step of semi-implicit Euler takes this arm from the target at the
// period's start exactly to that at its end, or with which it stays. More than one step a period
// lands beside it by as much as h is coarse.
#pragma once

#include "sim/dynamics/chain_model.hpp"
#include "sim/tracking/tracking.hpp"

namespace armwright::articulated {

// Fills the table's feed_forward_n_m from its angles; nothing for FeedForward::none.
void fill_feed_forward(const ChainModel& chain, FeedForward kind, double period_s,
                       TargetTable& table);

}  // namespace armwright::articulated
