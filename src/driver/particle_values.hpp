/// What outputs can show of a particle: components of its fields, and quantities derived from them when they are asked
/// for. Derived quantities cost no memory during the run.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "driver/simulation.hpp"
#include "io/snapshot.hpp"

namespace stirsph {

struct DerivedQuantity {
  std::string_view name, unit, meaning;
  bool snapshot = true;  ///< written to snapshots
};

/// The derived quantities that this scene has.
std::vector<DerivedQuantity> derived_quantities(const Scene& scene);

/// The field of this name; null if the particles have none.
const Field* find_field(const ParticleSet& particles, const std::string& name);

/// One component of a field, or a derived quantity, as a function of the local particle. The name must be known
/// (check_field_names). Valid until the particles move in memory: for immediate use.
std::function<double(std::size_t)> particle_value(const Simulation& simulation, const std::string& name,
                                                  int component = 0);

/// All derived quantities for a snapshot.
std::vector<DerivedField> derived_fields(const Simulation& simulation);

}  // namespace stirsph
