// The compiled kernels, one set for every instruction set.
#pragma once

#include "sim/dynamics/chain_layout.hpp"
#include "sim/simd/simd_level.hpp"

namespace armwright::articulated {

template <class T>
struct Kernel {
  void (*run_segment)(SegmentCall<T>& call) = nullptr;
  int lanes = 1;
  // What SegmentCall::control must be for the law in that place of the table.
  void (*find_control)(int law, void (*&control)(SegmentCall<T>& call, int step)) = nullptr;
};

// The level must be supported by this CPU.
template <class T>
Kernel<T> get_kernel(SimdLevel level);

// Each defined in a file that is compiled for its instruction set; see there.
void run_segment_scalar(SegmentCall<double>& call);
void run_segment_scalar(SegmentCall<float>& call);
void run_segment_sse2(SegmentCall<double>& call);
void run_segment_sse2(SegmentCall<float>& call);
void run_segment_avx2(SegmentCall<double>& call);
void run_segment_avx2(SegmentCall<float>& call);
void run_segment_avx512(SegmentCall<double>& call);
void run_segment_avx512(SegmentCall<float>& call);
void find_control_scalar(int law, void (*&control)(SegmentCall<double>& call, int step));
void find_control_scalar(int law, void (*&control)(SegmentCall<float>& call, int step));
void find_control_sse2(int law, void (*&control)(SegmentCall<double>& call, int step));
void find_control_sse2(int law, void (*&control)(SegmentCall<float>& call, int step));
void find_control_avx2(int law, void (*&control)(SegmentCall<double>& call, int step));
void find_control_avx2(int law, void (*&control)(SegmentCall<float>& call, int step));
void find_control_avx512(int law, void (*&control)(SegmentCall<double>& call, int step));
void find_control_avx512(int law, void (*&control)(SegmentCall<float>& call, int step));

}  // namespace armwright::articulated
