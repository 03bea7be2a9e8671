#include "sim/tracking/physics_engine.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "base/error.hpp"
#include "base/text.hpp"

namespace armwright {
namespace {

constexpr std::array kPrecisions = {Precision::double_, Precision::single};

}  // namespace

std::vector<double> PhysicsEngine::calc_derivatives(
    const TrackingSetup& /*setup*/, const TrackingJob& /*job*/,
    std::span<const ArmDesign> /*directions*/) const {
  throw std::logic_error("this engine has no derivatives");
}

const char* to_string(Precision precision) {
  return precision == Precision::double_ ? "double" : "float";
}

std::vector<std::string> precision_names() {
  std::vector<std::string> names;
  for (const Precision precision : kPrecisions) {
    names.emplace_back(to_string(precision));
  }
  return names;
}

Precision parse_precision(std::string_view name) {
  const auto found = std::ranges::find_if(
      kPrecisions, [&](Precision precision) { return to_string(precision) == name; });
  if (found == kPrecisions.end()) {
    throw Error(ErrorKind::usage, describe_unknown("precision", name, precision_names()));
  }
  return *found;
}

}  // namespace armwright
