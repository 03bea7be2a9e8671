// The kernels for SSE2, which every x86-64 CPU has.
#include "sim/engines/articulated/lane_kernel.hpp"

#if defined(__x86_64__)

namespace armwright::articulated {

struct Sse2Level;

void run_segment_sse2(SegmentCall<double>& call) {
  run_segment<lanes::Pack<double, 2, Sse2Level>>(call);
}
void run_plant_sse2(SegmentCall<double>& call) {
  run_plant<lanes::Pack<double, 2, Sse2Level>>(call);
}
void run_segment_sse2(SegmentCall<float>& call) {
  run_segment<lanes::Pack<float, 4, Sse2Level>>(call);
}
void run_plant_sse2(SegmentCall<float>& call) {
  run_plant<lanes::Pack<float, 4, Sse2Level>>(call);
}

}  // namespace armwright::articulated

#endif
