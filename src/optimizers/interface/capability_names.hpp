// The capabilities by name, as plugins declare them and lists show them.
#pragma once

#include <array>

#include "optimizers/interface/optimizer.hpp"

namespace armwright {

struct CapabilityName {
  const char* name;
  bool Capabilities::*member;
};

inline constexpr std::array<CapabilityName, 11> kCapabilityNames{{
    {"bounds", &Capabilities::bounds},
    {"constraints", &Capabilities::constraints},
    {"multi_objective", &Capabilities::multi_objective},
    {"batch", &Capabilities::batch},
    {"noisy", &Capabilities::noisy},
    {"residuals", &Capabilities::residuals},
    {"stochastic", &Capabilities::stochastic},
    {"generations", &Capabilities::generations},
    {"local", &Capabilities::local},
    {"sampling", &Capabilities::sampling},
    {"paced", &Capabilities::paced},
}};

}  // namespace armwright
