#include "thermal/heat_solver.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "particles/field_names.hpp"
#include "thermal/conduction.hpp"
#include "thermal/free_surface.hpp"
#include "thermal/heat_matrix.hpp"
#include "thermal/linear_solve.hpp"
#include "thermal/rigid_nodes.hpp"

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

}  // namespace

/// Rows of a rank: its particles, then its nodes of rigid bodies.
struct HeatSolver::Impl {
  Impl(Comm c, const Kernel& kernel, int dim, const HeatSettings& s, std::vector<ThermalProperties> m)
      : comm(c),
        settings(s),
        materials(std::move(m)),
        op(make_operator(kernel, dim, s)),
        surface_resistance(lattice_surface_resistance(kernel, dim, s.smoothing_length / s.spacing)),
        implicit_share(s.scheme == HeatSettings::Scheme::CrankNicolson ? 0.5 : 1.0),
        linear_solve(c, {s.relative_tolerance, s.maximum_iterations}) {
    for (const ThermalProperties& material : materials) linear = linear && constant(material);
  }

  static bool constant(const ThermalProperties& material) {
    return material.conductivity.constant() && material.specific_heat.constant();
  }
  const ThermalProperties& material_of(const ParticleSet& particles, std::size_t i) const {
    return materials[static_cast<std::size_t>(particles[field::material][i])];
  }
  void check(std::span<const InterfacePoint> points, std::span<const RigidHeat> bodies) const;
  void correct(ParticleSet& particles, const PairList& pairs, std::span<const InterfacePoint> points);
  void place_nodes(std::span<const RigidHeat> bodies);
  void linearise(ParticleSet& particles, std::span<const RigidHeat> bodies, const std::vector<double>& end);
  void link(const ParticleSet& particles, std::span<const InterfacePoint> points, std::span<const RigidHeat> bodies);
  bool fill(const ParticleSet& particles, const ParticleFilm* film, double dt, bool fresh);
  void assemble(const ParticleSet& particles, const PairList& pairs, const ParticleFilm* film, double dt);
  LinearSolve::Outcome solve();
  double update_end(const ParticleSet& particles, std::span<const RigidHeat> bodies, std::vector<double>& end);
  HeatReport balance(const ParticleSet& particles, const ParticleFilm* film, double dt) const;
  std::span<const RigidLink> links_of(std::size_t particle) const {
    return {links.data() + link_starts[particle], links.data() + link_starts[particle + 1]};
  }

  Comm comm;
  HeatSettings settings;
  std::vector<ThermalProperties> materials;
  ConductionOperator op;
  double surface_resistance;  ///< b, in units of dx/k
  double implicit_share;      ///< theta of the scheme: fluxes are those of T + theta (T' - T)
  bool linear = true;         ///< no property depends on temperature
  LinearSolve linear_solve;
  std::unique_ptr<RigidNodes> nodes;
  HeatGraph graph;
  HeatMatrix matrix;
  std::uint64_t pattern_version = 0;  ///< of the pair list the pattern was made with
  std::vector<double> capacity;       ///< J/K of each particle, m times the linearised specific heat
  std::vector<double> right, rise;    ///< J and K per row
  std::vector<double> heat;           ///< J gained per row
  std::vector<RigidLink> links;       ///< sorted by particle
  std::vector<std::size_t> link_starts;
  std::vector<NodeWeight> link_nodes;
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

std::size_t HeatSolver::bytes() const {
  const Impl& m = *impl_;
  return m.matrix.bytes() + m.graph.bytes() + (m.nodes ? m.nodes->bytes() : 0) +
         (m.capacity.capacity() + m.right.capacity() + m.rise.capacity() + m.heat.capacity()) * sizeof(double) +
         m.links.capacity() * sizeof(RigidLink) + m.link_nodes.capacity() * sizeof(NodeWeight);
}

/// Mistakes of the scene, told on all ranks: heat given to a body that takes none would vanish, and a lumped body
/// without heat capacity has no temperature of its own.
void HeatSolver::Impl::check(std::span<const InterfacePoint> points, std::span<const RigidHeat> bodies) const {
  comm.together([&] {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (bodies[b].role == RigidHeat::Role::LumpedNode && !(bodies[b].heat_capacity > 0))
        throw InputError(
            fmt::format("rigid body {} is a lumped heat node with a heat capacity of {} J/K: it must be positive", b,
                        bodies[b].heat_capacity));
    for (const InterfacePoint& point : points)
      if (bodies[point.body].role == RigidHeat::Role::Insulated && point.heat != 0)
        throw InputError(
            fmt::format("rigid body {} is insulated but received {:.6g} J of friction heat: give it a "
                        "temperature or a heat capacity, or let all friction heat go to the particles",
                        point.body, point.heat));
  });
}

void HeatSolver::Impl::correct(ParticleSet& particles, const PairList& pairs, std::span<const InterfacePoint> points) {
  const bool hybrid = std::ranges::any_of(points, [](const InterfacePoint& p) { return p.kernel_sum > 0; });
  std::vector<double> embedded(hybrid ? particles.owned() : 0, 0.0);
  if (hybrid)
    for (const InterfacePoint& point : points) embedded[point.particle] += point.kernel_sum;
  graph.build(particles, pairs, op, embedded);
}

std::vector<double> HeatSolver::free_surface(ParticleSet& particles, const PairList& pairs,
                                             std::span<const InterfacePoint> points,
                                             std::span<const RigidBody> rigids) {
  impl_->correct(particles, pairs, points);
  const double reach = contact_reach * impl_->settings.spacing;
  std::vector<SurfaceFoot> feet;
  for (const RigidBody& rigid : rigids)
    for (std::size_t i = 0; i < particles.owned(); ++i) {
      const Vec3 x = particles.vector_at(field::position, i);
      const SurfacePoint surface = rigid.nearest(x);
      if (surface.distance < reach)
        feet.push_back(
            {static_cast<std::int32_t>(i), x - surface.distance * surface.normal, surface.normal, surface.distance});
    }
  return free_surface_areas(particles, pairs, feet);
}

void HeatSolver::Impl::place_nodes(std::span<const RigidHeat> bodies) {
  if (!nodes) {
    nodes = std::make_unique<RigidNodes>(comm, bodies);
    for (const RigidHeat& body : bodies) linear = linear && (!body.mesh || constant(body.mesh->material()));
  }
  nodes->begin_step(bodies);
}

/// Properties for the step from the old temperatures (field::temperature) to `end`.
void HeatSolver::Impl::linearise(ParticleSet& particles, std::span<const RigidHeat> bodies,
                                 const std::vector<double>& end) {
  nodes->linearise(bodies, implicit_share);
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

/// Heat paths to rigid bodies with the present conductivities. The resistance per area of a film is
///   R = 1/h_c + max(distance - b dx, 0.05 dx) / k_i;
/// b (lattice_surface_resistance) lets the wall temperature act at the true surface. The lower bound keeps the
/// conductance positive and finite for a particle that has been pushed into the wall: less than 1/20 of a spacing is
/// below what the particles resolve, and a film would only be hidden, not lost, behind it.
void HeatSolver::Impl::link(const ParticleSet& particles, std::span<const InterfacePoint> points,
                            std::span<const RigidHeat> bodies) {
  const auto conductivity = particles[field::conductivity];
  const auto temperature = particles[field::temperature], correction = particles[field::conduction_correction];
  links.clear();
  link_nodes.clear();
  std::size_t needed = 0;
  for (const InterfacePoint& point : points) needed += std::max<std::size_t>(1, point.nodes.size());
  link_nodes.reserve(needed);  // the links hold spans of it
  for (const InterfacePoint& point : points) {
    const RigidHeat& body = bodies[point.body];
    if (body.role == RigidHeat::Role::Insulated) continue;
    STIRSPH_EXPECT(point.particle >= 0 && std::size_t(point.particle) < particles.owned(), "of an owned particle");
    const std::int32_t first = nodes->first_node(point.body);
    const std::size_t begin = link_nodes.size();
    if (point.nodes.empty()) link_nodes.push_back({first, 1.0});
    for (const NodeWeight& node : point.nodes) link_nodes.push_back({first + node.node, node.weight});

    const double k = conductivity[point.particle], film = body.film(point.pressure);
    double conductance = 0;
    if (point.shape_factor > 0) {
      double there = 0;  // K, temperature of the body where the path ends
      for (std::size_t n = begin; n < link_nodes.size(); ++n)
        there += link_nodes[n].weight * nodes->start(link_nodes[n].node);
      const double other = body.mesh ? body.mesh->material().conductivity(there) : k;
      // Embedded particles are surrounded on all sides: their correction is 1.
      const double scale = 0.5 * (correction[point.particle] + 1) / op.lattice_factor;
      conductance = k + other > 0 ? scale * point.shape_factor * 2 * k * other / (k + other) : 0.0;
    } else if (k > 0 && film > 0 && point.area > 0) {
      const double depth = std::max(point.distance - surface_resistance * settings.spacing, 0.05 * settings.spacing);
      conductance = point.area / ((std::isinf(film) ? 0.0 : 1 / film) + depth / k);
    }
    if (conductance > 0 || point.heat != 0)
      links.push_back({point.particle,
                       point.body,
                       conductance,
                       point.heat,
                       {link_nodes.data() + begin, link_nodes.data() + link_nodes.size()}});
  }
  std::stable_sort(links.begin(), links.end(),
                   [](const RigidLink& a, const RigidLink& b) { return a.particle < b.particle; });
  link_starts.assign(particles.owned() + 1, 0);
  for (const RigidLink& l : links) link_starts[l.particle + 1] += 1;
  for (std::size_t i = 0; i < particles.owned(); ++i) link_starts[i + 1] += link_starts[i];
  nodes->receive_links(comm, links, particles[field::matrix_row], temperature);
}

/// Writes matrix and right side for the unknown rise d = T' - T:
///   (C + theta dt K) d = q - dt K T,
/// with K the graph Laplacian of all heat links. Solving for the rise makes the tolerance relative to the heat that
/// moves. Returns false when the present pattern does not fit.
bool HeatSolver::Impl::fill(const ParticleSet& particles, const ParticleFilm* film, double dt, bool fresh) {
  const auto heat_input = particles[field::heat_input];
  const auto matrix_row = particles[field::matrix_row];
  const auto owned = static_cast<int>(particles.owned());
  const double weight = implicit_share * dt;
  HeatMatrixWriter writer(matrix, nodes->first_row(), particles.owned() + nodes->owned(), fresh);

  const LinkEnds ends(particles);
  std::vector<int> columns;
  std::vector<double> values;
  for (std::size_t i = 0; i < particles.owned() && writer.fits(); ++i) {
    const auto neighbours = graph.neighbours(i);
    const auto factors = graph.factors(i);
    const std::size_t before = static_cast<std::size_t>(
        std::lower_bound(neighbours.begin(), neighbours.end(), static_cast<std::int32_t>(i)) - neighbours.begin());
    columns.resize(neighbours.size() + 1);  // the diagonal stands at its place among the neighbours
    values.resize(neighbours.size() + 1);
    double sum = 0, power = 0;
    for (std::size_t k = 0; k < neighbours.size(); ++k) {
      const double g = ends.conductance(i, neighbours[k], factors[k]);
      sum += g;
      power += g * (ends.temperature(neighbours[k]) - ends.temperature(i));
      const std::size_t at = k < before ? k : k + 1;
      columns[at] = neighbours[k];
      values[at] = -weight * g;
    }
    const auto paths = links_of(i);
    for (const RigidLink& l : paths) {
      sum += l.conductance;
      for (const NodeWeight& node : l.nodes)
        power += l.conductance * node.weight * (nodes->start(node.node) - ends.temperature(i));
    }
    if (film) {
      sum += film->conductance[i];
      power += film->conductance[i] * (film->ambient_temperature - ends.temperature(i));
    }
    right[i] = heat_input[i] + dt * power;
    columns[before] = static_cast<int>(i);
    values[before] = capacity[i] + weight * sum;
    // Halo copies stand behind the owned particles: a row whose last neighbour is owned has no other rank in it.
    if (paths.empty() && columns.back() < owned) {
      writer.add_own_row(columns, values);
      continue;
    }
    writer.begin_row();
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (columns[k] < owned)
        writer.add_local(columns[k], values[k]);
      else
        writer.add_global(static_cast<std::int64_t>(matrix_row[columns[k]]), values[k]);
    for (const RigidLink& l : paths)
      if (l.conductance > 0)
        for (const NodeWeight& node : l.nodes)
          if (!nodes->fixed(node.node))
            writer.add_global(nodes->row(node.node), -weight * (l.conductance * node.weight));
    writer.end_row();
  }
  if (writer.fits()) nodes->fill(writer, std::span(right).subspan(particles.owned()), dt, implicit_share);
  return writer.fits();
}

void HeatSolver::Impl::assemble(const ParticleSet& particles, const PairList& pairs, const ParticleFilm* film,
                                double dt) {
  // The pattern holds the neighbours within the support only, half of the candidates. It is tried again while the list
  // lives, since a fixed arrangement or a nonlinear iteration keeps it; columns are compared, so a list under which the
  // particles have moved on is noticed.
  const bool fits = matrix.rows() > 0 && pattern_version == pairs.version() && fill(particles, film, dt, false);
  pattern_version = pairs.version();
  if (comm.any(!fits)) {
    linear_solve.release_matrix();
    fill(particles, film, dt, true);
  }
  linear_solve.use_matrix(matrix);
}

/// Solves, and finds the heat each row gained from the fluxes of the solution, q - dt K (T + theta d) = C d + (b - A
/// d), rather than from C d: what one row gains another loses, so the balance holds to rounding at any tolerance.
LinearSolve::Outcome HeatSolver::Impl::solve() {
  const LinearSolve::Outcome outcome = linear_solve.solve(right, rise);
  heat.resize(rise.size());
  linear_solve.residual(right, rise, heat);
  for (std::size_t i = 0; i < rise.size(); ++i)
    heat[i] += (i < capacity.size() ? capacity[i] : nodes->capacity(i - capacity.size())) * rise[i];
  return outcome;
}

/// New temperatures from the heat each particle received, so that enthalpy is conserved exactly also where c_p(T) was
/// linearised. Returns the largest change of `end` against the former iterate, relative to the largest rise.
/// Collective.
double HeatSolver::Impl::update_end(const ParticleSet& particles, std::span<const RigidHeat> bodies,
                                    std::vector<double>& end) {
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
  const std::size_t owned = particles.owned();
  const auto [change, largest] =
      nodes->update_end(comm, bodies, std::span(heat).subspan(owned), std::span(rise).subspan(owned));
  const double scale = std::max(extremes[1], largest);
  return scale > 0 ? std::max(extremes[0], change) / scale : 0;
}

/// Where the heat of the step went. Collective.
HeatReport HeatSolver::Impl::balance(const ParticleSet& particles, const ParticleFilm* film, double dt) const {
  const auto temperature = particles[field::temperature];
  const auto heat_input = particles[field::heat_input];
  const auto between = [&](std::size_t i) { return temperature[i] + implicit_share * rise[i]; };
  double gained = 0, sources = 0, fixed = 0, ambient = 0;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    gained += heat[i];
    sources += heat_input[i];
    if (film) ambient += dt * film->conductance[i] * (between(i) - film->ambient_temperature);
  }
  const auto outflow = nodes->outflow(std::span(heat).subspan(particles.owned()), dt, implicit_share);
  std::vector<BodyHeat> bodies(outflow.size());
  double rigid = 0;
  for (std::size_t b = 0; b < outflow.size(); ++b) {
    bodies[b].gained = outflow[b].gained;
    bodies[b].surface = outflow[b].film + outflow[b].fixed;
    rigid += outflow[b].gained;
    ambient += outflow[b].film;
    fixed += outflow[b].fixed;
    sources += outflow[b].sources;
  }
  for (const RigidLink& l : links) {
    BodyHeat& body = bodies[l.body];
    sources += l.heat;
    body.friction += l.heat;
    double flow = 0, fixed_share = 0;
    for (const NodeWeight& node : l.nodes) {
      flow += dt * l.conductance * node.weight * (between(l.particle) - nodes->between(node.node, implicit_share));
      if (nodes->fixed(node.node)) fixed_share += node.weight;
    }
    // A node receives its share of the whole flow of the link, which ends at the weighted temperature.
    const double into_fixed = fixed_share * (flow + l.heat);
    body.interface += flow;
    body.surface += into_fixed;
    fixed += into_fixed;
  }
  std::vector<double> sums{gained, rigid, sources, fixed, ambient};
  for (const BodyHeat& body : bodies)
    sums.insert(sums.end(), {body.gained, body.interface, body.surface, body.friction});
  comm.sum_in_place(sums);
  HeatReport report;
  report.particle_heat = sums[0];
  report.rigid_heat = sums[1];
  report.source_heat = sums[2];
  report.fixed_heat = sums[3];
  report.ambient_heat = sums[4];
  for (std::size_t b = 0; b < bodies.size(); ++b)
    report.bodies.push_back({sums[5 + 4 * b], sums[6 + 4 * b], sums[7 + 4 * b], sums[8 + 4 * b]});
  return report;
}

HeatReport HeatSolver::advance(ParticleSet& particles, const PairList& pairs, const HaloExchange& halo,
                               std::span<const InterfacePoint> points, std::span<RigidHeat> bodies, double dt,
                               const ParticleFilm* film) {
  Impl& m = *impl_;
  const std::size_t owned = particles.owned();
  const auto temperature = particles[field::temperature];
  m.check(points, bodies);
  m.place_nodes(bodies);
  m.nodes->number_rows(m.comm, owned);
  const std::size_t rows = owned + m.nodes->owned();
  if (m.comm.sum(static_cast<std::int64_t>(rows)) > std::numeric_limits<int>::max())
    throw InputError("the heat matrix has more than 2^31 rows, more than this version can number");
  const auto matrix_row = particles[field::matrix_row];
  for (std::size_t i = 0; i < owned; ++i)
    matrix_row[i] = static_cast<double>(m.nodes->first_row() + static_cast<std::int64_t>(i));
  if (!film) m.correct(particles, pairs, points);
  m.right.assign(rows, 0.0);
  m.rise.assign(rows, 0.0);

  LinearSolve::Outcome outcome;
  int iterations = 0;
  std::vector<double> end(temperature.begin(), temperature.begin() + static_cast<std::ptrdiff_t>(owned));
  const int solves = m.linear ? 1 : std::max(1, m.settings.nonlinear_iterations);
  for (int k = 0; k < solves; ++k) {
    m.linearise(particles, bodies, end);
    halo.exchange(particles, Halo::Thermal);
    m.link(particles, points, bodies);
    m.assemble(particles, pairs, film, dt);
    outcome = m.solve();
    iterations += outcome.iterations;
    const double change = m.update_end(particles, bodies, end);
    if (change <= 10 * m.settings.relative_tolerance) break;
  }

  HeatReport report = m.balance(particles, film, dt);
  report.iterations = iterations;
  report.residual = outcome.residual;
  std::copy(end.begin(), end.end(), temperature.begin());
  std::fill_n(particles[field::heat_input].begin(), owned, 0.0);
  m.nodes->finish_step(bodies);
  halo.exchange(particles, Halo::Thermal);
  return report;
}

}  // namespace stirsph
