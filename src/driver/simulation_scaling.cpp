/// Guards of the scaled inertia and the schedule that follows them.
#include <algorithm>
#include <cmath>

#include "driver/simulation.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

/// After the step, before the vote, which chooses the next step size with the scaling of now.
void Simulation::look_at_inertia() {
  if (!guards_ || !guards_->due(clock_.step)) return;
  const ScopedTimer timer(timers_, "guards");
  guards_->look(*this);
  if (!schedule_) return;
  const double wanted = schedule_->next(*guards_, largest_force_error());
  if (wanted != mechanics_->inertia().scale) change_density_scale(wanted);
}

double Simulation::largest_force_error() const {
  double largest = 0;
  for (const RigidMotion& motion : motions_)
    if (motion.force_control() && !motion.retreating()) largest = std::max(largest, motion.force_control()->error());
  return largest;
}

double Simulation::kinetic_energy() const {
  double kinetic = 0;
  for (std::size_t i = 0; i < particles_.owned(); ++i)
    kinetic += 0.5 * particles_[field::mass][i] *
               mechanics_->inertia().square(particles_.vector_at(field::position, i),
                                            particles_.vector_at(field::velocity, i));
  return kinetic;
}

/// Velocities and forces stay; the kinetic energy that comes or goes is booked.
void Simulation::change_density_scale(double scale) {
  const double factor = scale / mechanics_->inertia().scale, before = kinetic_energy();
  set_density_scale(scale);
  load_ledger_.rescaling += kinetic_energy() - before;
  if (guards_) guards_->rescale(factor);

  // The next half kick still uses the forces of this step: their acceleration is that of the new mass, the centrifugal
  // acceleration of rings is a matter of their motion alone, and what grips prescribe is prescribed anew in a step.
  const Inertia& inertia = mechanics_->inertia();
  const bool centrifugal = inertia.axisymmetric && inertia.swirl;
  const auto r = particles_.component(field::position, 0), swirl = particles_.component(field::velocity, 1);
  for (int d = 0; d < particles_.layout().velocity_components; ++d) {
    const auto a = particles_.component(field::acceleration, d);
    for (std::size_t i = 0; i < particles_.owned(); ++i) {
      const double kept = centrifugal && d == 0 ? swirl[i] * swirl[i] / std::max(r[i], inertia.core) : 0.0;
      a[i] = kept + (a[i] - kept) / factor;
    }
  }
}

/// Whatever depends on the scaling of the mass: step, contact stiffness, gains of force controllers.
void Simulation::set_density_scale(double scale) {
  mechanics_->set_density_scale(scale);
  if (contact_) contact_->set_density_scale(scale);
  for (std::size_t r = 0; r < motions_.size(); ++r)
    if (motions_[r].force_control()) motions_[r].renew_gains(billet_stiffness(scene_.rigids[r]));
}

}  // namespace stirsph
