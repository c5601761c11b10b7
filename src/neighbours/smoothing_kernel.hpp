/// Smoothing kernels W(r, h) = sigma/h^d w(q), q = r/h, as branch-free polynomials that work on double and on SIMD
/// lanes. Cubic: physics.md section 2 (eq. 6 of the paper with its lost exponents); Wendland: Wendland (1995), scaled
/// to support 2h.
#pragma once

#include <cmath>
#include <numbers>
#include <string_view>
#include <variant>

namespace stirsph {

namespace kernel_detail {
// The compiler would otherwise leave calls in the pair sweeps, which then spill every register around them (a
// factor 1.6 in speed, measured); hence always_inline.

/// max(x, 0) for double; SIMD types bring their own max, found by argument-dependent lookup.
[[gnu::always_inline]] inline double positive_part(double x) { return x > 0 ? x : 0; }
template <class T>
[[gnu::always_inline]] inline T positive_part(const T& x) {
  return max(x, T(0));
}
}  // namespace kernel_detail

/// Each kernel gives w(q), dw/dq, its support in units of h and its normalisation for 2 and 3 dimensions.
struct CubicSpline {
  static constexpr std::string_view keyword = "cubic";
  static constexpr double support = 2;
  static constexpr double normalisation(int dim) {
    return dim == 2 ? 10 / (7 * std::numbers::pi) : 1 / std::numbers::pi;
  }
  template <class T>
  [[gnu::always_inline]] static T value(const T& q) {
    const T a = kernel_detail::positive_part(T(2 - q)), b = kernel_detail::positive_part(T(1 - q));
    return 0.25 * a * a * a - b * b * b;
  }
  template <class T>
  [[gnu::always_inline]] static T slope(const T& q) {
    const T a = kernel_detail::positive_part(T(2 - q)), b = kernel_detail::positive_part(T(1 - q));
    return 3 * b * b - 0.75 * a * a;
  }
};

struct WendlandC2 {
  static constexpr std::string_view keyword = "wendland_c2";
  static constexpr double support = 2;
  static constexpr double normalisation(int dim) {
    return dim == 2 ? 7 / (4 * std::numbers::pi) : 21 / (16 * std::numbers::pi);
  }
  template <class T>
  [[gnu::always_inline]] static T value(const T& q) {
    const T a = kernel_detail::positive_part(T(1 - 0.5 * q)), a2 = a * a;
    return a2 * a2 * (2 * q + 1);
  }
  template <class T>
  [[gnu::always_inline]] static T slope(const T& q) {
    const T a = kernel_detail::positive_part(T(1 - 0.5 * q));
    return -5 * q * a * a * a;
  }
};

struct WendlandC4 {
  static constexpr std::string_view keyword = "wendland_c4";
  static constexpr double support = 2;
  static constexpr double normalisation(int dim) {
    return dim == 2 ? 9 / (4 * std::numbers::pi) : 495 / (256 * std::numbers::pi);
  }
  template <class T>
  [[gnu::always_inline]] static T value(const T& q) {
    const T a = kernel_detail::positive_part(T(1 - 0.5 * q)), a2 = a * a;
    return a2 * a2 * a2 * (35.0 / 12 * q * q + 3 * q + 1);
  }
  template <class T>
  [[gnu::always_inline]] static T slope(const T& q) {
    const T a = kernel_detail::positive_part(T(1 - 0.5 * q)), a2 = a * a;
    return -7.0 / 3 * q * (5 * q + 2) * a2 * a2 * a;
  }
};

struct QuinticSpline {
  static constexpr std::string_view keyword = "quintic";
  static constexpr double support = 3;
  static constexpr double normalisation(int dim) {
    return dim == 2 ? 7 / (478 * std::numbers::pi) : 1 / (120 * std::numbers::pi);
  }
  template <class T>
  [[gnu::always_inline]] static T value(const T& q) {
    const T a = kernel_detail::positive_part(T(3 - q)), b = kernel_detail::positive_part(T(2 - q)),
            c = kernel_detail::positive_part(T(1 - q));
    const T a2 = a * a, b2 = b * b, c2 = c * c;
    return a2 * a2 * a - 6 * b2 * b2 * b + 15 * c2 * c2 * c;
  }
  template <class T>
  [[gnu::always_inline]] static T slope(const T& q) {
    const T a = kernel_detail::positive_part(T(3 - q)), b = kernel_detail::positive_part(T(2 - q)),
            c = kernel_detail::positive_part(T(1 - q));
    const T a2 = a * a, b2 = b * b, c2 = c * c;
    return -5 * a2 * a2 + 30 * b2 * b2 - 75 * c2 * c2;
  }
};

/// The kernel chosen by the scene; std::visit gives the compile-time type back.
using Kernel = std::variant<CubicSpline, WendlandC2, WendlandC4, QuinticSpline>;

inline double kernel_support(const Kernel& kernel) {
  return std::visit([]<class K>(const K&) { return K::support; }, kernel);
}
/// W(r, h) [1/m^d].
template <class K>
double kernel_value(double r, double h, int dim) {
  return K::normalisation(dim) / std::pow(h, dim) * K::value(r / h);
}
/// dW/dr [1/m^(d+1)].
template <class K>
double kernel_slope(double r, double h, int dim) {
  return K::normalisation(dim) / std::pow(h, dim + 1) * K::slope(r / h);
}

}  // namespace stirsph
