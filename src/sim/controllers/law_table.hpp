// The table of control laws: one row per law. controller_table(), the SIMD lanes and the
// derivatives are all made from it.
#pragma once

#include "sim/controllers/cascade.hpp"
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
                        PidFiltered, Pi2d, PidGravity, PidComputedTorque, Cascade, Neural,
                        PidVelocity, PidPosition>;

}  // namespace armwright::controllers
