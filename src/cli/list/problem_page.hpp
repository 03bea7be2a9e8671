// The documentation of the shipped problems in Markdown (markdown.hpp).
#pragma once

#include <string>

namespace armwright {

std::string format_problem_page();

}  // namespace armwright
