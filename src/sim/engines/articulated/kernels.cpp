#include "sim/engines/articulated/kernels.hpp"

#include "sim/simd/simd_level.hpp"

namespace armwright::articulated {

template <class T>
Kernels<T> get_kernels(SimdLevel level) {
#if defined(__x86_64__)
  constexpr int kPerSixteenBytes = 16 / sizeof(T);
  switch (level) {
    case SimdLevel::avx512:
      return {{run_segment_avx512, 4 * kPerSixteenBytes, find_control_avx512},
              {run_plant_avx512, 4 * kPerSixteenBytes, find_control_avx512}};
    case SimdLevel::avx2:
      return {{run_segment_avx2, 4 * kPerSixteenBytes, find_control_avx2},
              {run_plant_avx2, 2 * kPerSixteenBytes, find_plant_control_avx2}};
    case SimdLevel::sse2:
      return {{run_segment_sse2, kPerSixteenBytes, find_control_sse2},
              {run_plant_sse2, kPerSixteenBytes, find_control_sse2}};
    case SimdLevel::scalar:
      break;
  }
#else
  (void)level;  // only `scalar` is supported
#endif
  return {{run_segment_scalar, 1, find_control_scalar}, {run_plant_scalar, 1, find_control_scalar}};
}

template Kernels<double> get_kernels<double>(SimdLevel level);
template Kernels<float> get_kernels<float>(SimdLevel level);

}  // namespace armwright::articulated
