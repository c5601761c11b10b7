/// Numbers about the present state that users watch: energies, extremes, forces, probes. Collective to collect.
#pragma once

#include <string>
#include <vector>

#include "driver/simulation.hpp"
#include "io/history.hpp"

namespace stirsph {

/// Energies over all ranks [J]. Signs: everything the particles gained or dissipated is positive, work done on them
/// too.
struct EnergyBalance {
  double kinetic = 0;           ///< with scaled inertia
  double kinetic_physical = 0;  ///< with physical mass
  double elastic = 0, plastic = 0, viscous = 0, artificial = 0, hourglass = 0, diffusion = 0, unmatched = 0,
         friction = 0, contact = 0;
  double stored = 0;    ///< elastic energy of the present stresses
  double external = 0;  ///< by rigid bodies, body force and grips
  double initial_kinetic = 0;
  double rescaling = 0;  ///< kinetic energy that changes of the density scale made
  /// (gained + dissipated - work done)/(largest of the energies involved); zero before anything happened.
  double residual() const;
  /// Elastic work that is not stored, over the same: negative where steps are too large for metal that flows, whose
  /// strain then oscillates from step to step. Plastic work and its heat are too large by as much.
  double unstored() const;

 private:
  double scale() const;
};

struct Diagnostics {
  EnergyBalance energy;
  double temperature_min = 0, temperature_max = 0;  ///< K
  double plastic_strain_max = 0;
  double inertia_number = 0;  ///< max of rho_scaled v^2/sigma_y
  double viscous_ratio = 0;   ///< viscous over plastic dissipation
  std::int64_t molten = 0;    ///< particles above the melting temperature of their flow stress
  std::int64_t leaked = 0;    ///< particles further inside a rigid body than a spacing, or gone
  std::vector<double> probes;
};

Diagnostics diagnose(const Simulation& simulation);

/// Columns and values of history.csv besides the time.
std::vector<HistoryColumn> history_columns(const Scene& scene);
std::vector<double> history_row(const Simulation& simulation, const Diagnostics& diagnostics);

/// Whether metal can get hotter than a flow stress of the scene has a meaning.
bool can_melt(const Scene& scene);

/// Index of the rigid body a log line shows as "the tool": the first that moves or turns; -1 without one.
int tool_index(const Scene& scene);

}  // namespace stirsph
