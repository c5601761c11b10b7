/// The metal between the centre of a particle and the surface of its body: half a spacing thick at the start, and
/// deformed like the particle.
///
/// A particle that touches a rigid body at the distance a is pushed not at its centre x but at the surface, x - a n,
/// which moves with v - a L n (n the outward normal of the rigid body, L the velocity gradient). By virtual work the
/// force F of contact then does two things: it acts on the particle, and it takes the place of the metal that is
/// missing beyond the centre, as a stress a/V F (x) n beside the particle's own. Without this a body between plates is
/// strained over its height less a spacing, and its outermost layer carries too little.
///
/// The thickness follows b = F F^T, the left Cauchy-Green tensor, db/dt = L b + b L^T, a = sqrt(n.b n) dx/2. Where
/// metal flows particles change places and layers forget: b tends to the isotropic tensor of the same volume, by 1/e
/// over a plastic strain of one.
///
/// L and the stress must be adjoint to each other and exact at a surface: gradient_correction = "full".
#pragma once

#include <array>

#include "particles/field_names.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// Layers that are thinner or thicker than this, over half a spacing, count as such: particles that were drawn out far
/// have found others beside them.
inline constexpr double thinnest_layer = 0.5, thickest_layer = 1.25;

/// The arrays of a particle set that layers live in, looked up once for many particles. Rows and columns are components
/// of a position; they are valid until the set changes.
struct LayerArrays {
  template <class T>
  using Matrix = std::array<std::array<T*, 3>, 3>;
  Matrix<double> stretch{}, moment{}, corrected_stress{};
  Matrix<const double> velocity_gradient{}, inverse_moment{};
  const double* volume = nullptr;
  const double* plastic_strain_rate = nullptr;
  std::size_t owned = 0;
};

class SurfaceLayer {
 public:
  SurfaceLayer(const SpaceLayout& layout, double spacing) : layout_(layout), half_(0.5 * spacing) {}

  static void add_fields(ParticleSet& particles) {
    particles.add(field::layer_stretch);
    particles.add(field::layer_moment);
  }
  /// Undeformed layers.
  void initialise(ParticleSet& particles) const;
  LayerArrays arrays(ParticleSet& particles) const;

  /// Over the step dt [s] with the velocity gradient and the plastic strain rate.
  void advance(const LayerArrays& arrays, double dt) const;

  double thickest() const { return thickest_layer * half_; }  ///< m
  /// Of particle i in the direction n (unit vector) [m].
  double thickness(const LayerArrays& arrays, std::size_t i, const Vec3& n) const;
  /// Rate of its thickness at the present strain rate, a n.L n [m/s].
  double opening(const LayerArrays& arrays, std::size_t i, const Vec3& n, double thickness) const;
  /// Forgets the forces of the step before.
  void unload(const LayerArrays& arrays) const;
  /// Power [W] of the layers' forces in the present velocity gradient, of this rank: negative where they are squeezed.
  double power(const LayerArrays& arrays) const;
  /// Adds the stress of a normal force [N] on particle i at its surface to the corrected stress.
  void load(const LayerArrays& arrays, std::size_t i, const Vec3& n, double thickness, double force) const;

 private:
  /// n.T n of particle i.
  template <class T>
  double along(const LayerArrays::Matrix<T>& tensor, std::size_t i, const Vec3& n) const;

  SpaceLayout layout_;
  double half_;  ///< m
};

}  // namespace stirsph
