// Breeds test cases against the designs (schedule `coevolution`), as the hosts and parasites of
// Hillis (1990), "Co-evolving parasites improve simulated evolution as an optimization procedure",
// Physica D 42. The hosts are the designs, and the parasites are K test cases, each encoded as a
// genome (sim/tracking/test_case.hpp).
//
// After a generation, the hardness of case j is its mean over the better half of the designs:
//   h_j = mean_i clamp(log e_ij - mean_l log e_il, -c, c),   c = log 10,
// where e_ij is the error of design i on case j. The hardness is relative to the design's other
// cases, so units do not matter, and capped, so one lost target does not decide. Only the better
// half of the designs that had all cases counts: for hopeless designs every case is hard.
//
// The harder half of the cases, rounded up, stays. Of the other places a quarter (rounded) gets
// new random cases, and the rest gets children of two different cases that stay. A child takes each
// key from either parent, or with probability 1/8 a new random one. No case is in the population
// twice.
//
// Deviations from the source: hosts and parasites do not live on a grid. Every design meets every
// case, because the populations are small and objectives must be comparable within a generation.
//
// The state depends only on the name of the set and on the evaluations, so it can be replayed.
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
  // Draws the first generation. `set` is "coevolved/ID"; `cases` is at least kFewestBredCases.
  CaseBreeder(const std::string& set, int cases);

  // Returns the cases of the present generation; the hardest of the last generation come first.
  const std::vector<std::uint64_t>& genomes() const { return genomes_; }
  // Adds an evaluation of the present generation. Ignores one that did not have all cases.
  void add(const EvaluationRecord& record, double objective);
  // Breeds the next generation. Without evaluations the cases stay as they are.
  void breed();

 private:
  std::uint64_t draw_genome();
  std::uint64_t make_child(std::span<const std::uint64_t> parents);
  bool is_known(std::uint64_t genome, std::span<const std::uint64_t> among) const;
  std::vector<double> calc_hardness() const;

  RandomStream random_;
  std::vector<std::uint64_t> genomes_;
  std::vector<double> objectives_;           // one per design
  std::vector<std::vector<double>> errors_;  // per design, one per case
};

}  // namespace armwright
