#include "thermal/heat_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "particles/field_names.hpp"
#include "thermal/conduction.hpp"
#include "thermal/heat_matrix.hpp"
#include "thermal/linear_solve.hpp"
#include "thermal/rigid_coupling.hpp"

namespace stirsph {
namespace {

ConductionOperator make_operator(const Kernel& kernel, int dim, const HeatSettings& settings) {
  if (!(settings.spacing > 0) || !(settings.smoothing_length > 0))
    throw InputError(
        fmt::format("the heat solver needs a positive particle spacing and smoothing length, not {} m and {} m",
                    settings.spacing, settings.smoothing_length));
  const double ratio = settings.smoothing_length / settings.spacing;
  return {kernel, lattice_conduction_factor(kernel, dim, ratio), lattice_kernel_sum(kernel, dim, ratio)};
}

/// The temperature rise d with  integral of c_p from T to T + d  =  heat [J/kg]; Newton, at home because c_p > 0.
double temperature_rise(const TemperaturePolynomial& specific_heat, double temperature, double heat) {
  double rise = heat / specific_heat(temperature);
  if (specific_heat.constant()) return rise;
  for (int k = 0; k < 50; ++k) {
    const double excess = specific_heat.integral(temperature, temperature + rise) - heat;
    const double change = excess / specific_heat(temperature + rise);
    rise -= change;
    if (std::abs(change) <= 1e-15 * std::abs(temperature)) break;
  }
  return rise;
}

/// The specific heat that turns a temperature change from `from` to `to` into the exact enthalpy difference.
double secant_specific_heat(const TemperaturePolynomial& specific_heat, double from, double to) {
  if (std::abs(to - from) <= 1e-9 * std::abs(from)) return specific_heat(from);
  return specific_heat.integral(from, to) / (to - from);
}

}  // namespace

/// Sizes in a step: rows 0 .. owned-1 are particles, behind them (rank 0) the lumped nodes.
struct HeatSolver::Impl {
  Impl(Comm c, const Kernel& kernel, int dim, const HeatSettings& s, std::vector<ThermalProperties> m)
      : comm(c),
        settings(s),
        materials(std::move(m)),
        op(make_operator(kernel, dim, s)),
        surface_resistance(lattice_surface_resistance(kernel, dim, s.smoothing_length / s.spacing)),
        implicit_share(s.scheme == HeatSettings::Scheme::CrankNicolson ? 0.5 : 1.0),
        linear_solve(c, {s.relative_tolerance, s.maximum_iterations}) {
    for (const ThermalProperties& material : materials)
      linear = linear && material.conductivity.constant() && material.specific_heat.constant();
  }

  const ThermalProperties& material_of(const ParticleSet& particles, std::size_t i) const {
    return materials[static_cast<std::size_t>(particles[field::material][i])];
  }
  void check_bodies(std::span<const RigidHeat> bodies) const;
  void linearise(ParticleSet& particles, const std::vector<double>& end);
  bool fill(const ParticleSet& particles, const PairList& pairs, const RigidCoupling& coupling,
            std::span<const RigidHeat> bodies, double dt, bool fresh);
  void assemble(const ParticleSet& particles, const PairList& pairs, const RigidCoupling& coupling,
                std::span<const RigidHeat> bodies, double dt);
  LinearSolve::Outcome solve(const RigidCoupling& coupling, std::span<const RigidHeat> bodies);
  double update_end(const ParticleSet& particles, std::vector<double>& end) const;
  HeatReport balance(const ParticleSet& particles, const RigidCoupling& coupling, std::span<const RigidHeat> bodies,
                     const std::vector<double>& nodes, double dt) const;

  Comm comm;
  HeatSettings settings;
  std::vector<ThermalProperties> materials;
  ConductionOperator op;
  double surface_resistance;  ///< b, in units of dx/k
  double implicit_share;      ///< theta of the scheme: fluxes are those of T + theta (T' - T)
  bool linear = true;         ///< no property depends on temperature
  LinearSolve linear_solve;
  HeatMatrix matrix;
  std::uint64_t pattern_version = 0;  ///< of the pair list the pattern was made with
  std::vector<double> capacity;       ///< J/K of each particle, m times the linearised specific heat
  std::vector<double> right, rise;    ///< J and K per row
  std::vector<double> heat;           ///< J gained per row
  std::vector<double> body_source;    ///< J per body, summed over ranks
};

HeatSolver::HeatSolver(Comm comm, Kernel kernel, int dim, HeatSettings settings,
                       std::vector<ThermalProperties> materials)
    : impl_(std::make_unique<Impl>(comm, kernel, dim, settings, std::move(materials))) {}

HeatSolver::~HeatSolver() = default;

void HeatSolver::add_fields(ParticleSet& particles) {
  for (const FieldInfo* info :
       {&field::position, &field::volume, &field::mass, &field::smoothing_length, &field::material, &field::temperature,
        &field::heat_input, &field::conductivity, &field::conduction_correction, &field::matrix_row})
    particles.add(*info);
}

/// Mistakes of the scene, told on all ranks: heat given to a body that takes none would vanish, and a lumped body
/// without heat capacity has no temperature of its own.
void HeatSolver::Impl::check_bodies(std::span<const RigidHeat> bodies) const {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].role == RigidHeat::Role::LumpedNode && !(bodies[b].heat_capacity > 0))
      throw InputError(
          fmt::format("rigid body {} is a lumped heat node with a heat capacity of {} J/K: it must be positive", b,
                      bodies[b].heat_capacity));
    if (bodies[b].role == RigidHeat::Role::Insulated && body_source[b] != 0)
      throw InputError(
          fmt::format("rigid body {} is insulated but received {:.6g} J of friction heat: give it a "
                      "temperature or a heat capacity, or let all friction heat go to the particles",
                      b, body_source[b]));
  }
}

/// Properties for the step from the old temperatures (field::temperature) to `end`.
void HeatSolver::Impl::linearise(ParticleSet& particles, const std::vector<double>& end) {
  const auto start = particles[field::temperature];
  const auto mass = particles[field::mass];
  const auto conductivity = particles[field::conductivity];
  capacity.resize(particles.owned());
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const ThermalProperties& material = material_of(particles, i);
    // k at the time level of the fluxes keeps Crank-Nicolson second order; c_p as a secant keeps the enthalpy.
    conductivity[i] = material.conductivity(start[i] + implicit_share * (end[i] - start[i]));
    capacity[i] = mass[i] * secant_specific_heat(material.specific_heat, start[i], end[i]);
  }
}

/// Writes matrix and right side for the unknown rise d = T' - T:
///   (C + theta dt K) d = q - dt K T,
/// with K the graph Laplacian of all heat links. Solving for the rise makes the tolerance relative to the heat that
/// moves. Returns false when the present pattern does not fit.
bool HeatSolver::Impl::fill(const ParticleSet& particles, const PairList& pairs, const RigidCoupling& coupling,
                            std::span<const RigidHeat> bodies, double dt, bool fresh) {
  const auto temperature = particles[field::temperature];
  const auto heat_input = particles[field::heat_input];
  const auto matrix_row = particles[field::matrix_row];
  const auto owned = static_cast<std::int32_t>(particles.owned());
  const double weight = implicit_share * dt;
  HeatMatrixWriter writer(matrix, coupling.first_row(), coupling.rows(), fresh);

  visit_heat_links(particles, pairs, op, [&](const HeatLinks& row) {
    const auto i = static_cast<std::int32_t>(row.particle);
    writer.begin_row();
    double sum = 0, power = 0;
    for (std::size_t k = 0; k < row.neighbours.size(); ++k) {
      const double g = row.conductances[k];
      sum += g;
      power += g * (temperature[row.neighbours[k]] - temperature[i]);
    }
    for (const RigidCoupling::Link& link : coupling.links(i)) {
      sum += link.conductance;
      power += link.conductance * (bodies[link.body].temperature - temperature[i]);
    }
    right[i] = heat_input[i] + dt * power;
    const double diagonal = capacity[i] + weight * sum;
    bool placed = false;
    for (std::size_t k = 0; k < row.neighbours.size(); ++k) {
      const std::int32_t j = row.neighbours[k];
      if (j > i && !placed) {
        writer.add_local(i, diagonal);
        placed = true;
      }
      if (j < owned)
        writer.add_local(j, -weight * row.conductances[k]);
      else
        writer.add_global(static_cast<std::int64_t>(matrix_row[j]), -weight * row.conductances[k]);
    }
    if (!placed) writer.add_local(i, diagonal);
    for (const RigidCoupling::Link& link : coupling.links(i))
      if (coupling.row_of(link.body) >= 0) writer.add_global(coupling.row_of(link.body), -weight * link.conductance);
    writer.end_row();
    return writer.fits();
  });
  if (!writer.fits()) return false;

  for (std::size_t n = 0; n < coupling.local_nodes(); ++n) {
    const std::int32_t b = coupling.nodes()[n];
    const RigidHeat& body = bodies[b];
    writer.begin_row();
    double sum = body.ambient_conductance;
    double power = body.ambient_conductance * (body.ambient_temperature - body.temperature);
    for (const RigidCoupling::NodeLink& link : coupling.node_links(b)) {
      sum += link.conductance;
      power += link.conductance * (link.temperature - body.temperature);
      writer.add_global(link.row, -weight * link.conductance);
    }
    writer.add_global(coupling.row_of(b), body.heat_capacity + weight * sum);
    right[owned + n] = body_source[b] + dt * power;
    writer.end_row();
  }
  return writer.fits();
}

void HeatSolver::Impl::assemble(const ParticleSet& particles, const PairList& pairs, const RigidCoupling& coupling,
                                std::span<const RigidHeat> bodies, double dt) {
  // The pattern holds the neighbours within the support only, half of the candidates. It is tried again while the list
  // lives, since a fixed arrangement or a nonlinear iteration keeps it; columns are compared, so a list under which the
  // particles have moved on is noticed.
  const bool fits =
      matrix.rows() > 0 && pattern_version == pairs.version() && fill(particles, pairs, coupling, bodies, dt, false);
  pattern_version = pairs.version();
  if (comm.any(!fits)) {
    linear_solve.release_matrix();
    fill(particles, pairs, coupling, bodies, dt, true);
  }
  linear_solve.use_matrix(matrix);
}

/// Solves, and finds the heat each row gained from the fluxes of the solution, q - dt K (T + theta d) = C d + (b - A
/// d), rather than from C d: what one row gains another loses, so the balance holds to rounding at any tolerance.
LinearSolve::Outcome HeatSolver::Impl::solve(const RigidCoupling& coupling, std::span<const RigidHeat> bodies) {
  const LinearSolve::Outcome outcome = linear_solve.solve(right, rise);
  heat.resize(rise.size());
  linear_solve.residual(right, rise, heat);
  for (std::size_t i = 0; i < capacity.size(); ++i) heat[i] += capacity[i] * rise[i];
  for (std::size_t n = 0; n < coupling.local_nodes(); ++n) {
    const std::size_t row = capacity.size() + n;
    heat[row] += bodies[coupling.nodes()[n]].heat_capacity * rise[row];
  }
  return outcome;
}

/// New temperatures from the heat each particle received, so that enthalpy is conserved exactly also where c_p(T) was
/// linearised. Returns the largest change of `end` against the former iterate, relative to the largest rise.
/// Collective.
double HeatSolver::Impl::update_end(const ParticleSet& particles, std::vector<double>& end) const {
  const auto start = particles[field::temperature];
  const auto mass = particles[field::mass];
  std::vector<double> extremes(2, 0.0);
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    const double reached =
        start[i] + temperature_rise(material_of(particles, i).specific_heat, start[i], heat[i] / mass[i]);
    extremes[0] = std::max(extremes[0], std::abs(reached - end[i]));
    extremes[1] = std::max(extremes[1], std::abs(reached - start[i]));
    end[i] = reached;
  }
  comm.max_in_place(extremes);
  return extremes[1] > 0 ? extremes[0] / extremes[1] : 0;
}

/// Where the heat of the step went. `nodes`: rise [K] and heat gained [J] of the lumped bodies, in row order.
/// Collective.
HeatReport HeatSolver::Impl::balance(const ParticleSet& particles, const RigidCoupling& coupling,
                                     std::span<const RigidHeat> bodies, const std::vector<double>& nodes,
                                     double dt) const {
  const auto temperature = particles[field::temperature];
  const auto heat_input = particles[field::heat_input];
  std::vector<double> sums(3, 0.0);  // particles, sources, bodies of fixed temperature
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    sums[0] += heat[i];
    sums[1] += heat_input[i];
  }
  for (const RigidCoupling::Link& link : coupling.links()) {
    if (bodies[link.body].role != RigidHeat::Role::FixedTemperature) continue;
    const double between = temperature[link.particle] + implicit_share * rise[link.particle];
    sums[2] += dt * link.conductance * (between - bodies[link.body].temperature);
  }
  comm.sum_in_place(sums);
  HeatReport report;
  report.particle_heat = sums[0];
  report.source_heat = sums[1];
  report.fixed_heat = sums[2];
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    report.source_heat += body_source[b];
    // Heat made on a body of fixed temperature leaves through that body.
    if (bodies[b].role == RigidHeat::Role::FixedTemperature) report.fixed_heat += body_source[b];
  }
  for (std::size_t n = 0; n < coupling.nodes().size(); ++n) {
    const RigidHeat& body = bodies[coupling.nodes()[n]];
    report.rigid_heat += nodes[2 * n + 1];
    report.ambient_heat +=
        dt * body.ambient_conductance * (body.temperature + implicit_share * nodes[2 * n] - body.ambient_temperature);
  }
  return report;
}

HeatReport HeatSolver::advance(ParticleSet& particles, const PairList& pairs, const HaloExchange& halo,
                               std::span<const ContactPoint> contacts, std::span<RigidHeat> bodies, double dt) {
  Impl& m = *impl_;
  const std::size_t owned = particles.owned();
  const auto temperature = particles[field::temperature];
  m.body_source.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) m.body_source[b] = bodies[b].heat_input;
  m.comm.sum_in_place(m.body_source);
  m.check_bodies(bodies);

  RigidCoupling coupling(m.comm, bodies, owned);
  if (m.comm.sum(static_cast<std::int64_t>(coupling.rows())) > std::numeric_limits<int>::max())
    throw InputError("the heat matrix has more than 2^31 rows, more than this version can number");
  const auto matrix_row = particles[field::matrix_row];
  for (std::size_t i = 0; i < owned; ++i)
    matrix_row[i] = static_cast<double>(coupling.first_row() + static_cast<std::int64_t>(i));
  update_conduction_correction(particles, pairs, m.op);
  m.right.assign(coupling.rows(), 0.0);
  m.rise.assign(coupling.rows(), 0.0);

  HeatReport report;
  LinearSolve::Outcome outcome;
  int iterations = 0;
  std::vector<double> end(temperature.begin(), temperature.begin() + static_cast<std::ptrdiff_t>(owned));
  const int solves = m.linear ? 1 : std::max(1, m.settings.nonlinear_iterations);
  for (int k = 0; k < solves; ++k) {
    m.linearise(particles, end);
    halo.exchange(particles, Halo::Thermal);
    coupling.update(m.comm, particles, contacts, bodies, m.settings.spacing, m.surface_resistance);
    m.assemble(particles, pairs, coupling, bodies, dt);
    outcome = m.solve(coupling, bodies);
    iterations += outcome.iterations;
    const double change = m.update_end(particles, end);
    if (change <= 10 * m.settings.relative_tolerance) break;
  }

  std::vector<double> nodes;
  for (std::size_t row = owned; row < m.rise.size(); ++row) nodes.insert(nodes.end(), {m.rise[row], m.heat[row]});
  m.comm.broadcast(nodes);
  report = m.balance(particles, coupling, bodies, nodes, dt);
  report.iterations = iterations;
  report.residual = outcome.residual;

  std::copy(end.begin(), end.end(), temperature.begin());
  std::fill_n(particles[field::heat_input].begin(), owned, 0.0);
  for (std::size_t n = 0; n < coupling.nodes().size(); ++n) {
    RigidHeat& body = bodies[coupling.nodes()[n]];
    body.temperature += nodes[2 * n + 1] / body.heat_capacity;
  }
  for (RigidHeat& body : bodies) body.heat_input = 0;
  halo.exchange(particles, Halo::Thermal);
  return report;
}

}  // namespace stirsph
