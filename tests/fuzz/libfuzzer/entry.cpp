// What libFuzzer calls: compiled once for every harness, ARMWRIGHT_HARNESS.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <string_view>

#include "fuzz/harness.hpp"

namespace {

// Of processor time: libFuzzer's own limit counts the time on the wall, and a busy machine is no
// bug. Sanitizers included, so that users wait for half a second at most.
constexpr double kLongest_s = 2;

[[noreturn]] void fail(const char* what) {
  std::fprintf(stderr, "neither read nor refused: %s\n", what);
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::clock_t before = std::clock();
  try {
    armwright::fuzz::ARMWRIGHT_HARNESS({reinterpret_cast<const char*>(data), size});
  } catch (const std::exception& error) {
    fail(error.what());
  }
  if (static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC > kLongest_s) {
    fail("it took more than 2 s of processor time");
  }
  return 0;
}
