// Test cases bred against the designs (schedule `coevolution`): hosts and parasites as in Hillis
// (1990), "Co-evolving parasites improve simulated evolution as an optimization procedure", Physica
// D 42. The parasites are K test cases, genomes of sim/tracking/test_case.hpp.
//
// After a generation, a case j is as hard as the better half of the designs find it:
//   h_j = mean_i clamp(log e_ij - mean_l log e_il, -c, c),   c = log 10,
// e_ij the error of design i on case j: relative to the design's other cases, so that no unit
// matters, and capped, so that one lost target does not outweigh all else. Hopeless designs, for
// which every case is hard, do not count: only the better half does, of those that had all cases.
// The harder half of the cases, rounded up, stays; of the rest a quarter (rounded) are fresh, the
// others children of two different ones that stay: each key from either parent, and with
// probability 1/8 a new one. No case is in the population twice.
//
// Deviations from the source: hosts do not live beside parasites on a grid; every design meets
// every case, as populations here are small and objectives must compare within a generation.
//
// Pure: state follows from the set's name and the evaluations, so that it can be replayed.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/random.hpp"
#include "study/journal/journal.hpp"

namespace armwright {

class CaseBreeder {
 public:
  // `set` is "coevolved/ID"; at least kFewestBredCases cases.
  CaseBreeder(const std::string& set, int cases);

  // The cases of the present generation, the hardest of the last one first.
  const std::vector<std::uint64_t>& genomes() const { return genomes_; }
  // An evaluation of the present generation.
  void learn(const EvaluationRecord& record, double objective);
  // Goes on to the next generation; without evaluations everything stays as it is.
  void breed();

 private:
  struct Host {
    double objective = 0;
    std::vector<double> errors;
  };
  std::uint64_t draw_genome();
  std::uint64_t make_child(std::span<const std::uint64_t> parents);
  bool is_known(std::uint64_t genome, std::span<const std::uint64_t> among) const;
  std::vector<double> calc_hardness() const;

  RandomStream random_;
  std::vector<std::uint64_t> genomes_;
  std::vector<Host> hosts_;
};

}  // namespace armwright
