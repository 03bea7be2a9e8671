// Packs of numbers for SIMD code: one number per lane, the same arithmetic in every lane. They use
// the compiler's vector types.
//
// The dynamics are written once, as templates over a "lane type" V. A lane type is a Pack, a Pair
// of packs, a Single (one lane), or a type whose numbers carry derivatives. It has the type Scalar,
// the constant kLanes, the operators + - * / and the free functions below.
//
// Code that includes this header is compiled once per instruction set. The type parameter `Isa`
// makes the types of these compilations different, so the linker never merges their functions. For
// the same reason this header does not use templates of the standard library.
#pragma once

#include <cstdint>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#define ARMWRIGHT_INLINE inline __attribute__((always_inline))

namespace armwright::lanes {

// The integer type that is as wide as T.
template <class T>
struct Bits;
template <>
struct Bits<double> {
  using Type = std::int64_t;
};
template <>
struct Bits<float> {
  using Type = std::int32_t;
};

// The compiler's vector type of W numbers. It is a member of a template of its own because GCC
// otherwise ignores vector_size on a dependent type.
template <class T, int W>
struct VectorOf {
  typedef T Type __attribute__((vector_size(sizeof(T) * W)));
};

// W numbers of type T. A comparison returns a Mask. All bits of a mask's lane are set if the
// comparison holds there; otherwise none is.
template <class T, int W, class Isa>
struct Pack {
  using Scalar = T;
  static constexpr int kLanes = W;
  using Integer = typename Bits<T>::Type;
  using Vector = typename VectorOf<T, W>::Type;
  using Mask = typename VectorOf<Integer, W>::Type;

  Vector v;

  Pack() = default;
  ARMWRIGHT_INLINE Pack(Vector vector) : v(vector) {}
  ARMWRIGHT_INLINE Pack(T scalar) : v(scalar - Vector{}) {}
};

#define ARMWRIGHT_PACK                 \
  template <class T, int W, class Isa> \
  ARMWRIGHT_INLINE
#define ARMWRIGHT_P Pack<T, W, Isa>

ARMWRIGHT_PACK ARMWRIGHT_P operator+(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  return a.v + b.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P operator-(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  return a.v - b.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P operator*(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  return a.v * b.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P operator/(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  return a.v / b.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P operator-(ARMWRIGHT_P a) {
  return -a.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P& operator+=(ARMWRIGHT_P& a, ARMWRIGHT_P b) {
  return a = a + b;
}
ARMWRIGHT_PACK ARMWRIGHT_P& operator-=(ARMWRIGHT_P& a, ARMWRIGHT_P b) {
  return a = a - b;
}
ARMWRIGHT_PACK typename ARMWRIGHT_P::Mask operator<(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  return a.v < b.v;
}
ARMWRIGHT_PACK typename ARMWRIGHT_P::Mask operator>(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  return a.v > b.v;
}

// Returns `yes` in lanes where the mask is set and `no` elsewhere.
ARMWRIGHT_PACK ARMWRIGHT_P select(typename ARMWRIGHT_P::Mask mask, ARMWRIGHT_P yes,
                                  ARMWRIGHT_P no) {
  return mask ? yes.v : no.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P abs(ARMWRIGHT_P a) {
  using P = ARMWRIGHT_P;
  constexpr auto kMagnitude =
      static_cast<typename P::Integer>(~(typename P::Integer{1} << (8 * sizeof(T) - 1)));
  return reinterpret_cast<typename P::Vector>(reinterpret_cast<typename P::Mask>(a.v) &
                                              (kMagnitude - typename P::Mask{}));
}
// min() and max() return b in lanes where a or b is NaN, as the machine's instructions do. They use
// intrinsics because the compiler does not always turn a < b ? a : b into that instruction.
ARMWRIGHT_PACK ARMWRIGHT_P min(ARMWRIGHT_P a, ARMWRIGHT_P b) {
#if defined(__x86_64__)
  if constexpr (sizeof(a.v) == 16 && sizeof(T) == 8) {
    return _mm_min_pd(a.v, b.v);
  } else if constexpr (sizeof(a.v) == 16) {
    return _mm_min_ps(a.v, b.v);
  }
#if defined(__AVX__)
  else if constexpr (sizeof(a.v) == 32 && sizeof(T) == 8) {
    return _mm256_min_pd(a.v, b.v);
  } else if constexpr (sizeof(a.v) == 32) {
    return _mm256_min_ps(a.v, b.v);
  }
#endif
#if defined(__AVX512F__)
  else if constexpr (sizeof(a.v) == 64 && sizeof(T) == 8) {
    return _mm512_min_pd(a.v, b.v);
  } else if constexpr (sizeof(a.v) == 64) {
    return _mm512_min_ps(a.v, b.v);
  }
#endif
#endif
  return a.v < b.v ? a.v : b.v;
}
ARMWRIGHT_PACK ARMWRIGHT_P max(ARMWRIGHT_P a, ARMWRIGHT_P b) {
#if defined(__x86_64__)
  if constexpr (sizeof(a.v) == 16 && sizeof(T) == 8) {
    return _mm_max_pd(a.v, b.v);
  } else if constexpr (sizeof(a.v) == 16) {
    return _mm_max_ps(a.v, b.v);
  }
#if defined(__AVX__)
  else if constexpr (sizeof(a.v) == 32 && sizeof(T) == 8) {
    return _mm256_max_pd(a.v, b.v);
  } else if constexpr (sizeof(a.v) == 32) {
    return _mm256_max_ps(a.v, b.v);
  }
#endif
#if defined(__AVX512F__)
  else if constexpr (sizeof(a.v) == 64 && sizeof(T) == 8) {
    return _mm512_max_pd(a.v, b.v);
  } else if constexpr (sizeof(a.v) == 64) {
    return _mm512_max_ps(a.v, b.v);
  }
#endif
#endif
  return a.v > b.v ? a.v : b.v;
}

// Returns one bit per lane, set if a < b holds there. The first lane has the lowest bit.
ARMWRIGHT_PACK std::uint32_t find_less(ARMWRIGHT_P a, ARMWRIGHT_P b) {
  const typename ARMWRIGHT_P::Mask mask = a.v < b.v;
#if defined(__AVX512F__)
  if constexpr (sizeof(a.v) == 64 && sizeof(T) == 8) {
    return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ);
  } else if constexpr (sizeof(a.v) == 64) {
    return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ);
  }
#endif
#if defined(__AVX__)
  if constexpr (sizeof(a.v) == 32 && sizeof(T) == 8) {
    return static_cast<std::uint32_t>(_mm256_movemask_pd(reinterpret_cast<__m256d>(mask)));
  } else if constexpr (sizeof(a.v) == 32) {
    return static_cast<std::uint32_t>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
  }
#endif
#if defined(__x86_64__)
  if constexpr (sizeof(a.v) == 16 && sizeof(T) == 8) {
    return static_cast<std::uint32_t>(_mm_movemask_pd(reinterpret_cast<__m128d>(mask)));
  } else if constexpr (sizeof(a.v) == 16) {
    return static_cast<std::uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(mask)));
  }
#endif
  std::uint32_t bits = 0;
  for (int i = 0; i < W; ++i) {
    bits |= static_cast<std::uint32_t>(mask[i] & 1) << i;
  }
  return bits;
}

#undef ARMWRIGHT_PACK
#undef ARMWRIGHT_P

// A lane type of one number, for machines without SIMD.
template <class T, class Isa>
struct Single {
  using Scalar = T;
  static constexpr int kLanes = 1;
  T v;

  Single() = default;
  ARMWRIGHT_INLINE Single(T scalar) : v(scalar) {}
};
#define ARMWRIGHT_ONE           \
  template <class T, class Isa> \
  ARMWRIGHT_INLINE
#define ARMWRIGHT_S Single<T, Isa>
ARMWRIGHT_ONE ARMWRIGHT_S operator+(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v + b.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S operator-(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v - b.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S operator*(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v * b.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S operator/(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v / b.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S operator-(ARMWRIGHT_S a) {
  return -a.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S& operator+=(ARMWRIGHT_S& a, ARMWRIGHT_S b) {
  return a = a + b;
}
ARMWRIGHT_ONE ARMWRIGHT_S& operator-=(ARMWRIGHT_S& a, ARMWRIGHT_S b) {
  return a = a - b;
}
ARMWRIGHT_ONE bool operator<(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v < b.v;
}
ARMWRIGHT_ONE bool operator>(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v > b.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S select(bool mask, ARMWRIGHT_S yes, ARMWRIGHT_S no) {
  return mask ? yes : no;
}
ARMWRIGHT_ONE ARMWRIGHT_S abs(ARMWRIGHT_S a) {
  return a.v < 0 ? -a.v : a.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S min(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v < b.v ? a.v : b.v;
}
ARMWRIGHT_ONE ARMWRIGHT_S max(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v > b.v ? a.v : b.v;
}
ARMWRIGHT_ONE std::uint32_t find_less(ARMWRIGHT_S a, ARMWRIGHT_S b) {
  return a.v < b.v ? 1 : 0;
}
#undef ARMWRIGHT_ONE
#undef ARMWRIGHT_S

// A lane type of two packs. Each operation of the dynamics waits for the result of an earlier one;
// two independent sequences of operations use the processor better.
template <class P>
struct Pair {
  using Scalar = typename P::Scalar;
  static constexpr int kLanes = 2 * P::kLanes;
  struct Mask {
    typename P::Mask first, second;
  };
  P first, second;

  Pair() = default;
  // The copies are written out because GCC's own copy stores pieces of 16 bytes. The processor
  // cannot forward these to the wider loads that follow, which is slow.
  ARMWRIGHT_INLINE Pair(const Pair& other) : first(other.first), second(other.second) {}
  ARMWRIGHT_INLINE Pair& operator=(const Pair& other) {
    first = other.first;
    second = other.second;
    return *this;
  }
  ARMWRIGHT_INLINE Pair(P a, P b) : first(a), second(b) {}
  ARMWRIGHT_INLINE Pair(Scalar scalar) : first(scalar), second(scalar) {}
};
#define ARMWRIGHT_PAIR \
  template <class P>   \
  ARMWRIGHT_INLINE
ARMWRIGHT_PAIR Pair<P> operator+(Pair<P> a, Pair<P> b) {
  return {a.first + b.first, a.second + b.second};
}
ARMWRIGHT_PAIR Pair<P> operator-(Pair<P> a, Pair<P> b) {
  return {a.first - b.first, a.second - b.second};
}
ARMWRIGHT_PAIR Pair<P> operator*(Pair<P> a, Pair<P> b) {
  return {a.first * b.first, a.second * b.second};
}
ARMWRIGHT_PAIR Pair<P> operator/(Pair<P> a, Pair<P> b) {
  return {a.first / b.first, a.second / b.second};
}
ARMWRIGHT_PAIR Pair<P> operator-(Pair<P> a) {
  return {-a.first, -a.second};
}
ARMWRIGHT_PAIR Pair<P>& operator+=(Pair<P>& a, Pair<P> b) {
  return a = a + b;
}
ARMWRIGHT_PAIR Pair<P>& operator-=(Pair<P>& a, Pair<P> b) {
  return a = a - b;
}
ARMWRIGHT_PAIR typename Pair<P>::Mask operator<(Pair<P> a, Pair<P> b) {
  return {a.first < b.first, a.second < b.second};
}
ARMWRIGHT_PAIR typename Pair<P>::Mask operator>(Pair<P> a, Pair<P> b) {
  return {a.first > b.first, a.second > b.second};
}
ARMWRIGHT_PAIR Pair<P> select(typename Pair<P>::Mask mask, Pair<P> yes, Pair<P> no) {
  return {select(mask.first, yes.first, no.first), select(mask.second, yes.second, no.second)};
}
ARMWRIGHT_PAIR Pair<P> abs(Pair<P> a) {
  return {abs(a.first), abs(a.second)};
}
ARMWRIGHT_PAIR Pair<P> min(Pair<P> a, Pair<P> b) {
  return {min(a.first, b.first), min(a.second, b.second)};
}
ARMWRIGHT_PAIR Pair<P> max(Pair<P> a, Pair<P> b) {
  return {max(a.first, b.first), max(a.second, b.second)};
}
ARMWRIGHT_PAIR std::uint32_t find_less(Pair<P> a, Pair<P> b) {
  return find_less(a.first, b.first) | find_less(a.second, b.second) << P::kLanes;
}
#undef ARMWRIGHT_PAIR

// A point or a vector in every lane.
template <class V>
struct Vec3 {
  V x, y, z;
};

}  // namespace armwright::lanes
