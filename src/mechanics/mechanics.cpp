#include "mechanics/mechanics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mechanics/mechanics_in.hpp"

namespace stirsph {

template <class S>
MechanicsIn<S>::MechanicsIn(MechanicsSettings settings, std::vector<Material> materials)
    : Mechanics(std::move(settings), std::move(materials)), inertia_(inertia_of(settings_, across<S> > 0)) {
  for (Material& material : materials_) {
    material.youngs_modulus *= settings_.elastic_scale;
    constants_.push_back(
        {material.shear_modulus(), material.bulk_modulus(), material.density, material.taylor_quinney});
  }
  const auto rate_sensitive = [](const Material& m) { return m.flow && m.flow->rate_sensitive(); };
  if (settings_.rigid_grips && std::any_of(materials_.begin(), materials_.end(), rate_sensitive))
    grip_rate_.emplace(settings_.kernel, smoothing_length());
}

template <class S>
void MechanicsIn<S>::add_fields(ParticleSet& particles) const {
  Neighbourhood::add_fields(particles);
  for (const FieldInfo* info :
       {&field::velocity, &field::acceleration, &field::volumetric_strain, &field::stress_deviator, &field::stress,
        &field::equivalent_plastic_strain, &field::plastic_strain_rate, &field::flow_stress, &field::temperature})
    particles.add(*info);
  if (settings_.gradient_correction == GradientCorrection::Full) particles.add(field::corrected_stress);
  if (settings_.artificial_stress > 0) particles.add(field::artificial_stress);
  if (keeps_gradient()) {
    particles.add(field::velocity_gradient);
    particles.add(field::inverse_moment);
  }
  if (settings_.hourglass_control > 0) {
    particles.add(field::hourglass_force);
    particles.add(field::hourglass_stress);
  }
  if (reconstructs_viscosity()) particles.add(field::strain_rate);
  if (diffusion_of(settings_) == DensityDiffusion::Reconstructed) particles.add(field::volumetric_strain_gradient);
  if (settings_.heat_input) particles.add(field::heat_input);
  if (grip_rate_) GripRate::add_fields(particles);
}

template <class S>
void MechanicsIn<S>::initialise(ParticleSet& particles) const {
  auto volume = particles[field::volume], h = particles[field::smoothing_length],
       strength = particles[field::flow_stress];
  const auto mass = particles[field::mass], strain = particles[field::volumetric_strain],
             plastic = particles[field::equivalent_plastic_strain], temperature = particles[field::temperature];
  if (grip_rate_) GripRate::initialise(particles);
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const Material& m = materials_[static_cast<int>(particles[field::material][i])];
    volume[i] = mass[i] / m.density * std::exp(strain[i]);
    h[i] = settings_.variable_h ? smoothing_length() * std::exp(strain[i] / S::dim) : smoothing_length();
    // An elastic material sets no limit to friction.
    strength[i] = m.flow ? m.flow->value(plastic[i], 0.0, temperature[i]) : std::numeric_limits<double>::infinity();
    for (int c = 0; c < S::stress_components; ++c)
      particles.component(field::stress, c)[i] =
          particles.component(field::stress_deviator, c)[i] + (c < 3 ? m.bulk_modulus() * strain[i] : 0.0);
  }
}

template <class S>
double MechanicsIn<S>::wave_speed() const {
  double fastest = pressure_wave_speed();
  // A swirl is the faster the lighter it is: that of rings travels as a shear wave, in three dimensions it also runs
  // along its circles as a pressure wave.
  if (inertia_.directional())
    for (const Material& m : materials_) {
      const double shear = std::sqrt(m.shear_modulus() / m.density), along = across < S >> 0 ? shear : m.sound_speed();
      fastest = std::max(fastest, along / std::sqrt(inertia_.swirl_scale()));
    }
  return fastest;
}

template <class S>
double MechanicsIn<S>::pressure_wave_speed() const {
  double fastest = 0;
  for (const Material& m : materials_) fastest = std::max(fastest, m.sound_speed());
  return fastest / std::sqrt(settings_.density_scale);
}

template <class S>
double MechanicsIn<S>::least_smoothing_length(const ParticleSet& particles) const {
  if (particles.owned() == 0) return std::numeric_limits<double>::infinity();
  if (!settings_.variable_h) return smoothing_length();
  const auto h = particles[field::smoothing_length].first(particles.owned());
  return *std::min_element(h.begin(), h.end());
}

template <class S>
double MechanicsIn<S>::stored_energy(const ParticleSet& particles) const {
  const auto material = particles[field::material], strain = particles[field::volumetric_strain],
             volume = particles[field::volume];
  std::array<std::span<const double>, 6> s;
  const int components = particles.layout().stress_components;
  for (int c = 0; c < components; ++c) s[c] = particles.component(field::stress_deviator, c);
  double energy = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const MaterialConstants& metal = constants_[static_cast<std::size_t>(material[i])];
    double square = 0;
    for (int c = 0; c < components; ++c) square += (c < 3 ? 1 : 2) * s[c][i] * s[c][i];
    // The integral of K e dV over V = V0 exp(e).
    const double of_pressure = metal.bulk * (strain[i] - 1 + std::exp(-strain[i]));
    energy += volume[i] * (square / (4 * metal.shear) + of_pressure);
  }
  return energy;
}

template <class S>
double MechanicsIn<S>::support(const ParticleSet& particles) const {
  double largest = smoothing_length();
  if (settings_.variable_h)
    for (double h : particles[field::smoothing_length].first(particles.owned())) largest = std::max(largest, h);
  return largest * kernel_support(settings_.kernel);
}

namespace {

/// One component of a field on its way into slot `slot` of the neighbour records.
struct RecordColumn {
  int slot;
  const double* values;
};

/// Fills the records of particles [begin, end) from columns, some particles at a time, so that a record is written
/// while it is in the cache.
void fill_records(const std::vector<RecordColumn>& columns, std::size_t begin, std::size_t end, int record_size,
                  double* records) {
  constexpr std::size_t block = 64;
  const std::size_t stride = static_cast<std::size_t>(record_size);
  for (std::size_t first = begin; first < end; first += block) {
    const std::size_t last = std::min(first + block, end);
    for (const RecordColumn& column : columns)
      for (std::size_t i = first; i < last; ++i) records[i * stride + column.slot] = column.values[i];
  }
}

/// Radius of a ring, kept away from zero at the axis; negative for a mirror image.
double ring_radius(double r, const Inertia& inertia) { return std::copysign(std::max(std::abs(r), inertia.core), r); }

}  // namespace

template <class S>
void MechanicsIn<S>::pack_gradient_records(const ParticleSet& particles, std::size_t first, std::size_t last) {
  with_gradient_record(settings_, [&]<bool VariableH, DensityDiffusion Diffusion>() {
    using Record = GradientRecord<S, VariableH, Diffusion>;
    std::vector<RecordColumn> columns;
    const auto put = [&](int slot, const FieldInfo& info, int c) {
      columns.push_back({slot, particles.component(info, c).data()});
    };
    for (int d = 0; d < S::dim; ++d) put(Record::x + d, field::position, d);
    for (int d = 0; d < S::velocity_components; ++d) put(Record::v + d, field::velocity, d);
    put(Record::volume, field::volume, 0);
    if constexpr (Record::diffuses) put(Record::strain, field::volumetric_strain, 0);
    if constexpr (Record::reconstructs)
      for (int d = 0; d < S::dim; ++d) put(Record::strain_gradient + d, field::volumetric_strain_gradient, d);
    if constexpr (VariableH) put(Record::h, field::smoothing_length, 0);
    records_.resize(particles.capacity() * Record::size);
    fill_records(columns, first, last, Record::size, records_.data());
    if constexpr (across < S >> 0)  // the section of the ring, and its angular velocity
      for (std::size_t i = first; i < last; ++i) {
        double* const record = records_.data() + i * Record::size;
        const double radius = ring_radius(record[Record::x], inertia_);
        record[Record::v + 1] /= radius;
        record[Record::volume] /= 2 * std::numbers::pi * std::abs(radius);
      }
  });
}

template <class S>
void MechanicsIn<S>::pack_momentum_records(const ParticleSet& particles, std::size_t first, std::size_t last) {
  const auto
      pack = [&]<bool VariableH, bool ArtificialStress, bool Full, bool OwnVelocity, bool Reconstruct = false>() {
    using Record = MomentumRecord<S, VariableH, ArtificialStress, Full, OwnVelocity, Reconstruct>;
    std::vector<RecordColumn> columns;
    const auto put = [&](int slot, const FieldInfo& info, int c) {
      columns.push_back({slot, particles.component(info, c).data()});
    };
    const auto put_tensor = [&](int slot, const FieldInfo& info) {
      for (int i = 0; i < S::dim; ++i)
        for (int j = i; j < S::dim; ++j) put(slot + tensor_slot<S>(i, j), info, in_plane_index<S>(i, j));
    };
    for (int d = 0; d < S::dim; ++d) put(Record::x + d, field::position, d);
    for (int d = 0; d < S::velocity_components; ++d) put(Record::v + d, field::velocity, d);
    put(Record::volume, field::volume, 0);
    if constexpr (Full)
      for (int c = 0; c < S::velocity_components * S::dim; ++c) put(Record::stress + c, field::corrected_stress, c);
    else
      put_tensor(Record::stress, field::stress);
    if constexpr (across < S >> 0 && !Full)
      for (int b = 0; b < S::dim; ++b)
        put(Record::stress + stress_slot<S, Full>(1, b), field::stress,
            symmetric_index(std::min(1, S::axes[b]), std::max(1, S::axes[b])));
    if constexpr (ArtificialStress) put_tensor(Record::artificial, field::artificial_stress);
    if constexpr (Reconstruct) put_tensor(Record::rate, field::strain_rate);
    if constexpr (VariableH) put(Record::h, field::smoothing_length, 0);
    records_.resize(particles.capacity() * Record::size);
    fill_records(columns, first, last, Record::size, records_.data());

    // The ring's section, its angular velocity, and the stresses that go with both. An image has the sign that keeps
    // the forces adjoint to the gradient, not that of a smooth field through the axis: otherwise inner rings gain
    // energy.
    if constexpr (across < S >> 0)
      for (std::size_t i = first; i < last; ++i) {
        double* const record = records_.data() + i * Record::size;
        const double radius = ring_radius(record[Record::x], inertia_);
        record[Record::v + 1] /= radius;
        record[Record::volume] /= 2 * std::numbers::pi * std::abs(radius);
        for (int c = 0; c < S::velocity_components; ++c)
          for (int b = 0; b < S::dim; ++b) {
            if (!Full && plane_index<S>(c) > b) continue;  // the same component again
            record[Record::stress + stress_slot<S, Full>(c, b)] *=
                2 * std::numbers::pi * std::abs(radius) * (c == 1 ? radius : 1.0);
          }
        if constexpr (ArtificialStress)
          for (int c = 0; c < Record::tensor; ++c)
            record[Record::artificial + c] *= 2 * std::numbers::pi * std::abs(radius);
      }
    if constexpr (OwnVelocity)
      for (std::size_t i = first; i < last; ++i) {
        double* const record = records_.data() + i * Record::size;
        const Vec3 x{record[Record::x], record[Record::x + 1], 0};
        const Vec3 v{record[Record::v], record[Record::v + 1], record[Record::v + 2]};
        const double spin = inertia_.spin(x, v);
        record[Record::own] = v.x + spin * x.y;
        record[Record::own + 1] = v.y - spin * x.x;
        record[Record::own + 2] = v.z;
      }
    if (viscous()) {
      std::vector<double> sound_speed;
      for (const Material& m : materials_) sound_speed.push_back(m.sound_speed() / std::sqrt(settings_.density_scale));
      const auto material = particles[field::material], mass = particles[field::mass],
                 volume = particles[field::volume];
      for (std::size_t i = first; i < std::min(last, particles.total()); ++i) {
        double* const record = records_.data() + i * Record::size;
        record[Record::density] = settings_.density_scale * mass[i] / volume[i];
        record[Record::impedance] = record[Record::density] * sound_speed[static_cast<std::size_t>(material[i])];
      }
    }
  };
  const auto with_h = [&]<bool ArtificialStress, bool Full>() {
    if constexpr (S::dim == 3)
      if (viscosity_has_own_velocity()) {
        if (reconstructs_viscosity())
          return settings_.variable_h ? pack.template operator()<true, ArtificialStress, Full, true, true>()
                                      : pack.template operator()<false, ArtificialStress, Full, true, true>();
        return settings_.variable_h ? pack.template operator()<true, ArtificialStress, Full, true>()
                                    : pack.template operator()<false, ArtificialStress, Full, true>();
      }
    if (reconstructs_viscosity())
      return settings_.variable_h ? pack.template operator()<true, ArtificialStress, Full, false, true>()
                                  : pack.template operator()<false, ArtificialStress, Full, false, true>();
    settings_.variable_h ? pack.template operator()<true, ArtificialStress, Full, false>()
                         : pack.template operator()<false, ArtificialStress, Full, false>();
  };
  const bool artificial = settings_.artificial_stress > 0;
  if (settings_.gradient_correction == GradientCorrection::Full)
    artificial ? with_h.template operator()<true, true>() : with_h.template operator()<false, true>();
  else
    artificial ? with_h.template operator()<true, false>() : with_h.template operator()<false, false>();
}

namespace {

/// Calls sweep(first, last) for runs of at most `run` clusters: first those whose candidates are all this rank's, then
/// the rest, with halo() between. The order depends on the list alone, whenever the messages arrive.
template <class Sweep>
void sweep_around_halo(const PairList& pairs, std::size_t clusters, std::size_t run, const Arrival& halo,
                       const Sweep& sweep) {
  std::vector<std::size_t> border;
  for (std::size_t first = 0; first < clusters; first += run) {
    const std::size_t last = std::min(first + run, clusters);
    if (pairs.needs_halo(first, last))
      border.push_back(first);
    else
      sweep(first, last);
  }
  halo();
  for (const std::size_t first : border) sweep(first, std::min(first + run, clusters));
}

}  // namespace

template <class S>
void MechanicsIn<S>::update_stress(ParticleSet& particles, const PairList& pairs, double dt, const Arrival& halo) {
  counters_ = {};
  pack_gradient_records(particles, 0, particles.owned());
  active_.begin(pairs, particles.owned());
  GradientBlock<S> block;
  const auto arrive = [&] {
    halo();
    pack_gradient_records(particles, particles.owned(), particles.capacity());
  };
  sweep_around_halo(pairs, particles.clusters(), GradientBlock<S>::clusters, arrive,
                    [&](std::size_t first, std::size_t last) {
                      sweep_gradient(pairs, first, last, particles.owned(), block);
                      update_block(particles, block, first * cluster_size, dt);
                    });
  active_.complete();
  if (grip_rate_) grip_rate_->update(particles, pairs);
}

/// Turns what the sweep has summed into the forces on rings: the torque into the force along theta, and the pull of the
/// hoop stress to the axis added.
template <class S>
void MechanicsIn<S>::add_hoop_stress(const ParticleSet& particles, double* const* force) const {
  const auto r = particles.component(field::position, 0), volume = particles[field::volume];
  const auto hoop = particles.component(field::stress, 1);
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double radius = ring_radius(r[i], inertia_);
    force[0][i] -= volume[i] * hoop[i] / radius;
    force[1][i] /= radius;
  }
}

template <class S>
void MechanicsIn<S>::divide_by_inertia(const ParticleSet& particles, double* const* force) const {
  const auto mass = particles[field::mass];
  if (S::dim == 3 && inertia_.directional()) {
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Vec3 a = inertia_.acceleration(particles.vector_at(field::position, i),
                                           Vec3{force[0][i], force[1][i], force[2][i]} / mass[i]);
      for (int d = 0; d < 3; ++d) force[d][i] = a[d];
    }
    return;
  }
  for (int d = 0; d < S::velocity_components; ++d) {
    const double scale = plane_index<S>(d) < 0 ? inertia_.swirl_scale() : inertia_.scale;
    for (std::size_t i = 0; i < particles.owned(); ++i) force[d][i] /= mass[i] * scale;
  }
  if constexpr (across < S >> 0) {
    const auto r = particles.component(field::position, 0);
    for (std::size_t i = 0; i < particles.owned(); ++i)
      if (r[i] < inertia_.axis_reach)
        for (const int d : {0, 1}) force[d][i] /= inertia_.axis_factor(r[i]);
  }
}

template <class S>
void MechanicsIn<S>::update_acceleration(ParticleSet& particles, const PairList& pairs, double dt,
                                         const Arrival& halo) {
  pack_momentum_records(particles, 0, particles.owned());
  std::array<double*, S::velocity_components> force;
  for (int d = 0; d < S::velocity_components; ++d) {
    const auto component = particles.component(field::acceleration, d);
    std::fill(component.begin(), component.end(), 0.0);
    force[d] = component.data();
  }
  const bool artificial = settings_.artificial_stress > 0;
  dissipation_.resize(particles.capacity());
  if (artificial) artificial_power_.resize(particles.capacity());
  const MomentumConstants constants{smoothing_length(), settings_.spacing, settings_.viscosity_alpha,
                                    settings_.viscosity_beta};
  if (!active_.valid()) active_.take_all(pairs, particles.owned());
  const auto arrive = [&] {
    halo();
    pack_momentum_records(particles, particles.owned(), particles.capacity());
  };
  sweep_around_halo(
      pairs, particles.clusters(), GradientBlock<S>::clusters, arrive, [&](std::size_t first, std::size_t last) {
        sweep_momentum(first, last, constants, force.data(), dissipation_.data(), artificial_power_.data());
      });
  active_.expire();
  if constexpr (across < S >> 0) add_hoop_stress(particles, force.data());
  if (settings_.hourglass_control > 0) add_hourglass_force(particles, force.data());
  divide_by_inertia(particles, force.data());
  if (settings_.hourglass_control > 0) book_hourglass_work(particles, dt);
  if (viscous())
    for (std::size_t i = 0; i < particles.owned(); ++i) ledger_.viscous += dissipation_[i] * dt;
  if (artificial)
    for (std::size_t i = 0; i < particles.owned(); ++i) ledger_.artificial += artificial_power_[i] * dt;
}

template class MechanicsIn<Cartesian3>;
template class MechanicsIn<PlaneStrain>;
template class MechanicsIn<AxisymmetricSwirl>;

std::unique_ptr<Mechanics> make_mechanics(const Space& space, const MechanicsSettings& settings,
                                          std::vector<Material> materials) {
  return std::visit(
      [&]<class S>(const S&) -> std::unique_ptr<Mechanics> {
        return std::make_unique<MechanicsIn<S>>(settings, std::move(materials));
      },
      space);
}

}  // namespace stirsph
