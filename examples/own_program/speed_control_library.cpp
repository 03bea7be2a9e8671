// The same problem as a shared library: armwright optimize ./libspeed_control.so
#include "speed_control.hpp"

ARMWRIGHT_PROBLEM(SpeedControl)
