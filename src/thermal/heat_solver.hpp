/// Heat conduction over particles and rigid bodies: one implicit PETSc solve per heat step.
/// Balance: rho c_p dT/dt = div(k grad T) + q (paper eq. 3), backward Euler.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "geometry/rigid_body.hpp"
#include "materials/thermal_properties.hpp"
#include "neighbours/pair_list.hpp"
#include "neighbours/smoothing_kernel.hpp"
#include "parallel/halo_exchange.hpp"
#include "particles/particle_set.hpp"
#include "thermal/interface_point.hpp"
#include "thermal/rigid_heat.hpp"

namespace stirsph {

struct HeatSettings {
  double spacing = 0;           ///< m, particle spacing dx
  double smoothing_length = 0;  ///< m, h of the undisturbed lattice; with dx it fixes the lattice constants below
  double relative_tolerance = 1e-8;
  int maximum_iterations = 1000;  ///< of the KSP; -heat_ksp_max_it overrules it
  int nonlinear_iterations = 1;   ///< at most so many solves per step, k(T) and c_p(T) updated in between
  enum class Scheme { BackwardEuler, CrankNicolson } scheme = Scheme::BackwardEuler;
};

/// What one heat step did to one rigid body, all ranks [J].
struct BodyHeat {
  double gained = 0;     ///< by its nodes of free temperature
  double interface = 0;  ///< received from particles through the interface
  double surface = 0;    ///< given away through outer surfaces: films and nodes of fixed temperature
  double friction = 0;   ///< friction heat put into its nodes
};

/// A film between particles and surroundings.
struct ParticleFilm {
  std::vector<double> conductance;      ///< W/K per owned particle
  double ambient_temperature = 293.15;  ///< K
};

/// What one heat step did.
struct HeatReport {
  int iterations = 0;        ///< KSP iterations
  double residual = 0;       ///< final relative residual
  double particle_heat = 0;  ///< J gained by all particles, all ranks
  double rigid_heat = 0;     ///< J gained by rigid bodies
  double source_heat = 0;    ///< J put in by plastic and friction heat and other sources
  double fixed_heat = 0;     ///< J taken by bodies and surfaces of fixed temperature
  double ambient_heat = 0;   ///< J lost to the surroundings
  std::vector<BodyHeat> bodies;
};

/// Owner of the matrix and of the KSP (options prefix `heat_`). PETSc must have been initialised.
class HeatSolver {
 public:
  HeatSolver(Comm comm, Kernel kernel, int dim, HeatSettings settings, std::vector<ThermalProperties> materials);
  ~HeatSolver();

  /// Fields this module needs.
  static void add_fields(ParticleSet& particles);

  /// Free area [m2] of each owned particle at the present positions; rigid bodies shield what lies at their surface.
  /// Halo copies of position and volume must be current.
  std::vector<double> free_surface(ParticleSet& particles, const PairList& pairs,
                                   std::span<const InterfacePoint> points, std::span<const RigidBody> rigids);

  /// Advances temperatures by dt [s], consuming `heat_input` of particles, `heat` of the points and `node_input` of the
  /// bodies. Collective. `film`: of the particles' free surface, made with free_surface() for the same positions, or
  /// null. The same bodies with the same meshes must be given at every call. Halo copies of position and volume must be
  /// current; temperature halos are refreshed here. Throws SolverError on all ranks when the KSP fails.
  HeatReport advance(ParticleSet& particles, const PairList& pairs, const HaloExchange& halo,
                     std::span<const InterfacePoint> points, std::span<RigidHeat> bodies, double dt,
                     const ParticleFilm* film = nullptr);

  /// Bytes of the matrix and of the nodes' tables on this rank.
  std::size_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The lattice factor by which the conduction operator is divided so that it is exact for long waves on a cubic
/// (square) lattice of spacing dx: M_xx of verification case A1 (0.65 % for the cubic spline at h = 1.3 dx).
double lattice_conduction_factor(const Kernel& kernel, int dim, double h_over_dx);

/// Sum of V W over the particles inside such a lattice, self included (S of verification case A1).
double lattice_kernel_sum(const Kernel& kernel, int dim, double h_over_dx);

/// b: how much hotter the first layer of a flat lattice surface is than the continuum at its centre, in units of q
/// dx/k, when the flux q [W/m2] enters through that layer; of the operator with its surface correction
/// (conduction.hpp), so it may be negative. Subtracted from the half cell dx/2, it makes a wall temperature act at the
/// true surface.
double lattice_surface_resistance(const Kernel& kernel, int dim, double h_over_dx);

}  // namespace stirsph
