// Pairs of candidates and cases that are simulated together, numbered in the order in which they
// are best shared out: tiles of as many candidates as an engine has lanes, in each tile case by
// case. So lanes side by side follow the same targets, which are then read once for all, and a
// candidate is done when its tile is.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "problems/interface/problem.hpp"

namespace armwright {

// What outcomes shall carry, where the problem has it.
struct CaseExtras {
  bool residuals = false;
  bool jacobian = false;
};

class CaseBatch {
 public:
  struct Pair {
    std::size_t candidate;
    std::size_t case_index;
  };
  // The outcomes of the pairs from number `first` on. Called once for every pair, from any thread.
  using Take = std::function<void(const CaseBatch& batch, std::size_t first,
                                  std::vector<CaseOutcome> outcomes)>;

  // All of these outlive it.
  CaseBatch(const Problem& problem, std::span<const std::span<const double>> candidates,
            const CaseBlock& block, CaseExtras extras, Take take);

  const Problem& problem() const { return problem_; }
  std::span<const std::span<const double>> candidates() const { return candidates_; }
  const CaseBlock& block() const { return block_; }
  CaseExtras extras() const { return extras_; }
  // How many pairs one call of simulate() should get.
  BatchSize batch_size() const { return batch_size_; }
  std::size_t size() const { return candidates_.size() * block_.numbers.size(); }
  Pair operator[](std::size_t number) const;

  std::vector<CaseJob> make_jobs(std::size_t first, std::size_t count) const;
  void take(std::size_t first, std::vector<CaseOutcome> outcomes) const {
    take_(*this, first, std::move(outcomes));
  }

 private:
  const Problem& problem_;
  std::span<const std::span<const double>> candidates_;
  const CaseBlock& block_;
  CaseExtras extras_;
  BatchSize batch_size_;
  Take take_;
};

}  // namespace armwright
