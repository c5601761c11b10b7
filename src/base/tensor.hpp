/// Small fixed-size vectors and tensors for code outside the SIMD sweeps. Frame: the scene's Cartesian x, y, z.
#pragma once

#include <array>
#include <cmath>

namespace stirsph {

/// A vector in 3-D space. Two-dimensional spaces embed their points with z = 0.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  double& operator[](int i) { return i == 0 ? x : i == 1 ? y : z; }
  double operator[](int i) const { return i == 0 ? x : i == 1 ? y : z; }
  Vec3& operator+=(const Vec3& b) { return x += b.x, y += b.y, z += b.z, *this; }
  Vec3& operator-=(const Vec3& b) { return x -= b.x, y -= b.y, z -= b.z, *this; }
  Vec3& operator*=(double s) { return x *= s, y *= s, z *= s, *this; }
  friend Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
  friend Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
  friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  friend Vec3 operator*(Vec3 a, double s) { return a *= s; }
  friend Vec3 operator*(double s, Vec3 a) { return a *= s; }
  friend Vec3 operator/(Vec3 a, double s) { return a *= 1.0 / s; }
  friend bool operator==(const Vec3&, const Vec3&) = default;
};

inline double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
/// a/|a|; the zero vector stays zero.
inline Vec3 normalised(const Vec3& a) {
  const double n = norm(a);
  return n > 0 ? a / n : a;
}
/// `a` turned about a unit axis through the origin (Rodrigues' formula); the angle by its cosine and sine, or in rad.
inline Vec3 rotated(const Vec3& a, const Vec3& axis, double cosine, double sine) {
  return a * cosine + cross(axis, a) * sine + axis * (dot(axis, a) * (1 - cosine));
}
inline Vec3 rotated(const Vec3& a, const Vec3& axis, double angle) {
  return rotated(a, axis, std::cos(angle), std::sin(angle));
}

/// Storage order of symmetric tensors everywhere in the code: xx yy zz xy xz yz.
/// Two-dimensional spaces keep the first four, so a component has the same index in every space.
constexpr int symmetric_index(int i, int j) {
  if (i == j) return i;
  return i + j + 2;  // (0,1) -> 3, (0,2) -> 4, (1,2) -> 5
}

/// A dense N x N matrix, row major.
template <int N>
struct Matrix {
  std::array<double, N * N> a{};
  double& operator()(int i, int j) { return a[i * N + j]; }
  double operator()(int i, int j) const { return a[i * N + j]; }
};

inline double determinant(const Matrix<2>& m) { return m(0, 0) * m(1, 1) - m(0, 1) * m(1, 0); }
inline double determinant(const Matrix<3>& m) {
  return m(0, 0) * (m(1, 1) * m(2, 2) - m(1, 2) * m(2, 1)) - m(0, 1) * (m(1, 0) * m(2, 2) - m(1, 2) * m(2, 0)) +
         m(0, 2) * (m(1, 0) * m(2, 1) - m(1, 1) * m(2, 0));
}

/// Adjugate over determinant; the caller guards against a vanishing determinant.
inline Matrix<2> inverse(const Matrix<2>& m) {
  const double d = 1.0 / determinant(m);
  return {{m(1, 1) * d, -m(0, 1) * d, -m(1, 0) * d, m(0, 0) * d}};
}
inline Matrix<3> inverse(const Matrix<3>& m) {
  const double d = 1.0 / determinant(m);
  Matrix<3> r;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      r(j, i) = (m(i1, j1) * m(i2, j2) - m(i1, j2) * m(i2, j1)) * d;
    }
  }
  return r;
}
template <int N>
Matrix<N> operator*(const Matrix<N>& a, const Matrix<N>& b) {
  Matrix<N> c;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j)
      for (int k = 0; k < N; ++k) c(i, j) += a(i, k) * b(k, j);
  return c;
}

}  // namespace stirsph
