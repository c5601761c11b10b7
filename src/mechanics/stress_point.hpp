/// Hypoelastic-plastic stress integration at a point (or eight): Jaumann rate, Hooke's law, J2 radial return.
///
/// The velocity gradient refers to the middle of the step. The stress is turned by the Hughes-Winget rotation
/// Q = (I - dt/2 W)^-1 (I + dt/2 W), which is exactly orthogonal, so spinning never grows the stress (case B5 of the
/// verification catalogue); half of the elastic increment is added before and half after the rotation, which makes the
/// integration second order in dt (Hughes & Winget 1980). The mean stress is a state function, K ln(rho0/rho): the
/// exact integral of Hooke's law for the volume.
#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "base/tensor.hpp"
#include "mechanics/lane_matrix.hpp"

namespace stirsph {

/// Deformation of one step in the middle configuration. Symmetric tensors in the order xx yy zz xy xz yz (2-D: first
/// four).
template <class S, class T>
struct StepDeformation {
  T rate[S::stress_components];           ///< D [1/s], trace removed
  T dilatation;                           ///< trace of D [1/s]
  LaneMatrix<T, S::tensor_dim> rotation;  ///< Q
};

/// Velocity gradient with respect to the end positions -> with respect to the middle of the step. With u = v dt,
/// d/dx_mid = d/dx_end (I - dt/2 L)^-1; exact for an affine step, so a rigid rotation has no spurious dilatation.
template <class T, int N>
LaneMatrix<T, N> to_midstep(const LaneMatrix<T, N>& gradient, double dt) {
  LaneMatrix<T, N> m;
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) m.a[i][j] = (i == j ? T(1.0) : T(0.0)) - T(0.5 * dt) * gradient.a[i][j];
  LaneMatrix<T, N> result = multiply(gradient, adjugate(m));
  const T scale = T(1.0) / determinant(m);
  for (int i = 0; i < N; ++i)
    for (int j = 0; j < N; ++j) result.a[i][j] = result.a[i][j] * scale;
  return result;
}

template <class S, class T>
StepDeformation<S, T> step_deformation(const LaneMatrix<T, S::tensor_dim>& gradient, double dt) {
  constexpr int dim = S::tensor_dim;
  StepDeformation<S, T> step;
  T trace = gradient.a[0][0];
  for (int i = 1; i < dim; ++i) trace += gradient.a[i][i];
  step.dilatation = trace;
  for (int i = 0; i < S::stress_components; ++i) step.rate[i] = T(0.0);
  for (int i = 0; i < dim; ++i)
    for (int j = i; j < dim; ++j) step.rate[symmetric_index(i, j)] = T(0.5) * (gradient.a[i][j] + gradient.a[j][i]);
  for (int i = 0; i < 3; ++i) step.rate[i] = step.rate[i] - trace * T(1.0 / 3);

  LaneMatrix<T, dim> half_turn;  // dt/2 W
  T square = T(0.0);
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) {
      half_turn.a[i][j] = T(0.25 * dt) * (gradient.a[i][j] - gradient.a[j][i]);
      if (i < j) square += half_turn.a[i][j] * half_turn.a[i][j];
    }
  // (I - A)^-1 (I + A) = I + 2/(1 + |a|^2) (A + A^2) for a skew A with axial vector a, in two and three dimensions.
  const LaneMatrix<T, dim> twice = multiply(half_turn, half_turn);
  const T factor = T(2.0) / (T(1.0) + square);
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j)
      step.rotation.a[i][j] = (i == j ? T(1.0) : T(0.0)) + factor * (half_turn.a[i][j] + twice.a[i][j]);
  return step;
}

/// Q s Q^T of a symmetric tensor.
template <class S, class T>
void rotate(T (&s)[S::stress_components], const LaneMatrix<T, S::tensor_dim>& q) {
  constexpr int dim = S::tensor_dim;
  LaneMatrix<T, dim> full, left;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) full.a[i][j] = s[symmetric_index(i < j ? i : j, i < j ? j : i)];
  left = multiply(q, full);
  for (int i = 0; i < dim; ++i)
    for (int j = i; j < dim; ++j) {
      T sum = left.a[i][0] * q.a[j][0];
      for (int k = 1; k < dim; ++k) sum += left.a[i][k] * q.a[j][k];
      s[symmetric_index(i, j)] = sum;
    }
}

/// Deviatoric work per volume [J/m3] that the step's strain does on the old and on the trial stress. In an elastic step
/// their mean is exactly the change of the stored energy s:s/4G: with e = G D dt the trial is s' = Q (s + e) Q^T + e,
/// so |s' - e| = |s + e| and s':s' - s:s = 2 e:(s + s'). (The old stress as it was, not turned.)
template <class T>
struct TrialWork {
  T old_stress, trial_stress;
};

/// Turns the old deviator and adds the elastic increment; on return `s` is the trial deviator and `turned` the old one
/// in the same frame.
template <class S, class T>
TrialWork<T> elastic_trial(T (&s)[S::stress_components], T (&turned)[S::stress_components],
                           const StepDeformation<S, T>& step, const T& shear_modulus, double dt) {
  TrialWork<T> work{T(0.0), T(0.0)};
  for (int c = 0; c < S::stress_components; ++c) turned[c] = s[c];
  rotate<S>(turned, step.rotation);
  for (int c = 0; c < S::stress_components; ++c) {
    work.old_stress += s[c] * (T(c < 3 ? dt : 2 * dt) * step.rate[c]);
    s[c] = s[c] + shear_modulus * T(dt) * step.rate[c];  // half of 2 G D dt
  }
  rotate<S>(s, step.rotation);
  for (int c = 0; c < S::stress_components; ++c) {
    s[c] = s[c] + shear_modulus * T(dt) * step.rate[c];
    work.trial_stress += s[c] * (T(c < 3 ? dt : 2 * dt) * step.rate[c]);
  }
  return work;
}

/// sqrt(3/2 s:s).
template <class S, class T>
T equivalent_stress(const T (&s)[S::stress_components]) {
  using std::sqrt;
  T sum = T(0.0);
  for (int c = 0; c < S::stress_components; ++c) sum += (c < 3 ? T(1.5) : T(3.0)) * s[c] * s[c];
  return sqrt(sum);
}

/// a:b of two symmetric tensors.
template <class S, class A, class B>
auto contraction(const A& a, const B& b) {
  using T = std::remove_cvref_t<decltype(a[0])>;
  T sum = T(0.0);
  for (int c = 0; c < S::stress_components; ++c) sum += T(c < 3 ? 1.0 : 2.0) * a[c] * b[c];
  return sum;
}

/// Brings a trial deviator back to the yield surface, |s| = sqrt(2/3) sigma_y. Its size follows from the return map;
/// its direction is the exact solution for a constant strain rate (Krieg & Krieg 1977): after an elastic part of the
/// step that reaches the surface, the stress turns towards the strain increment, tan(psi/2) falling as exp(-2 G |D|
/// t/R). A radial return is first order in the direction when the flow turns; this is second order and just as stable
/// for large steps. Lanes that do not yield must be ignored by the caller.
template <class S, class T>
void plastic_return(const T (&turned)[S::stress_components], const T& flow_stress, T (&s)[S::stress_components]) {
  using std::sqrt;
  using stdx::sqrt;
  const auto least = [](const T& a, const T& b) { return select(a < b, a, b); };
  const T radius = std::sqrt(2.0 / 3) * flow_stress;
  T increment[S::stress_components], base[S::stress_components];
  for (int c = 0; c < S::stress_components; ++c) increment[c] = s[c] - turned[c];
  const T size2 = contraction<S>(increment, increment), old2 = contraction<S>(turned, turned);
  // Stress that lies outside because the flow stress fell starts from the surface. The share of the step that is
  // elastic ends where the straight path leaves the surface: also when it starts there and first cuts through (reversed
  // loading).
  const T scale = select(old2 > radius * radius, T(radius / sqrt(old2)), T(1.0));
  const T along = scale * contraction<S>(turned, increment);
  const T inside = radius * radius - least(old2, T(radius * radius));
  const T leaves = sqrt(T(along * along + size2 * inside)) - along, elastic = leaves / size2;
  // (Almost) no strain beside the fall of the flow stress: straight back.
  const auto straight = size2 <= T(1e-24 * old2) || leaves >= size2;
  const T back = radius / sqrt(contraction<S>(s, s));
  for (int c = 0; c < S::stress_components; ++c) base[c] = scale * turned[c] + elastic * increment[c];

  const T size = sqrt(size2), decay = exponential(T(-(1.0 - elastic) * size / radius));
  const T cosine = contraction<S>(base, increment) / (radius * size);
  const T ahead = 1.0 + cosine, behind = (1.0 - cosine) * decay * decay;
  const T keep = 2.0 * decay / (ahead + behind);
  const T turn = ((ahead - behind) / (ahead + behind) - keep * cosine) * radius / size;
  for (int c = 0; c < S::stress_components; ++c)
    s[c] = select(straight, T(s[c] * back), T(keep * base[c] + turn * increment[c]));
}

}  // namespace stirsph
