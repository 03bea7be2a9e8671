// Text in the form that HTML and YAML need.
#pragma once

#include <string>
#include <string_view>

namespace armwright {

// Returns the text for use in an HTML element or in a quoted attribute.
std::string escape_html(std::string_view text);

// The functions for YAML write scalars of YAML 1.1 and 1.2 that every reader understands alike,
// also ROS 2's own (rcl_yaml_param_parser, based on libyaml).

// Returns a string in double quotes that holds ASCII only. Every printable UTF-8 text reads back
// as it was, also where some readers see a line break, a number or an indicator in it.
std::string quote_yaml(std::string_view text);
// Returns the same without the quotes, for a comment. No reader finds a line break in it.
std::string escape_yaml(std::string_view text);

// Returns a finite number that reads back as the same double: "270000.0", "1.0e+20". It is never
// read as an integer, which ROS 2 refuses for a parameter of type double.
std::string format_yaml(double value);

}  // namespace armwright
