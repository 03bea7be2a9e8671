// Counter-based random numbers. A stream is a pure function of (name, index), and the n-th number
// of a stream is a pure function of n. No stream depends on another one, on threads or on the order
// of use; so runs can be repeated and resumed. Generator: Philox4x64-10 (Salmon, Moraes, Dror and
// Shaw, SC 2011), from Random123. The key is the SHA-256 of the name.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace armwright {

class RandomStream {
 public:
  // `name` says what the numbers are for ("train/1", "optimizer/ga"). `index` selects one of the
  // 2^64 substreams of the name.
  explicit RandomStream(std::string_view name, std::uint64_t index = 0);

  std::uint64_t next_u64();
  double uniform();                            // in [0, 1), 53 random bits
  double uniform(double lower, double upper);  // in [lower, upper)
  std::uint64_t below(std::uint64_t n);        // in {0, ..., n-1}, unbiased; n >= 1
  bool bernoulli(double probability);          // true with the given probability
  double normal();                             // standard normal (Marsaglia's polar method)

 private:
  std::array<std::uint64_t, 2> key_{};
  std::uint64_t index_ = 0;
  std::uint64_t block_number_ = 0;
  std::array<std::uint64_t, 4> block_{};
  unsigned used_ = 4;
};

}  // namespace armwright
