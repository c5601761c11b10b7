#include "driver/scene_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "driver/probes.hpp"
#include "driver/simulation.hpp"

namespace stirsph {
namespace {

const char* on(bool value) { return value ? "on" : "off"; }

/// Seconds per step on these ranks, from a few real steps; heat solves count with their share.
double measured_step(Simulation& simulation) {
  constexpr int warm_up = 2, steps = 8;
  for (int k = 0; k < warm_up; ++k) simulation.step();
  const double heat_before =
      simulation.timers().seconds().contains("heat") ? simulation.timers().seconds().at("heat") : 0;
  double start = wall_seconds();
  for (int k = 0; k < steps; ++k) simulation.step();
  double seconds = (wall_seconds() - start) / steps;
  const HeatScene& heat = simulation.scene().heat;
  if (simulation.scene().mechanics && heat.mode == HeatScene::Mode::Conduction) {
    seconds -= (simulation.timers().seconds().at("heat") - heat_before) / steps;
    start = wall_seconds();
    simulation.solve_heat_now();
    seconds += (wall_seconds() - start) / heat.every;
  }
  return simulation.comm().max(seconds);
}

}  // namespace

std::string check_scene(const Comm& comm, const Scene& scene) {
  Simulation simulation(comm, scene);
  check_field_names(simulation);
  simulation.start();
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += fmt::format("{:<22} {}\n", name, value);
  };
  line("scene", fmt::format("{} ({})", scene.path, scene.title));
  line("space", std::string(keyword_of(scene.space)));
  line("mechanics", on(scene.mechanics));
  const char* heat[] = {"off", "adiabatic", "conduction"};
  line("heat", heat[static_cast<int>(scene.heat.mode)]);
  for (std::size_t r = 0; r < scene.rigids.size(); ++r) {
    const RigidHeat& body = simulation.rigid_heat()[r];
    if (body.role == RigidHeat::Role::Insulated) continue;
    line("heat in " + scene.rigids[r].name,
         body.mesh ? fmt::format("mesh of {} elements, {} nodes, {:.4g} J/K", body.mesh->mesh().elements.size(),
                                 body.mesh->nodes(), body.heat_capacity)
         : body.role == RigidHeat::Role::LumpedNode ? fmt::format("one node of {:.4g} J/K", body.heat_capacity)
                                                    : fmt::format("fixed at {:.5g} K", body.temperature));
  }
  for (std::size_t r = 0; r < scene.rigids.size(); ++r)
    if (const std::string plan = simulation.motions()[r].describe(); !plan.empty())
      line("motion of " + scene.rigids[r].name, plan);
  line("contact", fmt::format("{} ({} pairs)", on(!scene.contacts.empty()), scene.contacts.size()));
  if (scene.mechanics) {
    const MechanicsSettings& n = scene.numerics;
    const char* correction[] = {"off", "velocity gradient", "velocity gradient and momentum"};
    line("gradient correction", correction[static_cast<int>(n.gradient_correction)]);
    line("density diffusion",
         n.density_diffusion > 0 && n.density_reconstruction ? "on, reconstructed" : on(n.density_diffusion > 0));
    line("artificial stress", on(n.artificial_stress > 0));
    line("hourglass control", on(n.hourglass_control > 0));
    line("variable h", on(n.variable_h));
  }
  for (const BodyCount& body : simulation.body_counts()) {
    line("body " + body.name, fmt::format("{} particles, {:.5g} kg", body.particles, body.mass));
    if (body.particles < 100) line("", "warning: very few particles; is the spacing right?");
  }
  const double particles = static_cast<double>(simulation.particle_count());
  const double dt = simulation.clock().next_dt, steps = std::ceil(scene.time.end / dt);
  if (scene.mechanics) {
    const double waves = simulation.mechanics()->wave_speed(), speed = simulation.largest_speed();
    line("time step",
         fmt::format("{:.5g} s from {}", dt,
                     scene.time.fixed_step > 0 ? std::string("time.step")
                                               : fmt::format("cfl {} h/(c + |v|), c = {:.5g} m/s, |v| = {:.4g} m/s",
                                                             scene.time.cfl, waves, speed)));
    const double limit = scene.numerics.h_over_dx * scene.numerics.spacing / waves;
    if (scene.time.fixed_step > 0)
      line("", fmt::format("cfl of this step: {:.3g}{}", dt / limit,
                           dt / limit > 1 ? "  warning: beyond about 1 the integration is unstable" : ""));
    line("mass scaling", fmt::format("density x {:.5g}, elastic moduli x {:.4g}", scene.numerics.density_scale,
                                     scene.numerics.elastic_scale));
    for (const RigidBody& rigid : simulation.rigids())
      if (rigid.pose.angular_velocity != 0) {
        double radius = 0;
        const Bounds bounds = rigid.shape->bounds();
        for (double value : {bounds.low.x, bounds.high.x})
          if (std::isfinite(value)) radius = std::max(radius, std::abs(value - rigid.pose.centre.x));
        const double rim = std::abs(rigid.pose.angular_velocity) * radius;
        line("rim of " + rigid.name,
             fmt::format("{:.4g} m/s = {:.3g} wave speeds, {:.3g} spacings per step{}", rim, rim / waves,
                         rim * dt / scene.numerics.spacing,
                         !layout_of(scene.space).axisymmetric() && rim * dt > 0.25 * scene.numerics.spacing
                             ? "  warning: more than a quarter spacing per step"
                             : ""));
      }
  } else {
    line("time step", fmt::format("{:.5g} s (heat only)", dt));
  }
  line("steps",
       fmt::format("{:.0f}",
                   scene.time.most_steps > 0 ? std::min(steps, static_cast<double>(scene.time.most_steps)) : steps));
  const double seconds = measured_step(simulation);
  double bytes = static_cast<double>(simulation.particles().bytes() + simulation.neighbourhood().bytes() +
                                     (simulation.mechanics() ? simulation.mechanics()->bytes() : 0));
  bytes = comm.sum(bytes);
  line("memory", fmt::format("{:.4g} MB in {} ranks, {:.0f} B per particle{}", bytes / 1e6, comm.size(),
                             bytes / particles, simulation.heat_solver() ? " besides the heat solve" : ""));
  if (const HeatSolver* solver = simulation.heat_solver())
    line("", fmt::format("heat solve {:.4g} MB", comm.sum(static_cast<double>(solver->bytes())) / 1e6));
  const double count = scene.time.most_steps > 0 ? std::min(steps, static_cast<double>(scene.time.most_steps)) : steps;
  line("predicted wall time",
       fmt::format("{:.4g} s on {} ranks ({:.3g} s per step, {:.3g} particle-steps/s, measured now)", seconds * count,
                   comm.size(), seconds, particles / seconds));
  return text;
}

std::string parameter_manual() {
  return input::manual(scene_schema(), "Scene files") + "\n" + input::manual(material_schema(), "Material files");
}

}  // namespace stirsph
