// The kernels for AVX2 and FMA. src/CMakeLists.txt compiles this file for them; nothing else may be
// included here that other files share functions with.
#include "sim/engines/articulated/lane_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Avx2Level;
void run_segment_avx2(SegmentCall<double>& call);
void run_segment_avx2(SegmentCall<float>& call);

void run_segment_avx2(SegmentCall<double>& call) {
  run_segment<lanes::Pair<lanes::Pack<double, 4, Avx2Level>>>(call);
}
void run_segment_avx2(SegmentCall<float>& call) {
  run_segment<lanes::Pair<lanes::Pack<float, 8, Avx2Level>>>(call);
}

}  // namespace armwright::articulated

#endif
