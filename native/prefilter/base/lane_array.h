// A few numbers that are calculated with together. Loops over a fixed count are what compilers make
// vector instructions of, for whichever processor they are told of.
#pragma once

#include <cstddef>

namespace prefilter {

template <typename T, int L>
struct alignas(sizeof(T) * 4) LaneArray {
  T v[L] = {};

  T& operator[](int i) { return v[i]; }
  const T& operator[](int i) const { return v[i]; }

  LaneArray& operator+=(const LaneArray& other) {
    for (int i = 0; i < L; ++i) v[i] += other.v[i];
    return *this;
  }
  LaneArray& operator-=(const LaneArray& other) {
    for (int i = 0; i < L; ++i) v[i] -= other.v[i];
    return *this;
  }
  LaneArray& operator*=(const LaneArray& other) {
    for (int i = 0; i < L; ++i) v[i] *= other.v[i];
    return *this;
  }
  LaneArray& operator*=(T factor) {
    for (int i = 0; i < L; ++i) v[i] *= factor;
    return *this;
  }
  friend LaneArray operator+(LaneArray a, const LaneArray& b) { return a += b; }
  friend LaneArray operator-(LaneArray a, const LaneArray& b) { return a -= b; }
  friend LaneArray operator*(LaneArray a, const LaneArray& b) { return a *= b; }
  friend LaneArray operator*(LaneArray a, T factor) { return a *= factor; }

  /// Each converted as by a cast.
  template <typename Other>
  LaneArray<Other, L> as() const {
    LaneArray<Other, L> out;
    for (int i = 0; i < L; ++i) out.v[i] = static_cast<Other>(v[i]);
    return out;
  }
  T sum() const {
    T total{};
    for (int i = 0; i < L; ++i) total += v[i];
    return total;
  }
};

}  // namespace prefilter
