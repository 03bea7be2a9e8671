// Which of many treatments cannot be told apart: the groups of a critical-difference diagram.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace armwright {

// The largest sets of two or more of 0, ..., count - 1 in which no two are told apart (none of
// `told_apart`, whose pairs may be in any order, lies in a set), each in ascending order, the sets
// in lexicographic order. One may be in several sets: not being told apart is not transitive.
// These are the maximal cliques of a graph, of which there can be 3^(count/3); nothing if there are
// more than `most`. Source: Bron, C. and Kerbosch, J. 1973, Algorithm 457: finding all cliques of
// an undirected graph, CACM 16(9), with the pivot of Tomita, E., Tanaka, A. and Takahashi, H. 2006,
// Theoretical Computer Science 363(1). Throws std::invalid_argument for a pair that is not of two
// different ones below `count`.
std::optional<std::vector<std::vector<std::size_t>>> find_cliques(
    std::size_t count, std::span<const std::pair<std::size_t, std::size_t>> told_apart,
    std::size_t most);

}  // namespace armwright
