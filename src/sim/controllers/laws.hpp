// The table of control laws: one row each. controller_table(), the SIMD lanes and the derivatives
// are all made of it.
#pragma once

#include "sim/controllers/cascade.hpp"
#include "sim/controllers/neural.hpp"
#include "sim/controllers/pi2d.hpp"
#include "sim/controllers/pid.hpp"
#include "sim/controllers/pid_computed_torque.hpp"
#include "sim/controllers/pid_filtered.hpp"
#include "sim/controllers/pid_gravity.hpp"

namespace armwright::controllers {

template <class... Laws>
struct LawList {};

using AllLaws = LawList<Pid,  // the first, which the kernels have inlined
                        PidFiltered, Pi2d, PidGravity, PidComputedTorque, Cascade, Neural>;

}  // namespace armwright::controllers
