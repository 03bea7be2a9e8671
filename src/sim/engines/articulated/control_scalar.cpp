// The controllers except the PID, for one lane on any machine.
#include "sim/engines/articulated/lane_control.hpp"

namespace armwright::articulated {

struct ScalarLevel;

void find_control_scalar(int law, ControlFunction<double>& control) {
  control = find_control<lanes::Single<double, ScalarLevel>>(law, controllers::AllLaws{});
}
void find_control_scalar(int law, ControlFunction<float>& control) {
  control = find_control<lanes::Single<float, ScalarLevel>>(law, controllers::AllLaws{});
}

}  // namespace armwright::articulated
