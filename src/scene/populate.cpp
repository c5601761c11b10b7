#include "scene/populate.hpp"

#include <cmath>
#include <cstdint>

#include "geometry/lattice.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

LatticeSlice fill(const Scene& scene, const BodyScene& body, int rank, int size) {
  LatticeOptions options;
  options.dimensions = layout_of(scene.space).dim;
  options.origin = body.lattice_origin;
  options.margin = body.fill_margin * scene.numerics.spacing;
  try {
    return fill_with_lattice(*body.shape, scene.numerics.spacing, options, rank, size);
  } catch (const InputError& error) {
    throw InputError(scene.path + " body \"" + body.name + "\": " + error.what());
  }
}

double cell_volume(const Scene& scene) { return std::pow(scene.numerics.spacing, layout_of(scene.space).dim); }

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
    const std::int64_t n = fill(scene, body, 0, 1).total;
    counts.push_back(
        {body.name, n, static_cast<double>(n) * cell_volume(scene) * scene.materials[body.material].density});
  }
  return counts;
}

std::vector<BodyCount> populate(const Scene& scene, const Comm& comm, ParticleSet& particles) {
  std::vector<BodyCount> counts;
  std::int64_t first_id = 0;
  std::size_t next = 0;
  const int dim = layout_of(scene.space).dim;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const BodyScene& body = scene.bodies[b];
    const Material& material = scene.materials[body.material];
    const LatticeSlice slice = fill(scene, body, comm.rank(), comm.size());
    particles.resize_owned(next + slice.points.size());
    const double mass = cell_volume(scene) * material.density;
    for (std::size_t k = 0; k < slice.points.size(); ++k, ++next) {
      const std::int64_t id = first_id + slice.first + static_cast<std::int64_t>(k);
      Vec3 x = slice.points[k];
      if (body.jitter > 0)
        for (int d = 0; d < dim; ++d)
          x[d] += body.jitter * scene.numerics.spacing * scatter(static_cast<std::uint64_t>(3 * id + d));
      const Start start = start_at(scene, body, x);
      particles[field::id][next] = static_cast<double>(id);
      particles[field::body][next] = static_cast<double>(b);
      particles[field::material][next] = body.material;
      particles[field::mass][next] = mass;
      if (particles.has(field::sets)) particles[field::sets][next] = set_mask(scene, static_cast<int>(b), x);
      for (int d = 0; d < dim; ++d) {
        particles.component(field::position, d)[next] = x[d];
        if (particles.has(field::initial_position)) particles.component(field::initial_position, d)[next] = x[d];
        if (particles.has(field::velocity)) particles.component(field::velocity, d)[next] = start.velocity[d];
      }
      particles[field::volume][next] = cell_volume(scene);
      particles[field::smoothing_length][next] = scene.numerics.h_over_dx * scene.numerics.spacing;
      if (particles.has(field::temperature)) particles[field::temperature][next] = start.temperature;
    }
    counts.push_back({body.name, slice.total, mass * static_cast<double>(slice.total)});
    first_id += slice.total;
  }
  return counts;
}

}  // namespace stirsph
