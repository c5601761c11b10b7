/// Validated parameters -> Scene: names become indices, files are read, contradictions are refused.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "geometry/shape_input.hpp"
#include "input/wording.hpp"
#include "particles/field_names.hpp"
#include "scene/axial_symmetry.hpp"
#include "scene/read_motion.hpp"
#include "scene/read_numerics.hpp"
#include "scene/scene.hpp"

namespace stirsph {
namespace {

using input::Parameters;

/// Index of a name in a list of named things; fails with the known names.
template <class Named>
int index_of(const Parameters& p, const std::string& key, const std::string& name, const std::vector<Named>& things) {
  std::vector<std::string> known;
  for (std::size_t k = 0; k < things.size(); ++k) {
    if (things[k].name == name) return static_cast<int>(k);
    known.push_back(things[k].name);
  }
  p.fail(key, "there is nothing of this name. Known: " + (known.empty() ? "none" : input::joined(known)) + "." +
                  input::did_you_mean(name, known));
}

template <class Named>
void refuse_duplicate(const Parameters& p, const std::string& name, const std::vector<Named>& things) {
  for (const Named& thing : things)
    if (thing.name == name) p.fail("name", "the name is already taken. Give every item of a kind its own name.");
}

std::vector<bool> bodies_of(const Parameters& p, const std::vector<BodyScene>& bodies) {
  if (!p.has("bodies")) return std::vector<bool>(bodies.size(), true);
  if (p.texts("bodies").empty())
    p.fail("bodies", "an empty list chooses nothing. Name bodies, or leave the key out for all.");
  std::vector<bool> chosen(bodies.size(), false);
  for (const std::string& name : p.texts("bodies")) chosen[index_of(p, "bodies", name, bodies)] = true;
  return chosen;
}

void read_time(const Parameters& root, Scene& scene) {
  const Parameters t = root.table("time");
  scene.time.end = t.real("end");
  scene.time.cfl = t.has("cfl") ? t.real("cfl") : safe_courant_number(scene.numerics);
  if (t.has("step")) scene.time.fixed_step = t.real("step");
  scene.time.most_steps = t.integer("most_steps");
  if (!scene.mechanics && scene.time.fixed_step <= 0)
    root.fail("mechanics", "without mechanics there is no Courant number: give time.step, for example \"0.05 s\".");
}

void read_domain(const Parameters& root, Scene& scene) {
  const Parameters d = root.table("domain");
  const SpaceLayout layout = layout_of(scene.space);
  scene.domain.dim = layout.dim;
  scene.domain.axis = layout.axisymmetric();
  const auto component_of = [&](int axis) {
    int component = 0;
    while (component < layout.dim && layout.axes[component] != axis) ++component;
    return component;  // dim: no direction of this space
  };
  const Parameters symmetry = d.table("symmetry");
  for (const int axis : {0, 1, 2}) {
    const std::string name(1, "xyz"[axis]);
    if (!symmetry.has(name)) continue;
    const int component = component_of(axis);
    if (component == layout.dim || (layout.axisymmetric() && component == 0))
      symmetry.fail(name, "no plane across \"" + name + "\" can be a mirror in this space. Allowed: " +
                              (layout.axisymmetric() ? "\"z\"." : "\"x\", \"y\"."));
    scene.domain.symmetric[component] = true;
    scene.domain.plane[component] = symmetry.real(name);
  }
  const std::vector<std::string> periodic = d.texts("periodic");
  for (const std::string& name : periodic) {
    const int component = component_of(name == "x" ? 0 : name == "y" ? 1 : name == "z" ? 2 : -1);
    if (layout.axisymmetric() && component != 1)
      d.fail("periodic", "\"" + name + "\" cannot be periodic in an axisymmetric space. Allowed: \"z\".");
    if (component == layout.dim)
      d.fail("periodic", "\"" + name + "\" is no direction of this space. Allowed: \"x\", \"y\"" +
                             (scene.domain.dim == 3 ? ", \"z\"." : "."));
    if (scene.domain.symmetric[component])
      d.fail("periodic", "\"" + name + "\" is periodic and has a plane of symmetry. Take one of them.");
    scene.domain.periodic[component] = true;
  }
  if (periodic.empty()) return;
  if (!d.has("low") || !d.has("high")) d.fail("periodic", "a periodic domain needs domain.low and domain.high.");
  const Vec3 low = d.vector("low"), high = d.vector("high");
  for (int component = 0; component < layout.dim; ++component) {
    scene.domain.low[component] = low[layout.axes[component]];
    scene.domain.high[component] = high[layout.axes[component]];
  }
  for (int axis = 0; axis < scene.domain.dim; ++axis)
    if (scene.domain.periodic[axis] && scene.domain.length(axis) <= 0)
      d.fail("high", "the periodic box must have a positive length in each periodic direction.");
}

/// What turns about another axis than the normal of a plane of symmetry has no mirror image in it.
void check_planes_of_symmetry(const Scene& scene) {
  if (!scene.domain.any_symmetric()) return;
  const SpaceLayout layout = layout_of(scene.space);
  const auto check = [&](const std::string& place, const Vec3& axis) {
    for (int d = 0; d < layout.dim; ++d)
      if (scene.domain.symmetric[d] && std::abs(std::abs(axis[layout.axes[d]]) - 1) > 1e-9)
        throw InputError(place + ": turns across the plane of symmetry domain.symmetry." + "xyz"[layout.axes[d]] +
                         ". Allowed: rotation about the normal of the plane; otherwise model the whole body");
  };
  for (const BodyScene& body : scene.bodies)
    if (body.rotation) check(scene.path + " body \"" + body.name + "\".rotation", body.rotation->axis);
  for (const RigidScene& rigid : scene.rigids)
    if (rigid.motion.rotation) check(scene.path + " rigid \"" + rigid.name + "\".rotation", rigid.motion.axis);
  for (const GripScene& grip : scene.grips)
    if (grip.rotation) check(scene.path + " grip \"" + grip.name + "\".rotation", grip.rotation->axis);
  if (!scene.numerics.swirl_inertia && !layout.axisymmetric()) check(scene.path + " numerics.inertia", {0, 0, 1});
}

void read_bodies(const Parameters& root, Scene& scene) {
  struct NamedMaterial {
    std::string name;
  };
  std::vector<NamedMaterial> names;
  for (const Parameters& p : root.tables("material")) {
    refuse_duplicate(p, p.text("name"), names);
    names.push_back({p.text("name")});
    scene.materials.push_back(make_material(input::parse_file(p.file("file"), material_schema())));
    scene.materials.back().name = p.text("name");
  }
  for (const Parameters& p : root.tables("body")) {
    BodyScene body;
    body.name = p.text("name");
    refuse_duplicate(p, body.name, scene.bodies);
    body.material = index_of(p, "material", p.text("material"), names);
    body.shape = make_shape(p.table("shape"));
    body.lattice_origin = p.vector("lattice_origin");
    body.fill_margin = p.real("fill_margin");
    body.jitter = p.real("jitter");
    body.temperature = p.expression("temperature");
    body.velocity = vector_expression(p, "velocity");
    body.rotation = rotation_of(p);
    scene.bodies.push_back(std::move(body));
  }
  if (scene.bodies.empty()) root.fail("body", "a scene needs at least one [[body]].");
  for (const Parameters& p : root.tables("rigid"))
    if (p.has("material")) index_of(p, "material", p.text("material"), names);
}

MeshScene read_mesh(const Parameters& heat, const RigidScene& rigid, const SpaceLayout& layout) {
  MeshScene mesh;
  if (!heat.has("mesh"))
    heat.fail("role", "a mesh needs mesh = { near = \"1 mm\", far = \"5 mm\" } or mesh = { file = \"die.msh\" }.");
  const Parameters m = heat.table("mesh");
  if (m.has("file")) {
    if (m.has("near") || m.has("far")) m.fail("file", "give either a file or near and far, not both.");
    if (m.has("cut_low") || m.has("cut_high"))
      m.fail("file", "a mesh file is not cut: leave cut_low and cut_high out.");
    mesh.file = m.file("file");
    mesh.scale = m.real("scale");
    if (m.has("body")) mesh.body = m.text("body");
    return mesh;
  }
  if (m.has("body")) m.fail("body", "names a physical volume of a mesh file: give file, or leave body out.");
  if (!m.has("near"))
    m.fail("near", "give the edge length at the billet, such as \"1 mm\", or the file of a mesh, file = \"die.msh\".");
  mesh.near = m.real("near");
  mesh.far = m.has("far") ? m.real("far") : mesh.near;
  mesh.growth = m.real("growth");
  if (mesh.far < mesh.near) m.fail("far", "must not be shorter than near.");
  if (m.has("cut_low") != m.has("cut_high")) m.fail("cut_low", "cut_low and cut_high go together.");
  if (layout.axisymmetric() && m.has("cut_low"))
    for (const char* corner : {"cut_low", "cut_high"})
      if (m.reals(corner).size() != 3)
        m.fail(corner, "in the axisymmetric space a corner needs three coordinates, of which y is of no meaning.");
  if (m.has("cut_low")) mesh.cut = Bounds{m.vector("cut_low"), m.vector("cut_high")};
  const Bounds bounds = rigid.shape->bounds();
  for (int d = 0; d < layout.dim; ++d)
    if (const int axis = layout.axes[d];
        !mesh.cut && !(std::isfinite(bounds.low[axis]) && std::isfinite(bounds.high[axis])))
      m.fail("near", std::string("the shape is endless along ") + "xyz"[axis] +
                         ": give cut_low and cut_high, the corners of the box to mesh, or a shape with an end.");
  return mesh;
}

std::vector<SurfaceScene> read_surfaces(const Parameters& heat) {
  std::vector<SurfaceScene> surfaces;
  for (const Parameters& s : heat.tables("surface")) {
    SurfaceScene surface;
    if (s.has("region") == s.has("group"))
      s.fail("region", "choose the facets by a region or by a group of the mesh file, one of both.");
    if (s.has("region")) surface.region = make_shape(s.table("region"));
    if (s.has("group")) surface.group = s.text("group");
    if (s.has("temperature") + s.has("conductance") + s.has("flux") != 1)
      s.fail("temperature", "give one of temperature (fixed), conductance (a film) and flux.");
    if (s.has("temperature")) {
      surface.kind = SurfaceScene::Kind::FixedTemperature;
      surface.temperature = s.real("temperature");
    } else if (s.has("conductance")) {
      surface.conductance = s.real("conductance");
      surface.temperature = s.real("ambient_temperature");
    } else {
      surface.kind = SurfaceScene::Kind::Flux;
      surface.flux = s.expression("flux");
    }
    surfaces.push_back(std::move(surface));
  }
  return surfaces;
}

RigidHeatScene read_rigid_heat(const Parameters& heat, const Scene& scene, const RigidScene& rigid) {
  using Role = RigidHeatScene::Role;
  using Interface = RigidHeatScene::Interface;
  RigidHeatScene result;
  const std::string &role = heat.text("role"), &interface = heat.text("interface");
  result.role = role == "fixed"    ? Role::Fixed
                : role == "lumped" ? Role::Lumped
                : role == "mesh"   ? Role::Mesh
                                   : Role::Insulated;
  result.interface = interface == "perfect"  ? Interface::Perfect
                     : interface == "hybrid" ? Interface::Hybrid
                                             : Interface::Film;
  result.temperature = heat.expression("temperature");
  if (result.role != Role::Mesh && !result.temperature.is_constant())
    heat.fail("temperature", "a formula of place needs role = \"mesh\"; give a temperature such as \"600 K\".");
  if (result.temperature.is_constant() && !(result.temperature({0, 0, 0}) > 0))
    heat.fail("temperature", "Allowed: > 0 K.");
  result.conductance =
      result.interface == Interface::Film ? heat.real("conductance") : std::numeric_limits<double>::infinity();
  result.pressure_conductance = heat.real("pressure_conductance");
  result.reference_pressure = heat.real("reference_pressure");
  result.pressure_exponent = heat.real("pressure_exponent");
  result.heat_capacity = heat.real("heat_capacity");
  result.ambient_conductance = heat.real("ambient_conductance");
  result.ambient_temperature = heat.real("ambient_temperature");
  result.bodies = bodies_of(heat, scene.bodies);
  if (result.role == Role::Insulated) return result;
  if (result.role == Role::Lumped && result.heat_capacity <= 0)
    heat.fail("heat_capacity", "a lumped node needs a positive heat capacity, for example \"500 J/K\".");
  if (result.conductance <= 0 && result.pressure_conductance <= 0)
    heat.fail("conductance", "give a positive conductance of the film, or interface = \"perfect\".");
  if (result.pressure_conductance > 0 && !scene.mechanics)
    heat.fail("pressure_conductance", "without mechanics there is no contact pressure: give conductance.");
  if (result.interface == Interface::Hybrid && result.role != Role::Mesh)
    heat.fail("interface", "\"hybrid\" needs role = \"mesh\": the particles are embedded in the mesh.");
  if (result.role == Role::Mesh) {
    if (rigid.material < 0 || !scene.materials[rigid.material].has_thermal)
      heat.fail("role", "a meshed body needs a material with a [thermal] table in its data file.");
    if (result.heat_capacity > 0 || result.ambient_conductance > 0)
      heat.fail(result.heat_capacity > 0 ? "heat_capacity" : "ambient_conductance",
                "belongs to role = \"lumped\". A mesh has the heat capacity of its material and loses heat through "
                "[[rigid.heat.surface]].");
    result.mesh = read_mesh(heat, rigid, layout_of(scene.space));
    result.surfaces = read_surfaces(heat);
  } else if (heat.has("mesh") || !heat.tables("surface").empty()) {
    heat.fail("role", "mesh and surface need role = \"mesh\".");
  }
  return result;
}

void read_heat_sources(const Parameters& root, Scene& scene) {
  for (const Parameters& p : root.tables("heat_source")) {
    HeatSourceScene source;
    source.bodies.assign(scene.bodies.size(), false);
    source.rigids.assign(scene.rigids.size(), false);
    if (p.has("density") == p.has("flux")) p.fail("on", "give one of density (W/m3) and flux (W/m2).");
    source.on_surface = p.has("flux");
    source.value = p.expression(source.on_surface ? "flux" : "density");
    for (const std::string& name : p.texts("on")) {
      std::vector<std::string> known;
      bool found = false;
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        known.push_back(scene.bodies[b].name);
        if (scene.bodies[b].name == name) found = source.bodies[b] = true;
      }
      for (std::size_t r = 0; r < scene.rigids.size() && !source.on_surface; ++r) {
        if (scene.rigids[r].heat.role != RigidHeatScene::Role::Mesh) continue;
        known.push_back(scene.rigids[r].name);
        if (scene.rigids[r].name == name) found = source.rigids[r] = true;
      }
      if (!found)
        p.fail("on", "\"" + name + "\" is no body this source can heat. Known: " + input::joined(known) + "." +
                         input::did_you_mean(name, known));
    }
    scene.heat.sources.push_back(std::move(source));
  }
  if (!scene.heat.sources.empty() && scene.heat.mode != HeatScene::Mode::Conduction)
    root.fail("heat_source", "needs heat.mode = \"conduction\".");
}

void read_rigids(const Parameters& root, Scene& scene) {
  for (const Parameters& p : root.tables("rigid")) {
    RigidScene rigid;
    rigid.name = p.text("name");
    refuse_duplicate(p, rigid.name, scene.rigids);
    rigid.shape = make_shape(p.table("shape"));
    rigid.motion = read_motion(p);
    if (rigid.motion.kind == MotionScene::Kind::Force && !scene.mechanics)
      p.table("motion").fail("type", "without mechanics there is no force: use a velocity or a displacement table.");
    rigid.reference_point = p.vector("reference_point");
    if (p.has("material"))
      for (std::size_t k = 0; k < scene.materials.size(); ++k)
        if (scene.materials[k].name == p.text("material")) rigid.material = static_cast<int>(k);
    if (p.has("heat")) rigid.heat = read_rigid_heat(p.table("heat"), scene, rigid);
    scene.rigids.push_back(std::move(rigid));
  }
}

void read_contacts(const Parameters& root, Scene& scene) {
  for (const Parameters& p : root.tables("contact")) {
    ContactScene contact;
    contact.rigid = index_of(p, "rigid", p.text("rigid"), scene.rigids);
    contact.bodies = bodies_of(p, scene.bodies);
    contact.friction = p.real("friction");
    contact.shear_limit_factor = p.real("shear_limit_factor");
    if (p.has("shear_limit")) contact.shear_limit = p.real("shear_limit");
    contact.penalty_scale = p.real("penalty_scale");
    contact.soft_scale = p.real("soft_scale");
    contact.damping = p.real("damping");
    contact.heat_conversion = p.real("heat_conversion");
    if (p.has("heat_share")) contact.heat_share = p.real("heat_share");
    if (contact.penalty_scale <= 0 && contact.soft_scale <= 0)
      p.fail("penalty_scale", "penalty_scale and soft_scale are both zero: the contact would have no stiffness.");
    scene.contacts.push_back(std::move(contact));
  }
}

/// Nothing can be mixed with itself.
void refuse_one_component(const Parameters& p, const ProbeScene& probe, const Scene& scene) {
  std::set<int> components;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b)
    if (probe.set < 0 || scene.sets[probe.set].bodies[b])
      components.insert(probe.by_body ? static_cast<int>(b) : scene.bodies[b].material);
  if (components.size() < 2)
    p.fail("by", "the particles of this probe are all of one " + p.text("by") +
                     ". Allowed: a set (or scene) of two or more; by = \"body\" tells bodies of one material apart.");
}

void read_sets_and_probes(const Parameters& root, Scene& scene) {
  for (const Parameters& p : root.tables("set")) {
    refuse_duplicate(p, p.text("name"), scene.sets);
    scene.sets.push_back(
        {p.text("name"), bodies_of(p, scene.bodies), p.has("region") ? make_shape(p.table("region")) : nullptr});
  }
  if (scene.sets.size() > 50) root.fail("set", "at most 50 sets are possible.");
  for (const Parameters& p : root.tables("grip")) {
    refuse_duplicate(p, p.text("name"), scene.grips);
    GripScene grip{p.text("name"), index_of(p, "set", p.text("set"), scene.sets), vector_expression(p, "velocity"),
                   rotation_of(p)};
    const bool moved = grip.velocity[0] || grip.velocity[1] || grip.velocity[2];
    if (!moved && !grip.rotation)
      p.fail("name",
             "a grip prescribes nothing: give velocity components, for example velocity = {z = \"0 m/s\"}, or a "
             "rotation.");
    scene.grips.push_back(std::move(grip));
  }
  for (const Parameters& p : root.tables("probe")) {
    ProbeScene probe;
    refuse_duplicate(p, p.text("name"), scene.probes);
    probe.name = p.text("name");
    const std::map<std::string, ProbeScene::Kind> kinds{
        {"point", ProbeScene::Kind::Point},         {"average", ProbeScene::Kind::Average},
        {"deviation", ProbeScene::Kind::Deviation}, {"minimum", ProbeScene::Kind::Minimum},
        {"maximum", ProbeScene::Kind::Maximum},     {"sum", ProbeScene::Kind::Sum},
        {"extent", ProbeScene::Kind::Extent},       {"angular_spread", ProbeScene::Kind::AngularSpread},
        {"mixing", ProbeScene::Kind::Mixing},       {"extruded_length", ProbeScene::Kind::ExtrudedLength}};
    probe.kind = kinds.at(p.text("kind"));
    probe.field = p.text("field");
    probe.component = static_cast<int>(p.integer("component"));
    if (p.has("set")) probe.set = index_of(p, "set", p.text("set"), scene.sets);
    if (probe.kind == ProbeScene::Kind::Point) {
      if (!p.has("position")) p.fail("kind", "a point probe needs position = [x, y, z].");
      probe.position = p.vector("position");
      if (p.has("rigid")) {
        probe.rigid = index_of(p, "rigid", p.text("rigid"), scene.rigids);
        if (scene.rigids[probe.rigid].heat.role == RigidHeatScene::Role::Insulated)
          p.fail("rigid", "this body takes no part in the heat balance and has no temperature: give it a heat.role.");
        if (root.table("heat").text("mode") != "conduction")
          p.fail("rigid", "the temperature of a rigid body needs heat.mode = \"conduction\".");
      }
    }
    if (probe.kind == ProbeScene::Kind::ExtrudedLength) {
      if (!p.has("rigid")) p.fail("kind", "extruded_length needs the name of the rigid tool.");
      probe.rigid = index_of(p, "rigid", p.text("rigid"), scene.rigids);
    }
    if (probe.kind == ProbeScene::Kind::AngularSpread && layout_of(scene.space).axisymmetric())
      p.fail("kind", "an axisymmetric particle is a ring and has no angle. Use another kind or another space.");
    if (probe.kind == ProbeScene::Kind::Mixing) {
      probe.by_body = p.text("by") == "body";
      refuse_one_component(p, probe, scene);
    }
    scene.probes.push_back(std::move(probe));
  }
}

void read_microstructure(const Parameters& root, Scene& scene) {
  if (!root.has("microstructure")) return;
  const Parameters p = root.table("microstructure");
  if (!scene.mechanics)
    root.fail("mechanics", "[microstructure] follows from plastic flow: it needs mechanics = true.");
  for (const BodyScene& body : scene.bodies)
    if (const Material& material = scene.materials[body.material]; !material.grain)
      p.fail("", "the material \"" + material.name + "\" of body \"" + body.name +
                     "\" has no [microstructure] table in its data file. Add one (materials/aa2024_t351.toml shows "
                     "how) or leave [microstructure] out of the scene.");
  scene.microstructure = RecrystallisationRule{p.real("window"), p.real("least_rate"), p.real("least_temperature"),
                                               p.real("renewal_strain")};
}

void read_tracers(const Parameters& root, Scene& scene) {
  for (const Parameters& p : root.tables("tracer")) {
    refuse_duplicate(p, p.text("name"), scene.tracers);
    TracerScene tracer{
        p.text("name"), index_of(p, "set", p.text("set"), scene.sets), p.real("interval"), p.integer("every_nth"), {}};
    if (tracer.name.empty() || tracer.name.find('/') != std::string::npos)
      p.fail("name", "it becomes part of a file name: it must not be empty or contain \"/\".");
    if (p.has("fields")) tracer.fields = p.texts("fields");
    scene.tracers.push_back(std::move(tracer));
  }
}

void read_heat_and_output(const Parameters& root, Scene& scene) {
  const Parameters heat = root.table("heat");
  const std::string& mode = heat.text("mode");
  scene.heat.mode = mode == "adiabatic"    ? HeatScene::Mode::Adiabatic
                    : mode == "conduction" ? HeatScene::Mode::Conduction
                                           : HeatScene::Mode::Off;
  scene.heat.every = static_cast<int>(heat.integer("every"));
  scene.heat.relative_tolerance = heat.real("relative_tolerance");
  scene.heat.nonlinear_iterations = static_cast<int>(heat.integer("nonlinear_iterations"));
  scene.heat.crank_nicolson = heat.text("scheme") == "crank_nicolson";
  if (heat.has("ambient")) {
    if (scene.heat.mode != HeatScene::Mode::Conduction)
      heat.fail("ambient", "a film to the surroundings needs heat.mode = \"conduction\".");
    scene.heat.ambient_conductance = heat.table("ambient").real("conductance");
    scene.heat.ambient_temperature = heat.table("ambient").real("temperature");
  }
  read_heat_sources(root, scene);
  if (scene.heat.mode != HeatScene::Mode::Off)
    for (const BodyScene& body : scene.bodies)
      if (!scene.materials[body.material].has_thermal)
        heat.fail("mode", "the material \"" + scene.materials[body.material].name +
                              "\" has no [thermal] table in its data file.");
  if (!scene.mechanics && scene.heat.mode != HeatScene::Mode::Conduction)
    root.fail("mechanics", "with mechanics = false the scene needs heat.mode = \"conduction\".");

  const Parameters out = root.table("output");
  scene.output.history_interval = out.real("history_interval");
  scene.output.history_steps = out.integer("history_steps");
  scene.output.snapshot_interval = out.real("snapshot_interval");
  scene.output.checkpoint_wall = out.real("checkpoint_wall_interval");
  scene.output.checkpoint_steps = out.integer("checkpoint_steps");
  scene.output.progress_wall = out.real("progress_wall_interval");
  if (out.has("snapshot_times")) scene.output.snapshot_times = out.reals("snapshot_times");
  if (out.has("fields")) scene.output.fields = out.texts("fields");
  scene.output.contact_traction = std::ranges::count(scene.output.fields, field::contact_traction.name) > 0;
  scene.output.initial_position = root.table("tracking").boolean("initial_position") ||
                                  std::ranges::count(scene.output.fields, field::initial_position.name) > 0;

  const Parameters limits = root.table("limits");
  scene.limits.penetration = limits.real("penetration");
  scene.limits.travel = limits.real("travel");
  if (limits.has("speed")) scene.limits.speed = limits.real("speed");
  scene.limits.guards = {limits.real("guard_viscous"), limits.real("guard_inertia"), limits.real("guard_spin_up"),
                         limits.real("guard_rim_travel")};
  scene.limits.guard_steps = limits.integer("guard_steps");
  scene.limits.guards_stop = limits.text("guard_action") == "stop";
}

/// The schedule of density_scale, once that is known.
void complete_schedule(const Parameters& root, Scene& scene) {
  if (scene.inertia_tolerance == 0) return;
  const Parameters n = root.table("numerics");
  const auto refuse = [&](const std::string& why) { n.fail("inertia_tolerance", why); };
  if (!scene.mechanics) refuse("without mechanics there is no inertia to scale. Allowed: 0.");
  if (scene.time.fixed_step > 0)
    refuse("with time.step the step does not grow with density_scale. Leave time.step out, or inertia_tolerance.");
  if (scene.limits.guard_steps == 0)
    refuse("it needs the inertia guards: give limits.guard_steps a value above 0, for example 20.");
  const double reference = scene.numerics.density_scale;
  if (scene.scale_before_flow == 0) scene.scale_before_flow = 10 * reference;
  if (scene.scale_before_flow < reference)
    n.fail("density_scale_before_flow", "it is smaller than density_scale. Allowed: density_scale or more.");
}

Scene make_scene(const Parameters& root, const std::string& path) {
  Scene scene;
  scene.path = path;
  scene.title = root.text("title");
  if (root.text("space") == PlaneStrain::keyword) scene.space = PlaneStrain{};
  if (root.text("space") == AxisymmetricSwirl::keyword) scene.space = AxisymmetricSwirl{};
  scene.mechanics = root.boolean("mechanics");
  scene.effective_input = root.as_toml();
  read_numerics(root, scene);
  read_time(root, scene);
  read_domain(root, scene);
  read_bodies(root, scene);
  read_rigids(root, scene);
  read_contacts(root, scene);
  scene.numerics.surface_layers =
      scene.numerics.gradient_correction == GradientCorrection::Full && !scene.contacts.empty();
  read_sets_and_probes(root, scene);
  read_microstructure(root, scene);
  read_tracers(root, scene);
  scene.body_force = vector_expression(root, "body_force");
  read_heat_and_output(root, scene);
  check_axial_symmetry(scene);
  check_planes_of_symmetry(scene);
  if (scene.target_step > 0) {
    // dt = cfl h / (c/sqrt(s) + |v|): the tool's speed is not known yet, so the wave alone is scaled.
    double fastest = 0;
    for (const BodyScene& body : scene.bodies)
      fastest =
          std::max(fastest, scene.materials[body.material].sound_speed() * std::sqrt(scene.numerics.elastic_scale));
    const double unscaled = scene.time.cfl * scene.numerics.h_over_dx * scene.numerics.spacing / fastest;
    scene.numerics.density_scale = std::max(1.0, std::pow(scene.target_step / unscaled, 2));
  }
  complete_schedule(root, scene);
  return scene;
}

}  // namespace

std::vector<GrainLaw> grain_laws(const Scene& scene) {
  std::vector<GrainLaw> laws;
  for (const Material& material : scene.materials) laws.push_back(material.grain.value_or(GrainLaw{}));
  return laws;
}

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides) {
  return make_scene(input::parse_file(path, scene_schema(), overrides), path);
}

Scene read_scene_text(const std::string& text, const std::string& folder, const std::vector<std::string>& overrides) {
  return make_scene(input::parse_text(text, "scene", scene_schema(), folder, overrides), "scene");
}

}  // namespace stirsph
