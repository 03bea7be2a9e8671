// The facts about a chain that are known when the kernels are compiled, and loops over its joints
// that are unrolled if the facts allow it.
//
// A shape is the sequence of a chain's groups, twists and offsets: four bits of JointFlag
// (chain_layout.hpp) per joint, the first joint's lowest. For a known shape the compiler resolves
// every branch on it. kAnyShape makes the same decisions at run time and does the same arithmetic.
// So the results are the same, except for differences in the last bits that the compiler causes.
#pragma once

#include "sim/dynamics/chain_layout.hpp"
#include "sim/simd/lane_pack.hpp"

namespace armwright::articulated {

// A list of N packs inside the object, or, for N = 0, of any number of packs in the caller's
// memory. place() takes that memory: it advances `memory` by `size` packs.
template <class V, int N>
struct PackList {
  V values[N];
  ARMWRIGHT_INLINE V& operator[](int i) { return values[i]; }
  ARMWRIGHT_INLINE const V& operator[](int i) const { return values[i]; }
  ARMWRIGHT_INLINE void place(V*&, int) {}
};
template <class V>
struct PackList<V, 0> {
  V* values = nullptr;
  ARMWRIGHT_INLINE V& operator[](int i) { return values[i]; }
  ARMWRIGHT_INLINE const V& operator[](int i) const { return values[i]; }
  ARMWRIGHT_INLINE void place(V*& memory, int size) {
    values = memory;
    memory += size;
  }
};

// A joint's number that is known at compile time.
template <int I>
struct JointIndex {
  static constexpr int kValue = I;
  ARMWRIGHT_INLINE constexpr operator int() const { return I; }
};

using Shape = std::uint64_t;
inline constexpr Shape kAnyShape = ~Shape{0};
inline constexpr int kShapeBits = 4;

// A vertical axis, then three parallel axes perpendicular to it: palletising arms, such as the
// thesis's.
inline constexpr Shape kPalletiser = Shape{kAlongX} | Shape{kRightAngle | kAlongX} << kShapeBits |
                                     Shape{kSameAxis | kAlongX} << 2 * kShapeBits |
                                     Shape{kSameAxis | kAlongX} << 3 * kShapeBits;

// Returns whether the flags contain all flags of the shape. They may contain more, except
// kPrismatic and kSameAxis, which must be equal.
ARMWRIGHT_INLINE bool has_shape(const std::uint8_t* flags, int joints, Shape shape) {
  for (int i = 0; i < joints; ++i) {
    const int wanted = static_cast<int>(shape >> (kShapeBits * i)) & ((1 << kShapeBits) - 1);
    if ((flags[i] & (kPrismatic | kSameAxis)) != (wanted & (kPrismatic | kSameAxis)) ||
        (flags[i] & wanted) != wanted) {
      return false;
    }
  }
  return true;
}

// The shape of one chain. N is the number of joints, or 0 for any number. kSlidingJoints says that
// joints may be prismatic. If it is false, masses and some moments are always zero
// (chain_model.hpp), and the kernels leave them out.
template <int N, Shape kShape, bool kSlidingJoints>
class ChainShape {
 public:
  static constexpr int kJoints = N;
  static constexpr bool kSliding = kSlidingJoints;
  static constexpr bool kKnown = kShape != kAnyShape;

  ARMWRIGHT_INLINE ChainShape(int joints, const std::uint8_t* flags, bool tilted_gravity)
      : joints_(joints), flags_(flags), tilted_gravity_(tilted_gravity) {
    if constexpr (!kSliding && !kKnown) {
      base_end_ = 1;
      while (base_end_ < joints && same_axis(base_end_)) {
        ++base_end_;
      }
    }
  }

  ARMWRIGHT_INLINE constexpr int joints() const {
    if constexpr (N > 0) {
      return N;
    } else {
      return joints_;
    }
  }
  ARMWRIGHT_INLINE bool tilted_gravity() const { return !kKnown && tilted_gravity_; }
  ARMWRIGHT_INLINE constexpr bool has(JointFlag flag, int i) const {
    if constexpr (kKnown) {
      return (kShape >> (kShapeBits * i) & flag) != 0;
    } else {
      return (flags_[i] & flag) != 0;
    }
  }
  ARMWRIGHT_INLINE constexpr bool slides(int i) const { return kSliding && has(kPrismatic, i); }
  ARMWRIGHT_INLINE constexpr bool same_axis(int i) const { return has(kSameAxis, i); }
  ARMWRIGHT_INLINE constexpr bool right_angle(int i) const { return has(kRightAngle, i); }
  ARMWRIGHT_INLINE constexpr bool along_x(int i) const { return has(kAlongX, i); }
  ARMWRIGHT_INLINE constexpr bool last_of_group(int i) const {
    return i + 1 == joints() || !same_axis(i + 1);
  }
  // in_first_group(): whether joint i belongs to the group on the base. in_base_group(): whether
  // the kernels also use their shorter code for that group, which needs revolute joints.
  ARMWRIGHT_INLINE constexpr bool in_first_group(int i) const {
    if constexpr (!kSliding && !kKnown) {
      return i < base_end_;
    } else {
      return in_same_group(0, i);
    }
  }
  ARMWRIGHT_INLINE constexpr bool in_base_group(int i) const {
    return !kSliding && in_first_group(i);
  }
  ARMWRIGHT_INLINE constexpr bool in_same_group(int i, int j) const {  // i <= j
    for (int k = i + 1; k <= j; ++k) {
      if (!same_axis(k)) {
        return false;
      }
    }
    return true;
  }
  ARMWRIGHT_INLINE constexpr bool in_last_group(int i) const {
    return in_same_group(i, joints() - 1);
  }

  // Loops that call body(i) for joints in ascending or descending order. i is a JointIndex for a
  // known shape and an int otherwise.
  ARMWRIGHT_INLINE auto end() const {
    if constexpr (kKnown) {
      return JointIndex<N>{};
    } else {
      return joints();
    }
  }
  template <class Index>
  ARMWRIGHT_INLINE static auto next(Index i) {
    if constexpr (kKnown) {
      return JointIndex<Index::kValue + 1>{};
    } else {
      return i + 1;
    }
  }
  template <class Index, class Body>
  ARMWRIGHT_INLINE void for_from(Index first, Body body) const {
    if constexpr (kKnown) {
      unroll<Index::kValue, N>(body);
    } else {
      for (int i = first; i < joints(); ++i) {
        body(i);
      }
    }
  }
  template <class Body>
  ARMWRIGHT_INLINE void for_up(Body body) const {
    if constexpr (kKnown) {
      unroll<0, N>(body);
    } else {
      for (int i = 0; i < joints(); ++i) {
        body(i);
      }
    }
  }
  template <class Index, class Body>
  ARMWRIGHT_INLINE void for_below(Index last, Body body) const {
    if constexpr (kKnown) {
      unroll<0, Index::kValue>(body);
    } else {
      for (int i = 0; i < last; ++i) {
        body(i);
      }
    }
  }
  template <class Index, class Body>
  ARMWRIGHT_INLINE void for_down(Index above, Body body) const {
    if constexpr (kKnown) {
      unroll_down<Index::kValue - 1>(body);
    } else {
      for (int i = above - 1; i >= 0; --i) {
        body(i);
      }
    }
  }

 private:
  template <int I, int End, class Body>
  ARMWRIGHT_INLINE static void unroll(Body& body) {
    if constexpr (I < End) {
      body(JointIndex<I>{});
      unroll<I + 1, End>(body);
    }
  }
  template <int I, class Body>
  ARMWRIGHT_INLINE static void unroll_down(Body& body) {
    if constexpr (I >= 0) {
      body(JointIndex<I>{});
      unroll_down<I - 1>(body);
    }
  }

  int joints_;
  const std::uint8_t* flags_;
  bool tilted_gravity_;
  int base_end_ = 0;
};

}  // namespace armwright::articulated
