// The controllers except the PID, for AVX-512. src/CMakeLists.txt sets the compiler flags for it.
// This file must not include a header whose functions are also compiled for other instruction sets.
#include "sim/engines/articulated/lane_control.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Avx512Level;

void find_control_avx512(int law, ControlFunction<double>& control) {
  control = find_control<lanes::Pack<double, 8, Avx512Level>>(law, controllers::AllLaws{});
}
void find_control_avx512(int law, ControlFunction<float>& control) {
  control = find_control<lanes::Pack<float, 16, Avx512Level>>(law, controllers::AllLaws{});
}

}  // namespace armwright::articulated

#endif
