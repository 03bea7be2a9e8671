// The kernels for AVX-512 (F, VL, DQ, BW). src/CMakeLists.txt sets the compiler flags for it. This
// file must not include a header whose functions are also compiled for other instruction sets.
#include "sim/engines/articulated/lane_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Avx512Level;

void run_segment_avx512(SegmentCall<double>& call) {
  run_segment<lanes::Pack<double, 8, Avx512Level>>(call);
}
void run_plant_avx512(SegmentCall<double>& call) {
  run_plant<lanes::Pack<double, 8, Avx512Level>>(call);
}
void run_segment_avx512(SegmentCall<float>& call) {
  run_segment<lanes::Pack<float, 16, Avx512Level>>(call);
}
void run_plant_avx512(SegmentCall<float>& call) {
  run_plant<lanes::Pack<float, 16, Avx512Level>>(call);
}

}  // namespace armwright::articulated

#endif
