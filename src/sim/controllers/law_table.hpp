// The table of control laws: one row per law. controller_table(), the SIMD lanes and the
// derivatives are all made from it.
#pragma once

#include "sim/controllers/cascade.hpp"
#include "sim/controllers/fuzzy.hpp"
#include "sim/controllers/neural.hpp"
#include "sim/controllers/pi2d.hpp"
#include "sim/controllers/pid.hpp"
#include "sim/controllers/pid_drive.hpp"
#include "sim/controllers/pid_feed_forward.hpp"
#include "sim/controllers/pid_filtered.hpp"

namespace armwright::controllers {

template <class... Laws>
struct LawList {};

using AllLaws = LawList<Pid,  // must be the first: the kernels have it inlined
                        PidFiltered, Pi2d, PidGravity, PidComputedTorque, Cascade, Neural, Fuzzy,
                        FuzzyReference, PidVelocity, PidPosition>;

// Sets the state of a joint's controller, as hold_effort(). Gains and states are those of the joint.
template <class V>
using HoldEffort = void (*)(V effort, V low, V high, Fields<V> gain, Fields<V> state);

// Returns the function for the law at that place of the table.
template <class V, class... Laws>
HoldEffort<V> find_hold(int law, LawList<Laws...>) {
  constexpr HoldEffort<V> kFunctions[] = {hold_effort<Laws, V>...};
  return kFunctions[law];
}

}  // namespace armwright::controllers
