// The controllers except the PID, for SSE2, which every x86-64 CPU has.
#include "sim/engines/articulated/lane_control.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Sse2Level;

void find_control_sse2(int law, ControlFunction<double>& control) {
  control = find_control<lanes::Pack<double, 2, Sse2Level>>(law, controllers::AllLaws{});
}
void find_control_sse2(int law, ControlFunction<float>& control) {
  control = find_control<lanes::Pack<float, 4, Sse2Level>>(law, controllers::AllLaws{});
}

}  // namespace armwright::articulated

#endif
