#include "scene/populate.hpp"

#include <cmath>
#include <cstdint>
#include <numbers>

#include "geometry/lattice.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

LatticeSlice fill(const Scene& scene, const BodyScene& body, int rank, int size) {
  LatticeOptions options;
  const SpaceLayout layout = layout_of(scene.space);
  options.dimensions = layout.dim;
  options.axes = layout.axes;
  options.half_plane = layout.axisymmetric();
  options.origin = body.lattice_origin;
  for (int d = 0; d < layout.dim; ++d)
    if (scene.domain.symmetric[d]) options.above[layout.axes[d]] = scene.domain.plane[d];
  options.margin = body.fill_margin * scene.numerics.spacing;
  try {
    return fill_with_lattice(*body.shape, scene.numerics.spacing, options, rank, size);
  } catch (const InputError& error) {
    throw InputError(scene.path + " body \"" + body.name + "\": " + error.what());
  }
}

/// m3 of the particle at x (per metre of depth in plane strain): a cube, a square, a ring.
double cell_volume(const Scene& scene, const Vec3& x) {
  const SpaceLayout layout = layout_of(scene.space);
  const double cell = std::pow(scene.numerics.spacing, layout.dim);
  return layout.axisymmetric() ? 2 * std::numbers::pi * x.x * cell : cell;
}

/// A number in [-1, 1) from an integer, the same on every machine and rank (splitmix64).
double scatter(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15ULL;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9ULL;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebULL;
  return static_cast<double>((key ^ (key >> 31)) >> 11) * 0x1p-52 - 1.0;
}

struct Start {
  Vec3 velocity;       ///< m/s
  double temperature;  ///< K
};

Start start_at(const Scene& scene, const BodyScene& body, const Vec3& x) {
  try {
    Start start;
    for (int d = 0; d < 3; ++d)
      if (body.velocity[d]) start.velocity[d] = (*body.velocity[d])({x.x, x.y, x.z});
    if (body.rotation)
      start.velocity += body.rotation->rate({0.0}) * cross(body.rotation->axis, x - body.rotation->centre);
    start.temperature = body.temperature({x.x, x.y, x.z});
    const double speed = norm(start.velocity);
    if (!std::isfinite(speed))
      throw InputError("the velocity has no finite value at x, y, z = " + std::to_string(x.x) + ", " +
                       std::to_string(x.y) + ", " + std::to_string(x.z) + " m");
    const Material& material = scene.materials[body.material];
    if (const double hottest = material.flow ? material.flow->melting_temperature() : start.temperature;
        start.temperature > hottest)
      throw InputError("the temperature is " + std::to_string(start.temperature) +
                       " K, above the melting temperature of " + material.name + ", " + std::to_string(hottest) +
                       " K: flow stresses end there. Allowed: up to that temperature");
    if (!(start.temperature > 0))
      throw InputError("the temperature is " + std::to_string(start.temperature) +
                       " K at x, y, z = " + std::to_string(x.x) + ", " + std::to_string(x.y) + ", " +
                       std::to_string(x.z) + " m. Allowed: > 0 K");
    return start;
  } catch (const InputError& wrong) {
    throw InputError(scene.path + " body \"" + body.name + "\": " + wrong.what());
  }
}

double set_mask(const Scene& scene, int body, const Vec3& x) {
  std::uint64_t mask = 0;
  for (std::size_t s = 0; s < scene.sets.size(); ++s)
    if (scene.sets[s].bodies[body] && (!scene.sets[s].region || scene.sets[s].region->distance(x) <= 0))
      mask |= std::uint64_t(1) << s;
  return static_cast<double>(mask);
}

}  // namespace

std::vector<BodyCount> count_particles(const Scene& scene) {
  std::vector<BodyCount> counts;
  for (const BodyScene& body : scene.bodies) {
    const LatticeSlice all = fill(scene, body, 0, 1);
    double volume = 0;
    for (const Vec3& x : all.points) volume += cell_volume(scene, x);
    counts.push_back({body.name, all.total, volume * scene.materials[body.material].density});
  }
  return counts;
}

std::vector<BodyCount> populate(const Scene& scene, const Comm& comm, ParticleSet& particles) {
  std::vector<BodyCount> counts;
  std::int64_t first_id = 0;
  std::size_t next = 0;
  const SpaceLayout layout = layout_of(scene.space);
  const int dim = layout.dim;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyScene& body = scene.bodies[b];
    const Material& material = scene.materials[body.material];
    const LatticeSlice slice = fill(scene, body, comm.rank(), comm.size());
    particles.resize_owned(next + slice.points.size());
    double mass = 0;
    for (std::size_t k = 0; k < slice.points.size(); ++k, ++next) {
      const std::int64_t id = first_id + slice.first + static_cast<std::int64_t>(k);
      Vec3 x = slice.points[k];
      if (body.jitter > 0)
        for (int d = 0; d < dim; ++d)
          x[layout.axes[d]] += body.jitter * scene.numerics.spacing * scatter(static_cast<std::uint64_t>(3 * id + d));
      const double volume = cell_volume(scene, x);
      mass += volume * material.density;
      const Start start = start_at(scene, body, x);
      particles[field::id][next] = static_cast<double>(id);
      particles[field::body][next] = static_cast<double>(b);
      particles[field::material][next] = body.material;
      particles[field::mass][next] = volume * material.density;
      if (particles.has(field::sets)) particles[field::sets][next] = set_mask(scene, static_cast<int>(b), x);
      for (int d = 0; d < dim; ++d) {
        particles.component(field::position, d)[next] = x[layout.axes[d]];
        if (particles.has(field::initial_position))
          particles.component(field::initial_position, d)[next] = x[layout.axes[d]];
      }
      if (particles.has(field::velocity))
        for (int c = 0; c < layout.velocity_components; ++c)
          particles.component(field::velocity, c)[next] = start.velocity[c];
      particles[field::volume][next] = volume;
      particles[field::smoothing_length][next] = scene.numerics.h_over_dx * scene.numerics.spacing;
      if (particles.has(field::temperature)) particles[field::temperature][next] = start.temperature;
    }
    counts.push_back({body.name, slice.total, mass});
    first_id += slice.total;
  }
  return counts;
}

}  // namespace stirsph
