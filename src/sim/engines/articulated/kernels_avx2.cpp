// The kernels for AVX2 and FMA. src/CMakeLists.txt sets the compiler flags for it. This file must
// not include a header whose functions are also compiled for other instruction sets.
#include "sim/engines/articulated/lane_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Avx2Level;

void run_segment_avx2(SegmentCall<double>& call) {
  run_segment<lanes::Pair<lanes::Pack<double, 4, Avx2Level>>>(call);
}
void run_plant_avx2(SegmentCall<double>& call) {
  run_plant<lanes::Pack<double, 4, Avx2Level>>(call);
}
void run_segment_avx2(SegmentCall<float>& call) {
  run_segment<lanes::Pair<lanes::Pack<float, 8, Avx2Level>>>(call);
}
void run_plant_avx2(SegmentCall<float>& call) {
  run_plant<lanes::Pack<float, 8, Avx2Level>>(call);
}

}  // namespace armwright::articulated

#endif
