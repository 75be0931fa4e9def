#pragma once
// Small fixed numbers of doubles that the compiler keeps in vector registers, whatever their width.

#include <cstddef>
#include <cstring>
#include <vector>

namespace whirl::film {

template <int N>
struct VectorOf;
template <>
struct VectorOf<4> {
  typedef double Type __attribute__((vector_size(32)));
};
template <>
struct VectorOf<8> {
  typedef double Type __attribute__((vector_size(64)));
};

template <int N>
struct Lanes {
  using Vector = typename VectorOf<N>::Type;
  Vector v;

  static Lanes fill(double x) { return {Vector{} + x}; }
  static Lanes zero() { return {Vector{}}; }
  /// N doubles from memory of any alignment.
  static Lanes load(const double* x) {
    Lanes p;
    std::memcpy(&p, x, sizeof p);
    return p;
  }
  double operator[](int i) const { return v[i]; }
  void set(int i, double x) { v[i] = x; }
  Lanes& operator+=(Lanes o) { return v += o.v, *this; }
  Lanes& operator-=(Lanes o) { return v -= o.v, *this; }

  friend Lanes operator+(Lanes a, Lanes b) { return {a.v + b.v}; }
  friend Lanes operator-(Lanes a, Lanes b) { return {a.v - b.v}; }
  friend Lanes operator*(Lanes a, Lanes b) { return {a.v * b.v}; }
  friend Lanes operator*(double a, Lanes b) { return {a * b.v}; }
  friend Lanes operator+(double a, Lanes b) { return {a + b.v}; }
  friend Lanes operator/(double a, Lanes b) { return {a / b.v}; }
  friend Lanes operator/(Lanes a, Lanes b) { return {a.v / b.v}; }
  friend Lanes min(Lanes a, Lanes b) { return {a.v < b.v ? a.v : b.v}; }
  friend Lanes max(Lanes a, Lanes b) { return {a.v > b.v ? a.v : b.v}; }
  friend Lanes positive_part(Lanes a) { return {a.v > 0.0 ? a.v : Vector{}}; }
  friend Lanes where_negative(Lanes x, Lanes a) { return {x.v < 0.0 ? a.v : Vector{}}; }
};

using Pack = Lanes<8>;
using Quad = Lanes<4>;
inline constexpr int kLanes = 8;

inline double sum(Pack a) {
  return ((a[0] + a[4]) + (a[1] + a[5])) + ((a[2] + a[6]) + (a[3] + a[7]));
}

inline double lowest(Pack a) {
  using Half = Quad::Vector;
  const Half low = __builtin_shufflevector(a.v, a.v, 0, 1, 2, 3), high = __builtin_shufflevector(a.v, a.v, 4, 5, 6, 7);
  const Half m = low < high ? low : high;
  const double x = m[0] < m[2] ? m[0] : m[2], y = m[1] < m[3] ? m[1] : m[3];
  return x < y ? x : y;
}
inline double highest(Pack a) {
  return -lowest({-a.v});
}

inline std::size_t packs(int n) {
  return static_cast<std::size_t>((n + kLanes - 1) / kLanes);
}
inline double* scalars(std::vector<Pack>& p) {
  return reinterpret_cast<double*>(p.data());
}
inline const double* scalars(const std::vector<Pack>& p) {
  return reinterpret_cast<const double*>(p.data());
}

}  // namespace whirl::film
