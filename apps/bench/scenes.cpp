#include "bench/scenes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "geometry/combinations.hpp"
#include "geometry/primitives.hpp"

namespace stirsph::bench {
namespace {

constexpr double tool_rate = 1500 * 2 * std::numbers::pi / 60;  // rad/s, 1500 rpm
constexpr double tool_step = 1.6e-5;                            // s, the step under the turning tool
constexpr double billet_radius = 12.5e-3, tool_radius = 11e-3;  // m, tube extrusion of the paper
constexpr double billet_height = 34.8e-3;                       // m
constexpr double billet_spacing = 0.4e-3;                       // m, gives the paper's count:
constexpr double billet_particles = 263088;
constexpr double extrusion_particles = 246472;  // of the same spacing: clear of the tool, the die and the plate
constexpr double stirred_depth = 2e-3;          // m over which the turning decays by e below the tool

/// AA2024 with the law of inputs/materials/aa2024_t351.toml; the program must not depend on where the sources are.
Material aluminium() {
  return make_material(input::parse_text(R"(
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
[thermal]
conductivity = [188.0]
specific_heat = [766.88, 0.3, -2e-4]
)",
                                         "bench material", material_schema()));
}

/// The copper of the Taylor bar in the comparison of codes.
Material copper() {
  return make_material(input::parse_text(R"(
name = "copper"
density = "8930 kg/m3"
[elastic]
youngs_modulus = "117 GPa"
poisson_ratio = 0.35
[flow_stress]
model = "linear_hardening"
yield_stress = "400 MPa"
hardening_modulus = "100 MPa"
)",
                                         "bench material", material_schema()));
}

Scene empty_scene(const std::string& name, double spacing, Material material) {
  Scene scene;
  scene.title = name;
  scene.path = "stirsph_bench " + name;
  scene.materials.push_back(std::move(material));
  scene.numerics.spacing = spacing;
  scene.domain.dim = 3;
  scene.time.end = 1;  // far beyond what is timed
  return scene;
}

/// The spacing that fills the same solid with about `particles` instead of `own` of them; 0 = own.
double spacing_for(double own_spacing, double own, std::int64_t particles) {
  return particles > 0 ? own_spacing * std::cbrt(own / static_cast<double>(particles)) : own_spacing;
}

/// A box with sides in these proportions, compressed at 1e4/s, so that it keeps yielding, and spun at 3000 rad/s, so
/// that absolute motion would age the lists.
Scene block(const SceneChoice& choice, std::int64_t own, const Vec3& proportions) {
  Scene scene = empty_scene(choice.name, billet_spacing, aluminium());
  const double particles = static_cast<double>(choice.particles > 0 ? choice.particles : own);
  const double unit = std::round(std::cbrt(particles / (proportions.x * proportions.y * proportions.z)));
  const Vec3 sides = billet_spacing * std::max(unit, 1.0) * proportions;
  BodyScene body;
  body.name = "block";
  body.shape = std::make_shared<Box>(Vec3{}, sides);
  body.temperature = input::Expression(500.0);
  body.velocity[2] = input::Expression(fmt::format("-1e4*(z-{:.17g})", 0.5 * sides.z), {"x", "y", "z"});
  body.rotation = RotationScene{0.5 * sides, {0, 0, 1}, input::Expression(3000.0)};
  scene.bodies.push_back(body);
  return scene;
}

/// Numerics of inputs/demo_tube and inputs/paper_scale, with the density scale that makes dt = 1.6e-5 s the step of
/// the default Courant number beside the rim's speed.
void set_process_numerics(Scene& scene) {
  MechanicsSettings& numerics = scene.numerics;
  numerics.elastic_scale = 0.05;
  numerics.viscosity_alpha = 0.5;
  numerics.density_diffusion = 0.1;
  numerics.artificial_stress = 0.3;
  scene.time.fixed_step = tool_step;
  const double h = numerics.h_over_dx * numerics.spacing;
  const double wave = scene.time.cfl * h / tool_step - tool_rate * billet_radius;  // m/s with scaled inertia
  const double unscaled = scene.materials[0].sound_speed() * std::sqrt(numerics.elastic_scale);
  numerics.density_scale = std::pow(unscaled / wave, 2);
}

/// Velocity of a body that turns about z at a rate [rad/s] that is a formula of the place.
void set_turning(BodyScene& body, const std::string& rate) {
  body.velocity[0] = input::Expression("-(" + rate + ")*y", {"x", "y", "z"});
  body.velocity[1] = input::Expression("(" + rate + ")*x", {"x", "y", "z"});
}

/// Two layers turn with the tool; below, the turning decays, so that neighbours pass each other as in a stirred zone.
/// Nothing holds the metal otherwise: a few hundred steps are far less than a turn.
Scene stirred(const SceneChoice& choice) {
  const double spacing = spacing_for(billet_spacing, billet_particles, choice.particles);
  Scene scene = empty_scene(choice.name, spacing, aluminium());
  set_process_numerics(scene);
  BodyScene body;
  body.name = "billet";
  body.shape = make_cylinder({}, {0, 0, 1}, billet_radius, billet_height);
  body.temperature = input::Expression(500.0);
  const double top = billet_height - 2 * spacing;
  set_turning(body, fmt::format("{:.17g}*(z>{:.17g} ? 1 : exp((z-{:.17g})/{}))", tool_rate, top, top, stirred_depth));
  scene.bodies.push_back(body);
  scene.sets.push_back({"top", {true}, std::make_shared<Box>(Vec3{-1, -1, top}, Vec3{1, 1, billet_height + spacing})});
  GripScene grip;
  grip.name = "tool";
  grip.velocity[2] = input::Expression(0.0);
  grip.rotation = RotationScene{{}, {0, 0, 1}, input::Expression(tool_rate)};
  scene.grips.push_back(grip);
  return scene;
}

RigidScene rigid_body(const std::string& name, ShapePointer shape) {
  RigidScene rigid;
  rigid.name = name;
  rigid.shape = std::move(shape);
  return rigid;
}

/// The billet of 34.8 mm after the tool has gone down 8.8 mm: what it displaced stands in the gap as a tube. Metal near
/// the tool already turns with it, as it does in mid-process.
Scene extrusion(const SceneChoice& choice) {
  Scene scene =
      empty_scene(choice.name, spacing_for(billet_spacing, extrusion_particles, choice.particles), aluminium());
  set_process_numerics(scene);
  scene.numerics.gradient_correction = GradientCorrection::Velocity;
  scene.heat.mode = HeatScene::Mode::Adiabatic;
  const double face = 26e-3;  // m, height of the tool's face
  const double gap = std::pow(billet_radius, 2) - std::pow(tool_radius, 2);
  const double tube = (billet_height - face) * std::pow(billet_radius, 2) / gap;  // m, same volume
  const Vec3 up{0, 0, 1};
  BodyScene body;
  body.name = "billet";
  body.shape = std::make_shared<Union>(std::vector<ShapePointer>{
      make_cylinder({}, up, billet_radius, face), make_annulus({}, up, tool_radius, billet_radius, face + tube)});
  body.fill_margin = 0.45;
  body.temperature = input::Expression(790.0);
  set_turning(body, fmt::format("{0:.17g}*(z<{1} ? exp((z-{1})/{2}) : ({3}-sqrt(x*x+y*y))/({3}-{4}))", tool_rate, face,
                                stirred_depth, billet_radius, tool_radius));
  scene.bodies.push_back(body);

  RigidScene tool = rigid_body("tool", make_cylinder({0, 0, face}, up, tool_radius, 60e-3));
  tool.reference_point = {0, 0, face};
  tool.motion.kind = MotionScene::Kind::Force;
  tool.motion.force.preload = tool.motion.force.target = 12e3;
  tool.motion.force.approach_time = 1e-3;
  tool.motion.rotation = input::Expression(tool_rate);
  scene.rigids = {tool, rigid_body("die", make_annulus({}, up, billet_radius, 40e-3, 76e-3)),
                  rigid_body("plate", make_cylinder({0, 0, -20e-3}, up, 40e-3, 20e-3))};
  for (int rigid = 0; rigid < 3; ++rigid) {
    ContactScene contact;
    contact.rigid = rigid;
    contact.bodies = {true};
    contact.friction = 0.39;
    contact.damping = 0.2;
    contact.heat_share = 0.7;
    scene.contacts.push_back(contact);
  }
  scene.output.history_interval = 2e-3;
  scene.output.snapshot_interval = 50e-3;
  return scene;
}

Scene taylor(const SceneChoice& choice) {
  const double own_spacing = 0.25e-3, own = 66170;
  const double spacing = spacing_for(own_spacing, own, choice.particles);
  Scene scene = empty_scene(choice.name, spacing, copper());
  const double held = 2 * spacing;
  BodyScene body;
  body.name = "bar";
  body.shape = make_cylinder({}, {0, 0, 1}, 3.2e-3, 32.4e-3);
  // A particle on the axis and all lattice points inside, which gives the count of the comparison: 130 layers of 509.
  body.lattice_origin = {0.5 * spacing, 0.5 * spacing, 0};
  body.fill_margin = 0;
  body.temperature = input::Expression(293.15);
  body.velocity[2] = input::Expression(-200.0);
  scene.bodies.push_back(body);
  scene.sets.push_back({"bottom", {true}, std::make_shared<Box>(Vec3{-1, -1, -1}, Vec3{1, 1, held})});
  GripScene grip;
  grip.name = "wall";
  grip.velocity = {input::Expression(0.0), input::Expression(0.0), input::Expression(0.0)};
  scene.grips.push_back(grip);
  return scene;
}

}  // namespace

const std::vector<std::string>& scene_names() {
  static const std::vector<std::string> names{"block", "stirred", "extrusion", "small", "taylor"};
  return names;
}

Scene bench_scene(const SceneChoice& choice) {
  Scene scene = choice.name == "stirred"     ? stirred(choice)
                : choice.name == "extrusion" ? extrusion(choice)
                : choice.name == "taylor"    ? taylor(choice)
                : choice.name == "small"     ? block(choice, 3000, {2, 3, 4})
                                             : block(choice, 263088, {1, 1, 1});
  if (choice.gradient_correction) scene.numerics.gradient_correction = *choice.gradient_correction;
  return scene;
}

}  // namespace stirsph::bench
