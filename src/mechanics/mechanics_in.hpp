/// Mechanics over one space. The sweeps live in translation units of their own (they are instantiated for every kernel
/// and option), the update of the material state in stress_update.cpp.
#pragma once

#include <optional>

#include "mechanics/grip_rate.hpp"
#include "mechanics/mechanics.hpp"
#include "mechanics/pair_sweep.hpp"

namespace stirsph {

/// What the material update needs of a material beside its flow stress.
struct MaterialConstants {
  double shear, bulk, density, taylor_quinney;  ///< Pa, Pa, kg/m3, 1
};

template <class S>
class MechanicsIn final : public Mechanics {
 public:
  MechanicsIn(MechanicsSettings settings, std::vector<Material> materials);

  void set_density_scale(double scale) override { inertia_.scale = settings_.density_scale = scale; }
  const Inertia& inertia() const override { return inertia_; }
  std::span<const double> viscous_power() const override {
    return viscous() ? std::span<const double>(dissipation_) : std::span<const double>();
  }

  void add_fields(ParticleSet& particles) const override;
  void initialise(ParticleSet& particles) const override;
  void update_stress(ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo) override;
  void update_hourglass(ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo) override;
  void update_acceleration(ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo) override;
  double wave_speed() const override;
  double least_smoothing_length(const ParticleSet& particles) const override;
  double stored_energy(const ParticleSet& particles) const override;
  double support(const ParticleSet& particles) const override;
  std::size_t bytes() const override {
    std::size_t numbers = records_.capacity() + dissipation_.capacity() + artificial_power_.capacity();
    for (const AlignedVector& rate : hourglass_rate_) numbers += rate.capacity();
    return numbers * sizeof(double) + active_.bytes() + (grip_rate_ ? grip_rate_->bytes() : 0);
  }

 private:
  void pack_gradient_records(const ParticleSet& particles, std::size_t first, std::size_t last);
  void pack_momentum_records(const ParticleSet& particles, std::size_t first, std::size_t last);
  void sweep_gradient(const PairList& pairs, std::size_t first, std::size_t last, std::size_t owned,
                      GradientBlock<S>& block);
  void sweep_momentum(std::size_t first, std::size_t last, const MomentumConstants& constants, double* const* force,
                      double* dissipation, double* artificial_power);
  /// The same with the viscosity of velocities without their swirl (three dimensions).
  void sweep_momentum_without_swirl(std::size_t first, std::size_t last, const MomentumConstants& constants,
                                    double* const* force, double* dissipation, double* artificial_power);
  /// The same with the viscosity of what the strain rates leave of an approach.
  void sweep_momentum_reconstructed(std::size_t first, std::size_t last, const MomentumConstants& constants,
                                    double* const* force, double* dissipation, double* artificial_power);
  void update_block(ParticleSet& particles, const GradientBlock<S>& block, std::size_t first, double dt);

  double smoothing_length() const { return settings_.h_over_dx * settings_.spacing; }

  /// The viscosity of this space needs to be told which velocity it sees.
  bool viscosity_has_own_velocity() const { return S::dim == 3 && settings_.viscosity_without_swirl && viscous(); }
  bool keeps_gradient() const { return settings_.hourglass_control > 0 || settings_.surface_layers; }
  bool reconstructs_viscosity() const { return settings_.viscosity_reconstruction && viscous(); }
  void pack_hourglass_records(const ParticleSet& particles);
  void add_hourglass_force(const ParticleSet& particles, double* const* force) const;
  void book_hourglass_work(const ParticleSet& particles, double dt);
  void add_hoop_stress(const ParticleSet& particles, double* const* force) const;
  void divide_by_inertia(const ParticleSet& particles, double* const* force) const;
  double pressure_wave_speed() const;
  bool viscous() const { return settings_.viscosity_alpha > 0 || settings_.viscosity_beta > 0; }
  Inertia inertia_;
  std::vector<MaterialConstants> constants_;      ///< per material
  AlignedVector records_;                         ///< neighbours packed for the sweep at hand
  ActivePairs active_;                            ///< from update_stress to the update_acceleration that follows
  std::optional<GripRate> grip_rate_;             ///< with rigid grips on metal that depends on the rate
  AlignedVector dissipation_, artificial_power_;  ///< W per particle
  std::array<AlignedVector, S::dim + S::dim * S::dim> hourglass_rate_;  ///< N/s per particle
};

template <>
void MechanicsIn<Cartesian3>::sweep_momentum_without_swirl(std::size_t, std::size_t, const MomentumConstants&,
                                                           double* const*, double*, double*);

}  // namespace stirsph
