// Scalars of YAML 1.1 and 1.2, as every reader takes them: ROS 2's own (rcl_yaml_param_parser, on
// libyaml) as well as others.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// A string in double quotes, of ASCII alone: any printable UTF-8, also what is a line break, a
// number or an indicator to some readers, comes back as it was.
std::string quote_yaml(std::string_view text);
// The same without the quotes, for a comment: no line break, in whatever reader, ends it.
std::string escape_yaml(std::string_view text);

// A number that reads back as the same double and is never taken for an integer, which ROS 2
// refuses for a parameter that is a double: "270000.0", "1.0e+20". Finite ones only.
std::string format_yaml(double value);

}  // namespace armwright
