#include "study/statistics/cliques.hpp"

#include <algorithm>
#include <stdexcept>

namespace armwright {
namespace {

using Set = std::vector<std::size_t>;  // in ascending order

class Search {
 public:
  Search(std::vector<std::vector<bool>> joined, std::size_t most)
      : joined_(std::move(joined)), most_(most) {}

  // False as soon as there are more than `most`.
  bool extend(Set& clique, Set candidates, Set excluded) {
    if (candidates.empty()) {
      if (excluded.empty() && clique.size() > 1) {
        found_.push_back(clique);
        std::ranges::sort(found_.back());
      }
      return found_.size() <= most_;
    }
    const std::size_t pivot = choose_pivot(candidates, excluded);
    for (const std::size_t next : Set(candidates)) {
      if (joined_[pivot][next]) {
        continue;  // comes up with the pivot, or with one that is not joined to it
      }
      clique.push_back(next);
      const bool goes_on =
          extend(clique, keep_joined(candidates, next), keep_joined(excluded, next));
      clique.pop_back();
      if (!goes_on) {
        return false;
      }
      std::erase(candidates, next);
      excluded.push_back(next);
    }
    return true;
  }

  std::vector<Set> take_found() {
    std::ranges::sort(found_);
    return std::move(found_);
  }

 private:
  Set keep_joined(const Set& set, std::size_t to) const {
    Set kept;
    std::ranges::copy_if(set, std::back_inserter(kept),
                         [&](std::size_t one) { return joined_[to][one]; });
    return kept;
  }

  // That with the most candidates joined to it: those need no branch of their own.
  std::size_t choose_pivot(const Set& candidates, const Set& excluded) const {
    std::size_t pivot = candidates.front();
    std::size_t most = 0;
    for (const Set* set : {&candidates, &excluded}) {
      for (const std::size_t one : *set) {
        const std::size_t joined = keep_joined(candidates, one).size();
        if (joined > most) {
          pivot = one;
          most = joined;
        }
      }
    }
    return pivot;
  }

  std::vector<std::vector<bool>> joined_;
  std::size_t most_;
  std::vector<Set> found_;
};

}  // namespace

std::optional<std::vector<std::vector<std::size_t>>> find_cliques(
    std::size_t count, std::span<const std::pair<std::size_t, std::size_t>> told_apart,
    std::size_t most) {
  std::vector<std::vector<bool>> joined(count, std::vector<bool>(count, true));
  Set all;
  for (std::size_t i = 0; i < count; ++i) {
    joined[i][i] = false;
    all.push_back(i);
  }
  for (const auto& [a, b] : told_apart) {
    if (a >= count || b >= count || a == b) {
      throw std::invalid_argument(
          "a pair told apart is not of two different ones of those there are");
    }
    joined[a][b] = joined[b][a] = false;
  }
  Search search(std::move(joined), most);
  Set clique;
  if (!search.extend(clique, all, {})) {
    return std::nullopt;
  }
  return search.take_found();
}

}  // namespace armwright
