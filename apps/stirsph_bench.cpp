/// stirsph_bench: speed and memory of the mechanical step on fixed scenes. Figures are reported, never asserted.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <iostream>

#include "base/comm.hpp"
#include "base/log.hpp"
#include "driver/run.hpp"
#include "driver/simulation.hpp"
#include "geometry/primitives.hpp"
#include "io/files.hpp"
#include "particles/field_names.hpp"
#include "thermal/petsc_session.hpp"

namespace {

using namespace stirsph;

struct Arguments {
  std::string scene = "block";
  std::int64_t particles = 100000;
  int steps = 100;
  bool gradient_correction = false;
};

/// An elastoplastic Johnson-Cook block of AA2024 that is squeezed and turned, so that it yields and its lists age.
Scene block_scene(const Arguments& arguments) {
  Scene scene;
  scene.title = "elastoplastic block";
  scene.path = "stirsph_bench block";
  scene.materials.push_back(make_material(input::parse_text(R"(
name = "AA2024"
density = "2785 kg/m3"
[elastic]
youngs_modulus = "72.4 GPa"
poisson_ratio = 0.33
[flow_stress]
model = "johnson_cook"
A = "265 MPa"
C = 0.015
reference_temperature = "293.15 K"
melting_temperature = "823.15 K"
)",
                                                            "bench material", material_schema())));
  const double spacing = 0.4e-3;
  const double side = spacing * std::round(std::cbrt(static_cast<double>(arguments.particles)));
  scene.numerics.spacing = spacing;
  if (arguments.gradient_correction) scene.numerics.gradient_correction = GradientCorrection::Velocity;
  scene.domain.dim = 3;
  scene.time.end = 1;
  BodyScene body;
  body.name = "block";
  body.shape = std::make_shared<Box>(Vec3{}, Vec3{side, side, side});
  body.temperature = input::Expression(500.0);
  // Compressed at 1e4/s, so that it keeps yielding, and spun at 3000 rad/s, so that absolute motion ages the lists.
  const std::string half = std::to_string(0.5 * side);
  body.velocity[2] = input::Expression("-1e4*(z-" + half + ")", {"x", "y", "z"});
  body.rotation = RotationScene{{0.5 * side, 0.5 * side, 0.5 * side}, {0, 0, 1}, input::Expression(3000.0)};
  scene.bodies.push_back(body);
  return scene;
}

/// Mean number of neighbours within the support, self not counted.
double mean_neighbours(const Simulation& simulation) {
  const ParticleSet& particles = simulation.particles();
  const PairList& pairs = simulation.neighbourhood().pairs();
  const double support = simulation.scene().numerics.h_over_dx * simulation.scene().numerics.spacing *
                         kernel_support(simulation.scene().numerics.kernel);
  double count = 0;
  for (std::size_t c = 0; c < pairs.clusters(); ++c)
    for (std::size_t i = c * cluster_size; i < std::min((c + 1) * cluster_size, particles.owned()); ++i)
      for (const std::int32_t j : pairs.candidates(c))
        count += static_cast<std::size_t>(j) != i &&
                 norm(particles.vector_at(field::position, i) - particles.vector_at(field::position, j)) < support;
  return simulation.comm().sum(count) / static_cast<double>(simulation.particle_count());
}

void measure(const Comm& comm, const Arguments& arguments) {
  Simulation simulation(comm, block_scene(arguments));
  simulation.start();
  const double neighbours = mean_neighbours(simulation);
  for (int k = 0; k < 3; ++k) simulation.step();  // warm caches and lists
  const PhaseTimers before = simulation.timers();
  const long rebuilds = simulation.neighbourhood().rebuilds();
  comm.barrier();
  const double start = wall_seconds();
  for (int k = 0; k < arguments.steps; ++k) simulation.step();
  comm.barrier();
  const double seconds = wall_seconds() - start;
  const double particles = static_cast<double>(simulation.particle_count());
  const double bytes = comm.sum(static_cast<double>(
      simulation.particles().bytes() + simulation.neighbourhood().bytes() + simulation.mechanics()->bytes()));
  const double yielding = comm.sum(static_cast<double>(simulation.mechanics()->counters().yielding));
  const double candidates = comm.sum(static_cast<double>(simulation.neighbourhood().pairs().size()));
  if (comm.is_root())
    fmt::print(
        "{}\nscene {}: {:.0f} particles, {} steps, {:.1f} neighbours, {:.1f} candidates per cluster, {} list "
        "rebuilds, {:.0f} % yielding, gradient correction {}\n",
        version_text(), arguments.scene, particles, arguments.steps, neighbours,
        candidates / (particles / cluster_size), simulation.neighbourhood().rebuilds() - rebuilds,
        100 * yielding / particles, arguments.gradient_correction ? "on" : "off");
  for (const auto& [phase, total] : simulation.timers().seconds()) {
    const auto found = before.seconds().find(phase);
    const double own = total - (found == before.seconds().end() ? 0.0 : found->second);
    const double least = comm.min(own), most = comm.max(own), mean = comm.sum(own) / comm.size();
    if (comm.is_root())
      fmt::print("  {:<12} {:9.4f} s mean ({:.4f} .. {:.4f} over ranks), {:5.1f} %\n", phase, mean, least, most,
                 100 * mean / seconds);
  }
  if (comm.is_root())
    fmt::print("particle_steps_per_s_per_core={:.4g} neighbours={:.2f} bytes_per_particle={:.0f} ranks={}\n",
               particles * arguments.steps / seconds / comm.size(), neighbours, bytes / particles, comm.size());
}

}  // namespace

int main(int argc, char** argv) {
  stirsph::skip_display_probes();
  stirsph::choose_mpi_io();
  MPI_Init(&argc, &argv);
  int status = 0;
  {
    const stirsph::Comm comm;
    Arguments arguments;
    CLI::App app("Speed and memory of the mechanical step");
    app.add_option("scene", arguments.scene, "scene")->check(CLI::IsMember({"block"}))->capture_default_str();
    app.add_option("--particles", arguments.particles, "number of particles (rounded to a cube)")
        ->check(CLI::Range(8, 100000000))
        ->capture_default_str();
    app.add_option("--steps", arguments.steps, "steps to time")->check(CLI::PositiveNumber)->capture_default_str();
    app.add_flag("--gradient-correction", arguments.gradient_correction, "renormalised velocity gradient");
    try {
      app.parse(argc, argv);
      const stirsph::PetscSession petsc;
      measure(comm, arguments);
    } catch (const CLI::ParseError& error) {
      status = comm.is_root() ? app.exit(error) : error.get_exit_code();
    } catch (const std::exception& error) {
      std::cerr << "stirsph_bench: " << error.what() << std::endl;
      status = static_cast<int>(stirsph::ExitCode::Internal);
      MPI_Abort(comm.handle(), status);
    }
  }
  MPI_Finalize();
  return status;
}
