#include "base/random.hpp"

#include <Random123/philox.h>

#include <cassert>
#include <cmath>

#include "base/hash.hpp"

namespace armwright {

RandomStream::RandomStream(std::string_view name, std::uint64_t index) : index_(index) {
  const auto digest = calc_sha256(name);
  for (std::size_t word = 0; word < key_.size(); ++word) {
    for (std::size_t byte = 0; byte < 8; ++byte) {  // little-endian on every machine
      key_[word] |= static_cast<std::uint64_t>(digest[8 * word + byte]) << (8 * byte);
    }
  }
}

std::uint64_t RandomStream::next_u64() {
  if (used_ == block_.size()) {
    const r123::Philox4x64::ctr_type counter = {{block_number_++, 0, index_, 0}};
    const r123::Philox4x64::key_type key = {{key_[0], key_[1]}};
    const auto numbers = r123::Philox4x64{}(counter, key);
    for (std::size_t i = 0; i < block_.size(); ++i) {
      block_[i] = numbers[i];
    }
    used_ = 0;
  }
  return block_[used_++];
}

double RandomStream::uniform() {
  constexpr double kTwoToMinus53 = 0x1.0p-53;
  return static_cast<double>(next_u64() >> 11) * kTwoToMinus53;
}

double RandomStream::uniform(double lower, double upper) {
  const double number = lower + (upper - lower) * uniform();
  return number < upper ? number : std::nextafter(upper, lower);  // the sum may round up to `upper`
}

std::uint64_t RandomStream::below(std::uint64_t n) {
  assert(n >= 1);
  const std::uint64_t rejected =
      (0 - n) % n;  // the lowest 2^64 mod n values would bias the remainder
  std::uint64_t number = next_u64();
  while (number < rejected) {
    number = next_u64();
  }
  return number % n;
}

bool RandomStream::bernoulli(double probability) {
  return uniform() < probability;
}

double RandomStream::normal() {
  double u = 0;
  double square = 0;
  do {
    u = uniform(-1, 1);
    const double v = uniform(-1, 1);
    square = u * u + v * v;
  } while (square >= 1 || square == 0);
  return u * std::sqrt(-2 * std::log(square) / square);
}

}  // namespace armwright
