// Reads attributes of URDF elements strictly, with the line in every error.

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <cmath>

#include "base/text.hpp"
#include "sim/robot/urdf_parts.hpp"

namespace armwright {

using tinyxml2::XMLElement;

std::string shorten(std::string_view text) {
  constexpr std::size_t kShown = 80;
  return sanitize(text.substr(0, kShown)) + (text.size() > kShown ? "..." : "");
}

void UrdfXml::fail(const XMLElement& element, const std::string& what) const {
  const int line = element.GetLineNum();
  throw UrdfFault(line, fmt::format("{}:{}: {}: {}", name_, line, where_, what), what);
}

void UrdfXml::fail_as_xacro(const XMLElement& element, const std::string& what) const {
  throw Error(ErrorKind::bad_data, fmt::format("{}:{}: {}: {}; {}", name_, element.GetLineNum(),
                                               where_, what, kXacroAdvice));
}

void UrdfXml::check_spelling(const XMLElement& at, const std::string& what,
                             const std::string& found,
                             const std::vector<std::string>& valid) const {
  if (std::find(valid.begin(), valid.end(), found) == valid.end() && find_nearest(found, valid)) {
    fail(at, describe_unknown(what, found, valid));
  }
}

void UrdfXml::check_names(const XMLElement& element, const std::vector<std::string>& children,
                          const std::vector<std::string>& attributes) const {
  for (const XMLElement* child = element.FirstChildElement(); child != nullptr;
       child = child->NextSiblingElement()) {
    if (std::string_view(child->Name()).starts_with("xacro:")) {
      fail_as_xacro(*child, fmt::format("<{}> is an element of xacro", shorten(child->Name())));
    }
    check_spelling(*child, fmt::format("element in <{}>", element.Name()), child->Name(), children);
  }
  for (const tinyxml2::XMLAttribute* attribute = element.FirstAttribute(); attribute != nullptr;
       attribute = attribute->Next()) {
    check_spelling(element, fmt::format("attribute of <{}>", element.Name()), attribute->Name(),
                   attributes);
  }
}

const XMLElement* UrdfXml::find_only(const XMLElement& parent, const char* child_name) const {
  const XMLElement* child = parent.FirstChildElement(child_name);
  if (child != nullptr) {
    if (const XMLElement* second = child->NextSiblingElement(child_name)) {
      fail(*second, fmt::format("has a second <{}>; one is allowed", child_name));
    }
  }
  return child;
}

const XMLElement& UrdfXml::get_only(const XMLElement& parent, const char* child_name,
                                    const char* hint) const {
  const XMLElement* child = find_only(parent, child_name);
  if (child == nullptr) {
    fail(parent, fmt::format("has no <{}>; {}", child_name, hint));
  }
  return *child;
}

void UrdfXml::refuse_xacro(const XMLElement& element, const char* attribute,
                           std::string_view text) const {
  if (text.find("${") != std::string_view::npos || text.find("$(") != std::string_view::npos) {
    fail_as_xacro(element, fmt::format("<{}>: {} is '{}', an expression of xacro", element.Name(),
                                       attribute, shorten(text)));
  }
}

std::string UrdfXml::get_text(const XMLElement& element, const char* attribute) const {
  const char* value = element.Attribute(attribute);
  if (value == nullptr || *value == '\0') {
    fail(element, fmt::format("<{}> has no {}; it must have one", element.Name(), attribute));
  }
  const std::size_t bytes = std::string_view(value).size();
  if (bytes > kUrdfTextLimit_bytes) {
    fail(element, fmt::format("<{}>: {} has {} bytes; at most {} are possible", element.Name(),
                              attribute, bytes, kUrdfTextLimit_bytes));
  }
  if (sanitize(value) != value) {
    fail(element, fmt::format("<{}>: {} is '{}'; it must be printable UTF-8", element.Name(),
                              attribute, shorten(value)));
  }
  refuse_xacro(element, attribute, value);
  return value;
}

std::vector<double> UrdfXml::read_numbers(const XMLElement& element, const char* attribute,
                                          std::size_t count,
                                          const std::vector<double>& fallback) const {
  const char* text = element.Attribute(attribute);
  if (text == nullptr) {
    if (fallback.empty()) {
      fail(element, fmt::format("<{}> has no {}; it must have one", element.Name(), attribute));
    }
    return fallback;
  }
  const std::string_view rest(text);
  refuse_xacro(element, attribute, rest);
  std::vector<double> numbers;
  constexpr std::string_view kBlanks = " \t\r\n";
  for (std::size_t at = rest.find_first_not_of(kBlanks); at != std::string_view::npos;) {
    const std::size_t end = std::min(rest.find_first_of(kBlanks, at), rest.size());
    const auto number = parse_finite(rest.substr(at, end - at));
    if (!number || std::abs(*number) > kUrdfLargest || numbers.size() == count) {
      numbers.clear();
      break;
    }
    numbers.push_back(*number);
    at = rest.find_first_not_of(kBlanks, end);
  }
  if (numbers.size() != count) {
    fail(element,
         fmt::format(
             "<{}>: {} is '{}'; it must be {} of at most {:g}, with a decimal point and no unit",
             element.Name(), attribute, shorten(text),
             count == 1 ? "one finite number" : fmt::format("{} finite numbers", count),
             kUrdfLargest));
  }
  return numbers;
}

double UrdfXml::read_number(const XMLElement& element, const char* attribute) const {
  return read_numbers(element, attribute, 1).front();
}

double UrdfXml::read_number(const XMLElement& element, const char* attribute,
                            double fallback) const {
  return read_numbers(element, attribute, 1, {fallback}).front();
}

double UrdfXml::read_not_negative(const XMLElement& element, const char* attribute) const {
  const double value = read_number(element, attribute);
  if (value < 0) {
    fail(element, fmt::format("<{}>: {} is {}; it must be >= 0", element.Name(), attribute, value));
  }
  return value;
}

}  // namespace armwright
