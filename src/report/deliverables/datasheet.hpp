// The winner of a run on one page of A4: one HTML file without scripts that asks nothing of the
// network, to print and to file.
#pragma once

#include <string>

namespace armwright {

struct FinishedArm;

// The same bytes from the same run, on any day.
std::string make_datasheet(const FinishedArm& arm);

}  // namespace armwright
