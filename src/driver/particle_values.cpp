#include "driver/particle_values.hpp"

#include <cmath>

#include "microstructure/grain_evolution.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

std::function<double(std::size_t)> stress_value(const ParticleSet& particles, bool pressure) {
  std::vector<const double*> stress;
  for (int c = 0; c < particles.layout().stress_components; ++c)
    stress.push_back(particles.component(field::stress, c).data());
  if (pressure) return [stress](std::size_t i) { return -(stress[0][i] + stress[1][i] + stress[2][i]) / 3; };
  return [stress](std::size_t i) {
    const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) / 3;
    double sum = 0;
    for (std::size_t c = 0; c < stress.size(); ++c) {
      const double s = stress[c][i] - (c < 3 ? mean : 0);
      sum += (c < 3 ? 1.5 : 3.0) * s * s;
    }
    return std::sqrt(sum);
  };
}

}  // namespace

std::vector<DerivedQuantity> derived_quantities(const Scene& scene) {
  std::vector<DerivedQuantity> list{{"radius", "m", "distance from the z axis", false},
                                    {"height", "m", "coordinate z", false}};
  if (scene.mechanics) {
    list.push_back({"von_mises", "Pa", "equivalent stress sqrt(3/2 s:s)"});
    list.push_back({"pressure", "Pa", "minus the mean stress"});
  }
  if (scene.microstructure) list.push_back({"hardness", "HV", "Vickers hardness of the grain size (Hall-Petch)"});
  return list;
}

const Field* find_field(const ParticleSet& particles, const std::string& name) {
  for (const auto& field : particles.fields())
    if (field->info->name == name) return field.get();
  return nullptr;
}

std::function<double(std::size_t)> particle_value(const Simulation& simulation, const std::string& name,
                                                  int component) {
  const ParticleSet& particles = simulation.particles();
  if (name == "von_mises" || name == "pressure") return stress_value(particles, name == "pressure");
  if (name == "hardness")
    return
        [&particles, laws = grain_laws(simulation.scene())](std::size_t i) { return hardness_of(particles, laws, i); };
  if (name == "height") return [&particles](std::size_t i) { return particles.vector_at(field::position, i).z; };
  if (name == "radius")
    return [&particles](std::size_t i) {
      const Vec3 x = particles.vector_at(field::position, i);
      return std::hypot(x.x, x.y);
    };
  const double* values = find_field(particles, name)->components[static_cast<std::size_t>(component)].data();
  return [values](std::size_t i) { return values[i]; };
}

std::vector<DerivedField> derived_fields(const Simulation& simulation) {
  std::vector<DerivedField> fields;
  for (const DerivedQuantity& quantity : derived_quantities(simulation.scene())) {
    if (!quantity.snapshot) continue;
    const std::string name(quantity.name);
    DerivedField field{name, std::string(quantity.unit), std::string(quantity.meaning), {}};
    const auto value = particle_value(simulation, name);
    for (std::size_t i = 0; i < simulation.particles().owned(); ++i) field.values.push_back(value(i));
    fields.push_back(std::move(field));
  }
  return fields;
}

}  // namespace stirsph
