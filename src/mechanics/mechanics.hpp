/// The mechanics of a step: velocity gradient, density and stress update, internal acceleration. One object per run,
/// written over the compile-time space behind a run-time interface; one dispatch per sweep.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "materials/material.hpp"
#include "mechanics/neighbourhood.hpp"
#include "mechanics/settings.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// Work and heat of this rank since the start of the run [J].
struct MechanicsLedger {
  double elastic = 0;       ///< stored by elastic deformation
  double plastic = 0;       ///< dissipated by plastic flow
  double viscous = 0;       ///< dissipated by artificial viscosity
  double artificial = 0;    ///< taken out by the artificial stress; negative when it feeds noise
  double hourglass = 0;     ///< taken out by the hourglass control, stored in it or lost as metal flows
  double diffusion = 0;     ///< taken out by density diffusion
  double unmatched = 0;     ///< taken out by the forces where nothing yields, but not stored (correction `velocity`)
  double plastic_heat = 0;  ///< part of `plastic` turned into heat (eq. 13)
};

/// Counters of the last step on this rank.
struct MechanicsCounters {
  long gradient_fallbacks = 0;     ///< particles whose gradient could not be corrected
  long return_map_iterations = 0;  ///< over all particles
  long yielding = 0;               ///< particles that yielded
};

/// Waits for the halo copies. Called once by a sweep, when all that needs none of them is done.
using Arrival = std::function<void()>;

class Mechanics {
 public:
  virtual ~Mechanics() = default;

  /// Declares the fields the mechanics works on.
  virtual void add_fields(ParticleSet& particles) const = 0;
  /// Sets volume, smoothing length, flow stress and stress from mass, volumetric strain and deviator (start of a run).
  virtual void initialise(ParticleSet& particles) const = 0;

  /// Sweep 1 and the material: reads x at the end and v at the middle of the step (halo current), updates volumetric
  /// strain, volume, stress, plastic strain, heat. dt [s].
  virtual void update_stress(
      ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo = [] {}) = 0;
  /// Between the two, with settings().hourglass_control: advances force and stress of the control by dt and adds the
  /// latter to the stress (gradient halo current). See hourglass.hpp.
  virtual void update_hourglass(
      ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo = [] {}) = 0;
  /// Sweep 2: acceleration [m/s2] by stress, viscosity and artificial stress (stress halo current); overwrites the
  /// field.
  virtual void update_acceleration(
      ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo = [] {}) = 0;

  /// From now on, another scaling of the mass. Velocities stay, momentum and kinetic energy do not.
  virtual void set_density_scale(double scale) = 0;
  virtual const Inertia& inertia() const = 0;

  /// What the artificial viscosity dissipates [W] per owned particle, of the last update_acceleration, in the order of
  /// particles then; empty without viscosity.
  virtual std::span<const double> viscous_power() const = 0;

  /// Largest wave speed [m/s] with density and elastic scaling.
  virtual double wave_speed() const = 0;
  /// Smallest smoothing length on this rank [m]; infinity without particles.
  virtual double least_smoothing_length(const ParticleSet& particles) const = 0;
  /// Elastic energy [J] of the present stresses of this rank's particles. It is a function of state; what the ledger
  /// calls elastic is the work that plastic flow did not take. They differ where steps do not resolve the flow.
  virtual double stored_energy(const ParticleSet& particles) const = 0;
  /// Largest smoothing length times the kernel support on this rank [m].
  virtual double support(const ParticleSet& particles) const = 0;

  const MechanicsSettings& settings() const { return settings_; }
  const std::vector<Material>& materials() const { return materials_; }
  MechanicsLedger& ledger() { return ledger_; }
  const MechanicsLedger& ledger() const { return ledger_; }
  const MechanicsCounters& counters() const { return counters_; }
  /// Bytes of scratch storage.
  virtual std::size_t bytes() const = 0;

 protected:
  Mechanics(MechanicsSettings settings, std::vector<Material> materials)
      : settings_(std::move(settings)), materials_(std::move(materials)) {}

  MechanicsSettings settings_;
  std::vector<Material> materials_;  ///< moduli already multiplied by elastic_scale
  MechanicsLedger ledger_;
  MechanicsCounters counters_;
};

/// Materials carry their physical data; elastic and density scaling are applied inside.
std::unique_ptr<Mechanics> make_mechanics(const Space& space, const MechanicsSettings& settings,
                                          std::vector<Material> materials);

}  // namespace stirsph
