/// Heat conduction over particles and rigid bodies: one implicit PETSc solve per heat step.
/// Balance: rho c_p dT/dt = div(k grad T) + q (paper eq. 3), backward Euler.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "materials/thermal_properties.hpp"
#include "neighbours/pair_list.hpp"
#include "neighbours/smoothing_kernel.hpp"
#include "parallel/halo_exchange.hpp"
#include "particles/contact_point.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// How a rigid body takes part in the heat balance.
struct RigidHeat {
  enum class Role { Insulated, FixedTemperature, LumpedNode };
  Role role = Role::Insulated;
  double temperature = 293.15;          ///< K; updated for a lumped node, the same on all ranks
  double heat_capacity = 0;             ///< J/K, lumped node: mass times specific heat
  double ambient_conductance = 0;       ///< W/K from the lumped node to the surroundings
  double ambient_temperature = 293.15;  ///< K
  double interface_conductance = 0;     ///< W/m2/K of the contact with particles; infinity = perfect contact
  double heat_input = 0;  ///< J of friction heat since the last solve on this rank; summed over ranks, then zeroed
};

struct HeatSettings {
  double spacing = 0;           ///< m, particle spacing dx
  double smoothing_length = 0;  ///< m, h of the undisturbed lattice; with dx it fixes the lattice constants below
  double relative_tolerance = 1e-8;
  int maximum_iterations = 1000;  ///< of the KSP; -heat_ksp_max_it overrules it
  int nonlinear_iterations = 1;   ///< at most so many solves per step, k(T) and c_p(T) updated in between
  enum class Scheme { BackwardEuler, CrankNicolson } scheme = Scheme::BackwardEuler;
};

/// What one heat step did.
struct HeatReport {
  int iterations = 0;        ///< KSP iterations
  double residual = 0;       ///< final relative residual
  double particle_heat = 0;  ///< J gained by all particles, all ranks
  double rigid_heat = 0;     ///< J gained by lumped nodes
  double source_heat = 0;    ///< J put in by plastic and friction heat
  double fixed_heat = 0;     ///< J taken by bodies of fixed temperature
  double ambient_heat = 0;   ///< J lost to the surroundings
};

/// Owner of the matrix and of the KSP (options prefix `heat_`). PETSc must have been initialised.
class HeatSolver {
 public:
  HeatSolver(Comm comm, Kernel kernel, int dim, HeatSettings settings, std::vector<ThermalProperties> materials);
  ~HeatSolver();

  /// Fields this module needs.
  static void add_fields(ParticleSet& particles);

  /// Advances temperatures by dt [s], consuming `heat_input` of particles and bodies. Collective. Halo copies of
  /// position and volume must be current; temperature halos are refreshed here. Throws SolverError on all ranks when
  /// the KSP fails.
  HeatReport advance(ParticleSet& particles, const PairList& pairs, const HaloExchange& halo,
                     std::span<const ContactPoint> contacts, std::span<RigidHeat> bodies, double dt);

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
