/// Whether scaled inertia and artificial viscosity bend the answer: four numbers, measured every so many steps and
/// averaged over the last looks. Small kinetic energy is no such sign: it is small because nothing moves.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace stirsph {

class Simulation;

/// Means over the yielding metal have the weight V d(eps_p)/dt: what flows counts, a particle that flies off does not.
enum class Guard {
  Viscous,    ///< alpha rho s c h rate (rms) over the flow stress; the rate is that at which the viscosity dissipates
  Inertia,    ///< rho s v^2 over the flow stress, without a swirl that has no inertia
  SpinUp,     ///< time rho s_swirl dx v_rim/(sigma_y/sqrt(3)) for the swirl to follow, in turns of the tool
  RimTravel,  ///< way of the metal at the rim in a step over dx; three dimensions only, rings do not pass each other
};
constexpr int guard_count = 4;
inline constexpr std::array<const char*, guard_count> guard_names{"viscous", "inertia", "spin_up", "rim_travel"};

class InertiaGuards {
 public:
  explicit InertiaGuards(const Scene& scene);

  /// Whether they are measured after this step: a function of the clock, the same with and without a restart.
  bool due(std::int64_t step) const { return step % every_ == 0; }
  /// Measures and averages. Collective; the same on all ranks.
  void look(const Simulation& simulation);
  /// The scaling of the mass has changed by this factor: the averages follow at once.
  void rescale(double factor);

  /// Average over the last looks; of the yielding metal, however little there is.
  double measured(Guard guard) const;
  /// The same for outputs and limits: without flow there is nothing that inertia could falsify, and the value is 0.
  double value(Guard guard) const { return flows() || guard == Guard::RimTravel ? measured(guard) : 0.0; }
  /// Largest value() since the start of the process, of full averages.
  double largest(Guard guard) const { return largest_[static_cast<int>(guard)]; }
  double limit(Guard guard) const { return limits_[static_cast<int>(guard)]; }
  /// Largest measured value over its limit.
  double load() const;

  /// Plastic power over plastic and friction power, in the last few looks.
  double flow_share() const { return plastic_ > 0 ? plastic_ / (plastic_ + friction_) : 0.0; }
  /// From this share on metal flows. While the tool of inputs/tube_id2 slides it is below 1e-5.
  static constexpr double onset = 0.02;
  bool flows() const { return flow_share() > onset; }
  /// There were enough looks for an average.
  bool settled() const { return looks_ >= memory; }
  /// Looks whose average it is.
  static constexpr int memory = 20;

  /// What to change when the guard is above its limit.
  static std::string remedy(Guard guard);

  std::vector<double> state() const;
  void restore(const std::vector<double>& state);
  static constexpr std::size_t state_size = 18;

 private:
  /// Sums over the yielding metal with the weight V d(eps_p)/dt.
  enum Sum { Weight, Strength, ViscousSquare, InertialStress, Density, sums };

  std::int64_t every_;
  double spacing_;
  std::array<double, guard_count> limits_;
  std::array<double, sums> mean_{};
  double rim_travel_ = 0, rim_speed_ = 0, turn_ = 0;  ///< 1, m/s, s
  double swirl_scale_ = 1;
  double plastic_ = 0, friction_ = 0;                ///< J per look, short average
  double plastic_before_ = 0, friction_before_ = 0;  ///< J, all ranks, at the last look
  double looks_ = 0;
  std::array<double, guard_count> largest_{};
};

}  // namespace stirsph
