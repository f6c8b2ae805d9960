// SPDX-License-Identifier: GPL-3.0-or-later

// Short SIMD vectors. Operators are elementwise; operations without an operator are functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

// PREFILTER_PLAIN_VECTORS selects the plain implementation even if the compiler has vectors.
#if defined(__has_builtin) && !defined(PREFILTER_PLAIN_VECTORS)
#if __has_builtin(__builtin_shufflevector) && __has_builtin(__builtin_convertvector)
#define PREFILTER_COMPILER_VECTORS
#endif
#endif
#if defined(PREFILTER_COMPILER_VECTORS) && defined(__SSE4_1__)
#define PREFILTER_SSE4_1
#include <smmintrin.h>
#endif

namespace prefilter {

/// Plain C++, for compilers without vector extensions. Results are bitwise the same.
template <typename T, int kCount>
struct PlainVector {
  T values[kCount];

  /// Result of comparisons: -1 where they hold, else 0.
  using Mask = PlainVector<
      std::conditional_t<
          sizeof(T) == 8, std::int64_t,
          std::conditional_t<sizeof(T) == 4, std::int32_t,
                             std::conditional_t<sizeof(T) == 2, std::int16_t, std::int8_t>>>,
      kCount>;

  constexpr T& operator[](std::size_t i) { return values[i]; }
  constexpr const T& operator[](std::size_t i) const { return values[i]; }

  template <typename Result = PlainVector, typename Function>
  static constexpr Result each(const Function& function) {
    Result result{};
    for (int i = 0; i < kCount; ++i) {
      result.values[i] = static_cast<std::remove_cvref_t<decltype(result.values[i])>>(function(i));
    }
    return result;
  }
  static constexpr PlainVector all(T value) {
    return each([&](int) { return value; });
  }

  constexpr PlainVector operator-() const {
    return each([&](int i) { return -values[i]; });
  }
  constexpr PlainVector operator~() const {
    return each([&](int i) { return ~values[i]; });
  }

#define PREFILTER_OPERATOR(op)                                                                \
  friend constexpr PlainVector operator op(const PlainVector& a, const PlainVector& b) {      \
    return each([&](int i) { return a.values[i] op b.values[i]; });                           \
  }                                                                                           \
  friend constexpr PlainVector operator op(const PlainVector& a, T b) { return a op all(b); } \
  friend constexpr PlainVector operator op(T a, const PlainVector& b) { return all(a) op b; } \
  constexpr PlainVector& operator op##=(const PlainVector& b) { return *this = *this op b; }  \
  constexpr PlainVector& operator op##=(T b) { return *this = *this op b; }
  PREFILTER_OPERATOR(+)
  PREFILTER_OPERATOR(-)
  PREFILTER_OPERATOR(*)
  PREFILTER_OPERATOR(/)
  PREFILTER_OPERATOR(&)
  PREFILTER_OPERATOR(|)
  PREFILTER_OPERATOR(^)
  PREFILTER_OPERATOR(<<)
  PREFILTER_OPERATOR(>>)
#undef PREFILTER_OPERATOR

#define PREFILTER_COMPARISON(op)                                                       \
  friend constexpr Mask operator op(const PlainVector& a, const PlainVector& b) {      \
    return each<Mask>([&](int i) { return a.values[i] op b.values[i] ? -1 : 0; });     \
  }                                                                                    \
  friend constexpr Mask operator op(const PlainVector& a, T b) { return a op all(b); } \
  friend constexpr Mask operator op(T a, const PlainVector& b) { return all(a) op b; }
  PREFILTER_COMPARISON(<)
  PREFILTER_COMPARISON(<=)
  PREFILTER_COMPARISON(>)
  PREFILTER_COMPARISON(>=)
  PREFILTER_COMPARISON(==)
  PREFILTER_COMPARISON(!=)
#undef PREFILTER_COMPARISON
};

template <typename T, int kCount>
constexpr PlainVector<T, kCount> select(const typename PlainVector<T, kCount>::Mask& mask,
                                        const PlainVector<T, kCount>& a,
                                        const PlainVector<T, kCount>& b) {
  return a.each([&](int i) { return mask[i] != 0 ? a[i] : b[i]; });
}

template <int... kPlaces, typename T, int kCount>
constexpr PlainVector<T, sizeof...(kPlaces)> shuffle(const PlainVector<T, kCount>& a,
                                                     const PlainVector<T, kCount>& b) {
  return {{(kPlaces < kCount ? a[kPlaces % kCount] : b[kPlaces % kCount])...}};
}

template <typename To, typename T, int kCount>
constexpr To convert(const PlainVector<T, kCount>& from) {
  return PlainVector<T, kCount>::template each<To>([&](int i) { return from[i]; });
}

#if defined(PREFILTER_COMPILER_VECTORS)
template <typename T, int kCount>
struct CompilerVector {
  using Type [[gnu::vector_size(kCount * sizeof(T))]] = T;
};
template <typename T, int kCount>
using Vector = typename CompilerVector<T, kCount>::Type;

/// Elements of `a` where the mask of a comparison is not 0, else those of `b`.
template <typename Mask, typename Values>
inline Values select(Mask mask, Values a, Values b) {
  return mask ? a : b;
}

/// Elements of `a` followed by `b` at these indices.
template <int... kPlaces, typename Values>
inline auto shuffle(Values a, Values b) {
  return __builtin_shufflevector(a, b, kPlaces...);
}

/// Converts each element like static_cast.
template <typename To, typename From>
inline To convert(From from) {
  return __builtin_convertvector(from, To);
}
#else
template <typename T, int kCount>
using Vector = PlainVector<T, kCount>;
#endif

}  // namespace prefilter
