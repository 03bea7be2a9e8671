// What kernels must not do: an inline function of everybody's, compiled for the kernels'
// instructions.
#include <algorithm>

struct Avx2Level;

template <class Isa>
[[gnu::noinline]] void use(const double* a) {
  asm volatile("" : : "r"(a));
}

template <class T>
[[gnu::noinline]] T find_largest(const T* numbers, int count) {
  return *std::max_element(numbers, numbers + count);
}

double leak(const double* numbers, int count) {
  use<Avx2Level>(numbers);
  return find_largest(numbers, count);
}
