#include "sim/tracking/simulation.hpp"

namespace armwright {

const char* to_string(SimulationStatus status) {
  switch (status) {
    case SimulationStatus::ok:
      return "ok";
    case SimulationStatus::cut_off:
      return "cut_off";
    case SimulationStatus::diverged:
      return "diverged";
    case SimulationStatus::unreachable:
      return "unreachable";
    case SimulationStatus::abandoned:
      return "abandoned";
  }
  return "?";
}

}  // namespace armwright
