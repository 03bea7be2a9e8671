// The kernels for one lane on any machine.
#include "sim/engines/articulated/lane_kernel.hpp"

namespace armwright::articulated {

struct ScalarLevel;

void run_segment_scalar(SegmentCall<double>& call) {
  run_segment<lanes::Single<double, ScalarLevel>>(call);
}
void run_plant_scalar(SegmentCall<double>& call) {
  run_plant<lanes::Single<double, ScalarLevel>>(call);
}
void run_segment_scalar(SegmentCall<float>& call) {
  run_segment<lanes::Single<float, ScalarLevel>>(call);
}
void run_plant_scalar(SegmentCall<float>& call) {
  run_plant<lanes::Single<float, ScalarLevel>>(call);
}

}  // namespace armwright::articulated
