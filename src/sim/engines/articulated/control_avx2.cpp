// The controllers except the PID, for AVX2 and FMA. src/CMakeLists.txt sets the compiler flags for
// it. This file must not include a header whose functions are also compiled for other instruction
// sets.
#include "sim/engines/articulated/lane_control.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Avx2Level;

void find_control_avx2(int law, ControlFunction<double>& control) {
  control =
      find_control<lanes::Pair<lanes::Pack<double, 4, Avx2Level>>>(law, controllers::AllLaws{});
}
void find_control_avx2(int law, ControlFunction<float>& control) {
  control =
      find_control<lanes::Pair<lanes::Pack<float, 8, Avx2Level>>>(law, controllers::AllLaws{});
}

}  // namespace armwright::articulated

#endif
