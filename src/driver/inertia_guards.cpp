#include "driver/inertia_guards.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "driver/simulation.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

constexpr double short_memory = 3;  // looks; the onset of flow must be seen soon, but not in one noisy look

/// m from the axis to the farthest point of a body that its bounds allow; infinite for an endless one.
double reach_of(const RigidBody& rigid) {
  const Bounds bounds = rigid.shape->bounds();
  double reach = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 point{corner & 1 ? bounds.high.x : bounds.low.x, corner & 2 ? bounds.high.y : bounds.low.y,
                     corner & 4 ? bounds.high.z : bounds.low.z};
    if (!std::isfinite(dot(point, point))) return std::numeric_limits<double>::infinity();
    for (int d = 0; d < 3; ++d) {
      if (rigid.pose.axis[d] == 1) continue;
      reach = std::max(reach, std::abs(point[d] - rigid.pose.centre[d]));
    }
  }
  return reach;
}

/// m2, squared distance of this rank's farthest particle from the body's axis.
double metal_reach2(const ParticleSet& particles, const RigidPose& pose) {
  const Vec3 centre = pose.axis_point();
  double farthest2 = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const Vec3 arm = particles.vector_at(field::position, i) - centre;
    const double along = dot(arm, pose.axis);
    farthest2 = std::max(farthest2, dot(arm, arm) - along * along);
  }
  return farthest2;
}

}  // namespace

InertiaGuards::InertiaGuards(const Scene& scene)
    : every_(scene.limits.guard_steps), spacing_(scene.numerics.spacing), limits_(scene.limits.guards) {}

void InertiaGuards::look(const Simulation& simulation) {
  const Mechanics& mechanics = *simulation.mechanics();
  const Inertia& inertia = mechanics.inertia();
  const ParticleSet& particles = simulation.particles();
  const MechanicsSettings& settings = mechanics.settings();
  const auto mass = particles[field::mass], volume = particles[field::volume], strength = particles[field::flow_stress],
             rate = particles[field::plastic_strain_rate], h = particles[field::smoothing_length],
             material = particles[field::material];
  const auto viscous_power = mechanics.viscous_power();

  // Monaghan's viscosity between approaching particles is a shear viscosity eta = alpha rho c h/(4 (d + 2)) (half of
  // J. J. Monaghan, Rep. Prog. Phys. 68, 2005, section 8.6), which dissipates 3 eta rate^2 per volume: that gives the
  // rate, and alpha rho c h rate is the stress of the rule in physical terms.
  const double per_shear_viscosity = 4.0 * (particles.layout().dim + 2);
  std::vector<double> totals(sums + 2, 0.0);
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double weight = volume[i] * rate[i];
    if (weight <= 0 || !std::isfinite(strength[i])) continue;
    const Vec3 x = particles.vector_at(field::position, i), v = particles.vector_at(field::velocity, i);
    const Vec3 felt = inertia.swirl ? v : v - inertia.swirl_part(x, v);
    const double density = mass[i] / volume[i];
    totals[Weight] += weight;
    totals[Strength] += weight * strength[i];
    totals[InertialStress] += weight * density * inertia.square(x, felt);
    totals[Density] += weight * density;
    if (viscous_power.empty()) continue;
    const Material& metal = mechanics.materials()[static_cast<std::size_t>(material[i])];
    const double nominal = settings.viscosity_alpha * density * std::sqrt(inertia.scale) * metal.sound_speed() * h[i];
    // Squares: a pair that is visited once counts for one of its two particles, so only sums have a meaning.
    totals[ViscousSquare] += weight * nominal * per_shear_viscosity / 3 * viscous_power[i] / volume[i];
  }
  totals[sums] = mechanics.ledger().plastic;
  totals[sums + 1] = simulation.contact() ? simulation.contact()->ledger().friction : 0.0;
  simulation.comm().sum_in_place(totals);

  looks_ += 1;
  const double share = 1 / std::min<double>(looks_, memory), soon = 1 / std::min(looks_, short_memory);
  for (int k = 0; k < sums; ++k) mean_[k] += share * (totals[k] - mean_[k]);
  plastic_ += soon * (totals[sums] - plastic_before_ - plastic_);
  friction_ += soon * (std::abs(totals[sums + 1] - friction_before_) - friction_);
  plastic_before_ = totals[sums];
  friction_before_ = totals[sums + 1];

  rim_speed_ = turn_ = 0;
  for (const RigidBody& rigid : simulation.rigids()) {
    const double spin = std::abs(rigid.pose.angular_velocity);
    if (spin == 0) continue;
    const double metal = std::sqrt(simulation.comm().max(metal_reach2(particles, rigid.pose)));
    const double speed = spin * std::min(metal, reach_of(rigid));
    if (speed <= rim_speed_) continue;
    rim_speed_ = speed;
    turn_ = 2 * std::numbers::pi / spin;
  }
  swirl_scale_ = inertia.swirl_scale();
  // A round tool that slides on the metal may go as far as it likes; metal that follows it passes its neighbours.
  const double fastest = std::min(rim_speed_, simulation.largest_speed());
  const double travel = particles.layout().dim == 3 ? fastest * simulation.clock().dt / spacing_ : 0.0;
  rim_travel_ += share * (travel - rim_travel_);
  if (!settled()) return;
  for (int k = 0; k < guard_count; ++k) largest_[k] = std::max(largest_[k], value(static_cast<Guard>(k)));
}

void InertiaGuards::rescale(double factor) {
  mean_[ViscousSquare] *= factor;  // of rho s c, and c falls with the root of s
  mean_[InertialStress] *= factor;
  swirl_scale_ *= factor;
  rim_travel_ *= std::sqrt(factor);  // as the step, if the wave speed decides it
}

double InertiaGuards::measured(Guard guard) const {
  if (guard == Guard::RimTravel) return rim_travel_;
  if (mean_[Weight] <= 0) return 0;
  switch (guard) {
    case Guard::Viscous:
      return std::sqrt(std::max(0.0, mean_[ViscousSquare]) * mean_[Weight]) / mean_[Strength];
    case Guard::Inertia:
      return mean_[InertialStress] / mean_[Strength];
    default:
      return turn_ > 0
                 ? std::numbers::sqrt3 * mean_[Density] / mean_[Strength] * swirl_scale_ * spacing_ * rim_speed_ / turn_
                 : 0.0;
  }
}

double InertiaGuards::load() const {
  double largest = 0;
  for (int k = 0; k < guard_count; ++k) largest = std::max(largest, measured(static_cast<Guard>(k)) / limits_[k]);
  return largest;
}

std::string InertiaGuards::remedy(Guard guard) {
  switch (guard) {
    case Guard::Viscous:
      return "lower numerics.density_scale or numerics.viscosity_alpha, or take viscosity_velocity = \"no_swirl\"";
    case Guard::Inertia:
      return "lower numerics.density_scale; where metal follows a tool that turns, take inertia = \"no_swirl\"";
    case Guard::SpinUp:
      return "lower numerics.swirl_density_ratio or numerics.density_scale";
    case Guard::RimTravel:
      return "take smaller steps: lower numerics.density_scale, time.cfl or time.step";
  }
  return "";
}

std::vector<double> InertiaGuards::state() const {
  std::vector<double> values(mean_.begin(), mean_.end());
  for (const double value :
       {rim_travel_, rim_speed_, turn_, swirl_scale_, plastic_, friction_, plastic_before_, friction_before_, looks_})
    values.push_back(value);
  values.insert(values.end(), largest_.begin(), largest_.end());
  return values;
}

void InertiaGuards::restore(const std::vector<double>& state) {
  auto next = state.begin();
  for (double& value : mean_) value = *next++;
  for (double* value : {&rim_travel_, &rim_speed_, &turn_, &swirl_scale_, &plastic_, &friction_, &plastic_before_,
                        &friction_before_, &looks_})
    *value = *next++;
  for (double& value : largest_) value = *next++;
}

}  // namespace stirsph
