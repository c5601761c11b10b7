#include "mechanics/hourglass.hpp"

#include <cmath>
#include <numbers>

#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <class S>
void MechanicsIn<S>::pack_hourglass_records(const ParticleSet& particles) {
  using Record = HourglassRecord<S>;
  records_.resize(particles.capacity() * Record::size);
  const auto mass = particles[field::mass], material = particles[field::material];
  for (std::size_t i = 0; i < particles.capacity(); ++i) {
    double* const record = records_.data() + i * Record::size;
    for (int a = 0; a < S::dim; ++a) {
      record[Record::x + a] = particles.component(field::position, a)[i];
      record[Record::v + a] = particles.component(field::velocity, S::axes[a])[i];
      for (int b = 0; b < S::dim; ++b)
        record[Record::gradient + a * S::dim + b] =
            particles.component(field::velocity_gradient, S::axes[a] * S::dim + b)[i];
    }
    // Padding behind the last particle has no mass; its modulus only must not be zero.
    const MaterialConstants& metal = constants_[i < particles.total() ? static_cast<std::size_t>(material[i]) : 0];
    record[Record::volume] = mass[i] / metal.density;
    record[Record::shear] = metal.shear;
    record[Record::width] = 1;
    if constexpr (across < S >> 0) {
      record[Record::width] = 2 * std::numbers::pi * std::max(std::abs(record[Record::x]), inertia_.core);
      record[Record::volume] /= record[Record::width];
    }
  }
}

template <class S>
void MechanicsIn<S>::update_hourglass(ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo) {
  constexpr int dim = S::dim;
  halo();
  pack_hourglass_records(particles);
  std::array<double*, dim> rate;
  std::array<double*, dim * dim> stress_rate;
  for (int k = 0; k < dim + dim * dim; ++k) {
    hourglass_rate_[k].assign(particles.capacity(), 0.0);
    (k < dim ? rate[k] : stress_rate[k - dim]) = hourglass_rate_[k].data();
  }
  std::visit(
      [&]<class K>(const K&) {
        hourglass_sweep<S, K>(records_, pairs, 0, particles.clusters(), particles.owned(), smoothing_length(),
                              rate.data(), stress_rate.data());
      },
      settings_.kernel);
  const auto material = particles[field::material], plastic_rate = particles[field::plastic_strain_rate],
             strength = particles[field::flow_stress], volume = particles[field::volume];
  std::array<double*, dim> force;
  std::array<double*, dim * dim> stress, corrected;
  std::array<const double*, dim * dim> gradient, inverse;
  for (int a = 0; a < dim; ++a) {
    force[a] = particles.component(field::hourglass_force, S::axes[a]).data();
    for (int b = 0; b < dim; ++b) {
      const int in_space = S::axes[a] * dim + b;
      stress[a * dim + b] = particles.component(field::hourglass_stress, in_space).data();
      corrected[a * dim + b] = particles.component(field::corrected_stress, in_space).data();
      gradient[a * dim + b] = particles.component(field::velocity_gradient, in_space).data();
      inverse[a * dim + b] = particles.component(field::inverse_moment, in_space).data();
    }
  }
  const double zeta = settings_.hourglass_control;
  using Tensor = LaneMatrix<double, dim>;
  std::vector<double> shear_speed;
  for (const MaterialConstants& m : constants_)
    shear_speed.push_back(std::sqrt(m.shear / (m.density * settings_.density_scale)));
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double shear = constants_[static_cast<std::size_t>(material[i])].shear;
    const double forgetting =
        std::exp(-dt * shear_speed[static_cast<std::size_t>(material[i])] / (hourglass_memory * settings_.spacing));
    const double returned = plastic_rate[i] > 0 ? strength[i] / (strength[i] + 3 * shear * plastic_rate[i] * dt) : 1.0;
    const double keep = forgetting * returned;
    Tensor spin, turn, transposed, old;
    double old_force[dim];
    for (int a = 0; a < dim; ++a) {
      old_force[a] = force[a][i];
      for (int b = 0; b < dim; ++b) {
        spin.a[a][b] = 0.5 * dt * (gradient[a * dim + b][i] - gradient[b * dim + a][i]);
        old.a[a][b] = stress[a * dim + b][i];
      }
    }
    const Tensor twice = multiply(spin, spin);  // the rotation of the step, to the second order
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        transposed.a[b][a] = turn.a[a][b] = (a == b ? 1.0 : 0.0) + spin.a[a][b] + 0.5 * twice.a[a][b];
    const Tensor turned = multiply(multiply(turn, old), transposed);
    for (int a = 0; a < dim; ++a) {
      double turned_force = 0;
      for (int c = 0; c < dim; ++c) turned_force += turn.a[a][c] * old_force[c];
      force[a][i] = keep * turned_force + dt * zeta * rate[a][i];
      for (int b = 0; b < dim; ++b)
        stress[a * dim + b][i] = keep * turned.a[a][b] - dt * zeta * stress_rate[a * dim + b][i] / (2 * volume[i]);
    }
    for (int a = 0; a < dim; ++a)
      for (int b = 0; b < dim; ++b)
        for (int c = 0; c < dim; ++c) corrected[a * dim + b][i] += stress[a * dim + c][i] * inverse[c * dim + b][i];
  }
}

template <class S>
void MechanicsIn<S>::add_hourglass_force(const ParticleSet& particles, double* const* force) const {
  for (int a = 0; a < S::dim; ++a) {
    const auto own = particles.component(field::hourglass_force, S::axes[a]);
    for (std::size_t i = 0; i < particles.owned(); ++i) force[S::axes[a]][i] += own[i];
  }
}

/// What the control takes out of the motion in a step, with the velocities that the forces and the strain have.
template <class S>
void MechanicsIn<S>::book_hourglass_work(const ParticleSet& particles, double dt) {
  constexpr int dim = S::dim;
  const auto volume = particles[field::volume];
  for (int a = 0; a < dim; ++a) {
    const auto force = particles.component(field::hourglass_force, S::axes[a]),
               v = particles.component(field::velocity, S::axes[a]),
               acceleration = particles.component(field::acceleration, S::axes[a]);
    for (std::size_t i = 0; i < particles.owned(); ++i)
      ledger_.hourglass -= force[i] * (v[i] + 0.5 * dt * acceleration[i]) * dt;
    for (int b = 0; b < dim; ++b) {
      const auto stress = particles.component(field::hourglass_stress, S::axes[a] * dim + b),
                 gradient = particles.component(field::velocity_gradient, S::axes[a] * dim + b);
      for (std::size_t i = 0; i < particles.owned(); ++i) ledger_.hourglass += volume[i] * stress[i] * gradient[i] * dt;
    }
  }
}

template void MechanicsIn<Cartesian3>::update_hourglass(ParticleSet&, const PairList&, double, const Arrival&);
template void MechanicsIn<Cartesian3>::add_hourglass_force(const ParticleSet&, double* const*) const;
template void MechanicsIn<Cartesian3>::book_hourglass_work(const ParticleSet&, double);
template void MechanicsIn<PlaneStrain>::update_hourglass(ParticleSet&, const PairList&, double, const Arrival&);
template void MechanicsIn<PlaneStrain>::add_hourglass_force(const ParticleSet&, double* const*) const;
template void MechanicsIn<PlaneStrain>::book_hourglass_work(const ParticleSet&, double);
template void MechanicsIn<AxisymmetricSwirl>::update_hourglass(ParticleSet&, const PairList&, double, const Arrival&);
template void MechanicsIn<AxisymmetricSwirl>::add_hourglass_force(const ParticleSet&, double* const*) const;
template void MechanicsIn<AxisymmetricSwirl>::book_hourglass_work(const ParticleSet&, double);

}  // namespace stirsph
