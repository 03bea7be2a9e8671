// The datasheet's figures. Only .cpp files include this.
#pragma once

#include <string>

#include "report/deliverables/finished_arm.hpp"

namespace armwright {

// HTML: how the errors of the test cases are spread, and the tip's error over time in the first of
// them, if the run's folder has that motion. Empty if neither can be drawn.
std::string make_datasheet_figures(const FinishedArm& arm);

}  // namespace armwright
