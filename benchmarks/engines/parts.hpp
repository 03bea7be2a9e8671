// Measures parts of a step of the engine `articulated` alone, in double precision. The controllers
// and the sums of efforts are not measured; they are the rest of the whole step. Parts overlap in
// the processor, so they need not add up exactly.
#pragma once

#include <cstdint>

#include "sim/simd/simd_level.hpp"

namespace armwright::benchmarks {

enum class Part : std::uint8_t {
  sine_cosine,      // of three angles, as in steps without measuring
  dynamics,         // equations of motion and their solution
  posture_and_tip,  // sine and cosine of four angles, and the tip's position: while measuring
};
inline constexpr Part kParts[] = {Part::sine_cosine, Part::dynamics, Part::posture_and_tip};

constexpr const char* to_string(Part part) {
  return part == Part::sine_cosine ? "sine_cosine"
         : part == Part::dynamics  ? "dynamics"
                                   : "posture_and_tip";
}

struct PartsChain {
  int joints;
  const std::uint8_t* flags;
  bool tilted_gravity;
  const double* numbers;  // ChainModel::numbers()
};

// Runs a part `rounds` times, each round depending on the one before. Returns the count of lanes.
int run_part(SimdLevel level, Part part, const PartsChain& chain, int rounds);

int run_part_scalar(Part part, const PartsChain& chain, int rounds);
int run_part_sse2(Part part, const PartsChain& chain, int rounds);
int run_part_avx2(Part part, const PartsChain& chain, int rounds);
int run_part_avx512(Part part, const PartsChain& chain, int rounds);

}  // namespace armwright::benchmarks
