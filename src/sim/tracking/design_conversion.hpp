// Designs for other controllers, made of PID designs.
#pragma once

#include <string_view>

#include "sim/tracking/tracking.hpp"

namespace armwright {

// The design itself if it is for that controller; otherwise a PID design as the controller's row
// turns its gains into its own (ControllerRow::convert), all else kept. Error{usage} for a
// design of any other controller, and where a gain comes out as no number.
ArmDesign convert_design(const ArmDesign& design, std::string_view controller, double period_s);

}  // namespace armwright
