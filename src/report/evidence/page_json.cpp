#include "report/evidence/page_json.hpp"

#include "base/build_info.hpp"

namespace armwright {
using nlohmann::json;

json finite_or_null(std::span<const double> values) {
  json list = json::array();
  for (const double value : values) {
    list.push_back(finite_or_null(value));
  }
  return list;
}

json make_quantity(const Quantity& quantity) {
  return {{"name", quantity.name}, {"unit", quantity.unit}};
}

json make_fact(std::string_view label, std::string_view value) {
  return {{"label", label}, {"value", value}};
}

json make_program() {
  return {{"version", get_version()}, {"commit", describe_build().at("git")}};
}

std::string dump_page(const json& page) {
  return page.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace armwright
