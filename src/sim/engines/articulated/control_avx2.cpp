// The controllers except the PID, for AVX2 and FMA. src/CMakeLists.txt sets the compiler flags for
// it. This file must not include a header whose functions are also compiled for other instruction
// sets.
#include "sim/engines/articulated/lane_control.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Avx2Level;

template <class T>
using Pack = lanes::Pack<T, 32 / sizeof(T), Avx2Level>;

void find_control_avx2(int law, ControlFunction<double>& control) {
  control = find_control<lanes::Pair<Pack<double>>>(law, controllers::AllLaws{});
}
void find_control_avx2(int law, ControlFunction<float>& control) {
  control = find_control<lanes::Pair<Pack<float>>>(law, controllers::AllLaws{});
}
void find_plant_control_avx2(int law, ControlFunction<double>& control) {
  control = find_control<Pack<double>>(law, controllers::AllLaws{});
}
void find_plant_control_avx2(int law, ControlFunction<float>& control) {
  control = find_control<Pack<float>>(law, controllers::AllLaws{});
}

}  // namespace armwright::articulated

#endif
