/// Every key of a scene file: unit, range, default, meaning. The parameter manual is printed from this.
#include "geometry/shape_input.hpp"
#include "scene/scene.hpp"

namespace stirsph {
namespace {

using input::Schema;

const std::vector<std::string> space_variables{"x", "y", "z"};
const std::vector<std::string> space_time_variables{"t", "x", "y", "z"};

/// A table with keys x, y, z, each a formula or quantity; a component not given is left alone.
void declare_vector_expression(Schema& parent, const std::string& key, const std::string& unit,
                               const std::vector<std::string>& variables, const std::string& doc) {
  Schema& table = parent.table(key, doc, true);
  for (const char* component : {"x", "y", "z"})
    table.expression(component, variables, std::string("component ") + component).unit(unit).optional();
}

void declare_rotation(Schema& parent, const std::string& key, const std::string& doc) {
  Schema& table = parent.table(key, doc, true);
  table.reals("centre", "a point on the axis").unit("m").count(2, 3).by_default("[\"0 m\", \"0 m\", \"0 m\"]");
  table.reals("axis", "direction of the axis, right-hand rule").count(3, 3).by_default("[0.0, 0.0, 1.0]");
  table.expression("rate", {"t"}, "angular velocity, a quantity such as \"1500 rpm\" or a formula of t in rad/s")
      .unit("rad/s");
}

const std::map<std::string, Schema>& motion_schemas() {
  static const std::map<std::string, Schema> schemas = [] {
    std::map<std::string, Schema> m;
    m["fixed"] = Schema("at rest (it may still rotate)");
    Schema velocity("prescribed velocity");
    for (const char* component : {"x", "y", "z"})
      velocity.expression(component, {"t"}, "velocity component").unit("m/s").by_default("0 m/s");
    m["velocity"] = velocity;
    Schema displacement("a table of displacement over time, for example measured on a machine");
    displacement
        .text(
            "table",
            "CSV file with a header such as: time [s], displacement [mm]; its first and last value are held before and "
            "after its times")
        .file();
    displacement.reals("direction", "unit vector of positive displacement").count(3, 3).by_default("[0.0, 0.0, -1.0]");
    m["displacement"] = displacement;
    Schema force(
        "force programme: contact search, preload, dwell, ramp, hold; the velocity follows from a PI controller. Its "
        "times count from the first contact and stand still while contact is lost");
    force.reals("direction", "unit vector in which the force is applied").count(3, 3).by_default("[0.0, 0.0, -1.0]");
    force.real("preload", "force held during the dwell").unit("N").positive();
    force.real("approach_time", "time over which the force is applied after contact was found")
        .unit("s")
        .positive()
        .by_default("0.2 s");
    force.real("dwell", "time at the preload").unit("s").not_negative().by_default("0 s");
    force.real("ramp_rate", "increase of the force after the dwell").unit("N/s").positive().by_default("500 N/s");
    force.real("target", "force held to the end").unit("N").positive();
    force
        .real("approach_speed",
              "speed of the contact search; when missing, such that the impact force rho c A v of the (scaled) billet "
              "stays below a fifth of the preload, at most velocity_limit")
        .unit("m/s")
        .positive()
        .optional();
    force.real("velocity_limit", "the tool never moves faster into the billet")
        .unit("m/s")
        .positive()
        .by_default("1 mm/s");
    force.real("withdrawal_limit", "nor faster out of it; velocity_limit when missing")
        .unit("m/s")
        .positive()
        .optional();
    force.real("stroke_limit", "travel along direction at which the tool stops and stays; none when missing")
        .unit("m")
        .positive()
        .optional();
    force.real("stiffness", "axial stiffness of the billet for the controller gains; estimated when missing")
        .unit("N/m")
        .positive()
        .optional();
    force.real("bandwidth", "controller frequency over the billet's first axial frequency")
        .range(1e-3, 10)
        .by_default(0.15);
    m["force"] = force;
    return m;
  }();
  return schemas;
}

void declare_numerics(Schema& s) {
  Schema& n = s.table("numerics", "discretisation and stabilisation");
  n.real("spacing", "initial particle spacing dx").unit("m").positive();
  n.choice("kernel", {"cubic", "wendland_c2", "wendland_c4", "quintic"}, "smoothing kernel").by_default("cubic");
  n.real("h_over_dx", "smoothing length over spacing").range(0.8, 3).by_default(1.3);
  n.boolean("variable_h", "smoothing length follows density, h = h0 (rho0/rho)^(1/d)").by_default("false");
  n.choice("gradient_correction", {"none", "velocity", "full"},
           "renormalised kernel gradient: of the velocity gradient only, or also (adjoint) of the momentum sum, which "
           "gives "
           "free surfaces their right stiffness")
      .by_default("none");
  n.real(
       "largest_correction",
       "largest norm of the correction's matrix; without it 7.1 with \"full\" (the corner of a box) and 15 with "
       "\"velocity\". Beyond, chips and acute corners, the full correction is scaled down, the other left out. Larger "
       "values need smaller steps: 50 a cfl of 0.34")
      .range(1, 1000)
      .optional();
  n.real("viscosity_alpha", "linear artificial viscosity").not_negative().by_default(1.0);
  n.real("viscosity_beta", "quadratic artificial viscosity").not_negative().by_default(0.0);
  n.boolean("viscosity_reconstruction",
            "the viscosity sees only what the strain rates of both particles leave of a pair's approach: a smooth flow "
            "is then free of it, noise and shocks are not")
      .by_default("false");
  n.real("density_diffusion",
         "delta of the density diffusion (delta-SPH), which smooths pressure from particle to particle")
      .range(0, 1)
      .by_default(0.0);
  n.boolean(
       "density_reconstruction",
       "the density diffusion sees only what the gradients of both particles leave of a jump: a pressure that varies "
       "smoothly stays, and no metal is pumped out of loaded regions (src/mechanics/README.md)")
      .by_default("false");
  n.real("artificial_stress", "epsilon of the artificial stress against the tensile instability")
      .range(0, 1)
      .by_default(0.0);
  n.real("hourglass_control",
         "zeta of the stiffness against motion of single particles that the velocity gradient does not see; cures the "
         "tensile "
         "instability. Needs a gradient correction")
      .range(0, 10)
      .by_default(0.0);
  n.real("density_scale", "inertial over physical mass (mass scaling)").range(1, 1e12).by_default(1.0);
  n.real("density_scale_for_step", "choose density_scale so that this time step is stable at the given cfl")
      .unit("s")
      .positive()
      .optional();
  n.real("inertia_tolerance",
         "share of the limits of the inertia guards (limits.guard_*) up to which density_scale may be raised while no "
         "metal flows; lowered to density_scale at onset. 0: density_scale is constant")
      .range(0, 1)
      .by_default(0.0);
  n.real("density_scale_before_flow",
         "largest density_scale while no metal flows, with inertia_tolerance; ten times density_scale when missing")
      .range(1, 1e12)
      .optional();
  n.choice(
       "inertia", {"full", "no_swirl"},
       "no_swirl: the scaled mass of swirl around the z axis has no centrifugal and Coriolis forces; particles move "
       "along their circles")
      .by_default("full");
  n.real("swirl_density_ratio", "density_scale of motion around the z axis over that of other motion")
      .range(1e-6, 1)
      .by_default(1.0);
  n.choice("viscosity_velocity", {"full", "no_swirl"},
           "which velocity the artificial viscosity sees; no_swirl: without the swirl around the z axis (always so in "
           "the axisymmetric space)")
      .by_default("full");
  n.real("elastic_scale", "factor on the elastic moduli").range(1e-6, 1).by_default(1.0);
  n.real("skin", "margin of the pair list over the kernel support, in spacings").range(0.01, 3).by_default(0.3);
  n.real("repartition_imbalance",
         "most loaded rank over mean that triggers a new partition, if the last one could do better")
      .range(1.01, 10)
      .by_default(1.15);
}

void declare_time(Schema& s) {
  Schema& t = s.table("time", "time integration");
  t.real("end", "process time at which the run ends").unit("s").positive();
  t.real("cfl",
         "Courant number: dt = cfl min(h)/(c + |v|); without it 0.8, with gradient_correction \"velocity\" 0.6 and "
         "\"full\" 0.5, which "
         "are "
         "safe for every kernel (src/mechanics/README.md)")
      .range(1e-4, 3)
      .optional();
  t.real("step", "fixed time step; without it the step follows the Courant number").unit("s").positive().optional();
  t.integer("most_steps", "stop after so many steps (0: no limit)").not_negative().by_default("0");
}

void declare_bodies(Schema& s) {
  Schema& material = s.tables("material", "a material of the scene");
  material.text("name", "name used in this file");
  material.text("file", "material data file, relative to this file").file();

  Schema& body = s.tables("body", "a deformable body, filled with particles");
  body.text("name", "name used in this file and in outputs");
  body.text("material", "name of a material");
  body.variant("shape", "type", shape_schemas, "region that is filled with particles");
  body.reals("lattice_origin", "particles sit at half-integer multiples of the spacing from here")
      .unit("m")
      .count(2, 3)
      .by_default("[\"0 m\", \"0 m\", \"0 m\"]");
  body.real("fill_margin", "a site is filled when it is so deep inside the shape, in spacings")
      .range(-0.5, 0.5)
      .by_default(0.25);
  body.real("jitter", "random offset of the sites, in spacings (for tests)").range(0, 0.45).by_default(0.0);
  body.expression("temperature", space_variables, "initial temperature, a quantity or a formula of x, y, z in K")
      .unit("K")
      .by_default("293.15 K");
  declare_vector_expression(body, "velocity", "m/s", space_variables,
                            "initial velocity, quantities or formulas of x, y, z");
  declare_rotation(body, "rotation", "initial rigid rotation, added to the velocity");
}

/// The mesh of a rigid body and the conditions on its outer surfaces.
void declare_mesh(Schema& heat) {
  Schema& mesh = heat.table(
      "mesh",
      "linear tetrahedra of the body (triangles in plane strain; triangles of its section with the half-plane "
      "y = 0, x >= 0 in the axisymmetric space), for role = \"mesh\"",
      true);
  mesh.real("near", "edge length at the deformable bodies").unit("m").positive().optional();
  mesh.real("far", "largest edge length").unit("m").positive().optional();
  mesh.real("growth", "how much longer edges get per distance").range(0.01, 2).by_default(0.3);
  mesh.text("file", "Gmsh .msh file instead of meshing the shape").file().optional();
  mesh.real("scale", "metres per unit of length of the file").positive().by_default(1.0);
  mesh.text("body", "name of the physical volume of the file; all elements when missing").optional();
  mesh.reals("cut_low", "lower corner of the box that cuts an endless shape").unit("m").count(2, 3).optional();
  mesh.reals("cut_high", "its upper corner; its x is the radius in the axisymmetric space")
      .unit("m")
      .count(2, 3)
      .optional();
  Schema& surface = heat.tables("surface", "a condition on outer facets of the mesh; the others are insulated");
  surface.variant("region", "type", shape_schemas, "facets whose centroid lies inside this shape (at the start)")
      .optional();
  surface.text("group", "facets of this physical surface of the mesh file").optional();
  surface.real("temperature", "fixed temperature").unit("K").positive().optional();
  surface.real("conductance", "of a film to the surroundings").unit("W/m2/K").positive().optional();
  surface.real("ambient_temperature", "of the surroundings").unit("K").positive().by_default("293.15 K");
  surface.expression("flux", space_time_variables, "heat into the body per area, formula of t, x, y, z in its frame")
      .unit("W/m2")
      .optional();
}

void declare_retreat(Schema& rigid) {
  Schema& retreat = rigid.table("retreat", "lifts the body off at the end, whatever moved it before", true);
  retreat.real("at", "process time at which it begins; give at or dwell").unit("s").not_negative().optional();
  retreat
      .real("dwell",
            "time from the end of the displacement table, or from the target force or the stroke limit, to the retreat")
      .unit("s")
      .not_negative()
      .optional();
  retreat.real("speed", "speed of the retreat").unit("m/s").positive();
  retreat.real("distance", "length of the way; the body then rests").unit("m").positive();
  retreat.reals("direction", "unit vector of the retreat; when missing, opposite to motion.direction, else [0, 0, 1]")
      .count(3, 3)
      .optional();
  retreat.boolean("stop_rotation", "the rotation stops as the retreat begins").by_default("false");
}

void declare_rigids(Schema& s) {
  Schema& rigid = s.tables("rigid", "a rigid tool, die or plate: an exact surface, no particles");
  rigid.text("name", "name used in this file and in outputs");
  rigid.variant("shape", "type", shape_schemas, "the solid region of the body at the start");
  rigid.variant("motion", "type", motion_schemas, "how it moves; at rest when missing").optional();
  declare_rotation(rigid, "rotation", "rotation of the body about an axis that travels with it");
  rigid
      .text(
          "rotation_table",
          "CSV file with a header such as: time [s], rate [rpm]; replaces rotation.rate. Its first and last value are "
          "held before and after its times")
      .file()
      .optional();
  declare_retreat(rigid);
  rigid.text("material", "name of a material, for the split of the friction heat").optional();
  rigid.reals("reference_point", "point of the body from which extruded length is measured")
      .unit("m")
      .count(2, 3)
      .by_default("[\"0 m\", \"0 m\", \"0 m\"]");
  Schema& heat = rigid.table("heat", "part of the body in the heat balance", true);
  heat.choice(
          "role", {"insulated", "fixed", "lumped", "mesh"},
          "no heat exchange, a given temperature, one node with a heat capacity, or a mesh in which heat is conducted")
      .by_default("insulated");
  heat.expression("temperature", space_variables, "its (initial) temperature; a formula of x, y, z only for a mesh")
      .unit("K")
      .by_default("293.15 K");
  heat.choice("interface", {"film", "perfect", "hybrid"},
              "to the particles: a film, no resistance, or particles embedded in the mesh as one thermal medium")
      .by_default("film");
  heat.real("conductance", "of the film").unit("W/m2/K").not_negative().by_default("0 W/m2/K");
  heat.real("pressure_conductance", "added to the film: this times (p/reference_pressure)^pressure_exponent")
      .unit("W/m2/K")
      .not_negative()
      .by_default("0 W/m2/K");
  heat.real("reference_pressure", "see pressure_conductance").unit("Pa").positive().by_default("1 MPa");
  heat.real("pressure_exponent", "see pressure_conductance").range(0.1, 3).by_default(0.95);
  heat.texts("bodies", "names of the deformable bodies that exchange heat with it; all when missing").optional();
  heat.real("heat_capacity", "of the lumped node").unit("J/K").not_negative().by_default("0 J/K");
  heat.real("ambient_conductance", "from the lumped node to the surroundings")
      .unit("W/K")
      .not_negative()
      .by_default("0 W/K");
  heat.real("ambient_temperature", "of the surroundings of the lumped node")
      .unit("K")
      .positive()
      .by_default("293.15 K");
  declare_mesh(heat);
}

void declare_contacts(Schema& s) {
  Schema& contact = s.tables("contact", "contact of deformable bodies with one rigid body");
  contact.text("rigid", "name of the rigid body");
  contact.texts("bodies", "names of the deformable bodies; all when missing").optional();
  contact.real("friction", "Coulomb coefficient mu").not_negative().by_default(0.0);
  contact
      .real("shear_limit_factor",
            "factor on the limit sigma_y/sqrt(3) of the friction stress, at the rate of a layer that slips")
      .positive()
      .by_default(1.0);
  contact.real("shear_limit", "given limit of the friction stress instead of sigma_y/sqrt(3)")
      .unit("Pa")
      .not_negative()
      .optional();
  contact.real("penalty_scale", "standard penalty stiffness over Young's modulus times dx")
      .not_negative()
      .by_default(0.1);
  contact.real("soft_scale", "S_f of the soft constraint, stiffness >= S_f m/dt^2").range(0, 2).by_default(0.1);
  contact.real("damping", "of the normal spring, fraction of critical").range(0, 1).by_default(0.0);
  contact.real("heat_conversion", "share of friction work that becomes heat").range(0, 1).by_default(0.9);
  contact.real("heat_share", "share of friction heat that stays in the particles; from the effusivities when missing")
      .range(0, 1)
      .optional();
}

void declare_sets_and_probes(Schema& s) {
  Schema& set = s.tables("set", "a set of particles, chosen at the start");
  set.text("name", "name used by grips and probes");
  set.texts("bodies", "names of the deformable bodies; all when missing").optional();
  set.variant("region", "type", shape_schemas, "only particles inside this shape; all when missing").optional();

  Schema& grip = s.tables("grip", "prescribed motion of a set, with its reaction force");
  grip.text("name", "name in the history");
  grip.text("set", "name of the set");
  declare_vector_expression(
      grip, "velocity", "m/s", space_time_variables,
      "prescribed velocity components, quantities or formulas of t and the initial x, y, z; others are free");
  declare_rotation(grip, "rotation", "rigid rotation about an axis; prescribes the components across the axis");

  Schema& probe = s.tables("probe", "a value recorded in the history");
  probe.text("name", "column name");
  probe.choice(
      "kind",
      {"point", "average", "deviation", "minimum", "maximum", "sum", "extent", "angular_spread", "mixing",
       "extruded_length"},
      "point: kernel interpolation at a position; average .. sum: over a set, deviation the standard deviation; "
      "extent: "
      "largest value less the smallest; angular_spread: of a set about the z axis, 0 at one angle, 1 evenly around; "
      "mixing: Lacey's index of a set, 0 separated, 1 mixed at random (src/driver/README.md); extruded_length: length "
      "of the unbroken material beyond a rigid body's reference point");
  probe
      .text(
          "field",
          "name of a particle field; also von_mises, pressure, hardness, radius (distance from the z axis), height (z)")
      .by_default("temperature");
  probe.integer("component", "component of a vector or tensor field (x y z; xx yy zz xy xz yz)")
      .range(0, 5)
      .by_default("0");
  probe.text("set", "name of a set; all particles when missing").optional();
  probe.choice("by", {"material", "body"}, "of mixing: what is mixed").by_default("material");
  probe.reals("position", "of a point probe").unit("m").count(2, 3).optional();
  probe
      .text("rigid",
            "rigid body of extruded_length; of a point: its temperature there, the position being where it was at the "
            "start")
      .optional();
}

void declare_tracking(Schema& s) {
  Schema& rule =
      s.table("microstructure",
              "grain size and hardness as fields; the materials need [microstructure] in their data files", true);
  rule.real("window", "process time over which the plastic strain rate is averaged")
      .unit("s")
      .positive()
      .by_default("50 ms");
  rule.real("least_rate", "average plastic strain rate from which on a particle recrystallises")
      .unit("1/s")
      .positive()
      .by_default("0.1 1/s");
  rule.real("least_temperature", "temperature from which on a particle recrystallises")
      .unit("K")
      .positive()
      .by_default("500 K");
  rule.real("renewal_strain", "plastic strain over which new grains replace the old ones; 0: at once")
      .not_negative()
      .by_default(0.0);

  Schema& tracer = s.tables("tracer", "paths of particles, written to tracer_NAME.csv");
  tracer.text("name", "name of the file");
  tracer.text("set", "name of the set whose particles are followed");
  tracer.real("interval", "process time between records").unit("s").positive();
  tracer.integer("every_nth", "follow only every n-th particle of the set, by id").range(1, 1e9).by_default("1");
  tracer
      .texts("fields",
             "one-component fields recorded besides id and position; material, temperature and "
             "equivalent_plastic_strain when missing")
      .optional();

  Schema& tracking = s.table("tracking", "where the material came from");
  tracking.boolean("initial_position", "the position at the start is kept and written to snapshots")
      .by_default("false");
}

void declare_heat_and_output(Schema& s) {
  Schema& heat = s.table("heat", "temperature");
  heat.choice("mode", {"off", "adiabatic", "conduction"},
              "constant temperature, heating without conduction, or implicit conduction")
      .by_default("off");
  heat.integer("every", "mechanical steps per heat step").range(1, 1000000).by_default("10");
  heat.real("relative_tolerance", "of the linear solve").range(1e-14, 0.1).by_default(1e-6);
  heat.integer("nonlinear_iterations", "solves per heat step with k(T) and c_p(T) updated")
      .range(1, 100)
      .by_default("1");
  heat.choice("scheme", {"backward_euler", "crank_nicolson"}, "time scheme of the conduction")
      .by_default("backward_euler");
  Schema& ambient = heat.table("ambient", "film between the free surface of the particles and the surroundings", true);
  ambient.real("conductance", "of the film").unit("W/m2/K").positive();
  ambient.real("temperature", "of the surroundings").unit("K").positive().by_default("293.15 K");
  Schema& source = s.tables("heat_source", "heat put into bodies");
  source.texts("on", "names of deformable bodies and, for a density, of rigid bodies with meshes");
  source.expression("density", space_time_variables, "power per volume, formula of t, x, y, z").unit("W/m3").optional();
  source.expression("flux", space_time_variables, "power per free surface of deformable bodies")
      .unit("W/m2")
      .optional();

  Schema& output = s.table("output", "what is written, and when");
  output.real("history_interval", "process time between rows of history.csv; 0: see history_steps")
      .unit("s")
      .not_negative()
      .by_default("0 s");
  output.integer("history_steps", "steps between rows of history.csv (0: by history_interval)")
      .not_negative()
      .by_default("0");
  output.real("snapshot_interval", "process time between snapshots; 0: first and last only")
      .unit("s")
      .not_negative()
      .by_default("0 s");
  output
      .reals("snapshot_times",
             "process times of further snapshots, each at the step nearest to it; those after the end never come")
      .unit("s")
      .not_negative()
      .optional();
  output
      .texts("fields",
             "fields in snapshots; the usual ones when missing. contact_traction, the force of rigid bodies over the "
             "area, is recorded only where it is named here")
      .optional();
  output.real("checkpoint_wall_interval", "wall time between checkpoints; 0: off")
      .unit("s")
      .not_negative()
      .by_default("600 s");
  output.integer("checkpoint_steps", "steps between checkpoints; 0: off").not_negative().by_default("0");
  output.real("progress_wall_interval", "wall time between progress lines").unit("s").not_negative().by_default("5 s");

  Schema& limits = s.table("limits", "where the run gives up rather than going on with nonsense");
  limits.real("penetration", "deepest contact penetration in spacings").positive().by_default(1.0);
  limits.real("speed", "fastest particle; ten wave speeds plus ten tool speeds when missing")
      .unit("m/s")
      .positive()
      .optional();
  limits
      .real("travel",
            "way along its circle that a particle may go in a step, in spacings; shortens the steps of three "
            "dimensions with inertia = \"no_swirl\"")
      .range(1e-3, 10)
      .by_default(0.25);
  // Defaults: feasibility runs of the process (rules of thumb that kept force and torque within some percent); the time
  // to spin up is one turn because a swirl that lags by more is not the tool's.
  limits
      .real("guard_viscous",
            "stress of the artificial viscosity, alpha rho s c h times the strain rate it sees, over the flow stress, "
            "mean over yielding metal")
      .positive()
      .by_default(0.2);
  limits.real("guard_inertia", "rho s v^2 over the flow stress, mean over yielding metal; v without a no_swirl swirl")
      .positive()
      .by_default(0.05);
  limits
      .real(
          "guard_spin_up",
          "time in which the yield stress in shear brings a layer of one spacing to the speed of the rim, in turns of "
          "the tool")
      .positive()
      .by_default(1.0);
  limits
      .real("guard_rim_travel",
            "way of the fastest metal, at most of the tool's rim, in a step, in spacings (three dimensions)")
      .positive()
      .by_default(0.25);
  limits
      .choice(
          "guard_action", {"warn", "stop"},
          "when the average of a guard over 20 looks exceeds its limit: one warning, or the end of the run with the "
          "state saved")
      .by_default("warn");
  limits.integer("guard_steps", "steps between looks at the guards; 0: off").range(0, 1000000).by_default("20");
}

}  // namespace

const input::Schema& scene_schema() {
  static const Schema schema = [] {
    Schema s("a StirSPH scene");
    s.text("title", "one line for logs and plots").by_default("untitled");
    s.choice("space", {"cartesian3", "plane_strain", "axisymmetric"},
             "the space the scene lives in; axisymmetric: about z, with rotation, a scene of round bodies on that axis")
        .by_default("cartesian3");
    s.boolean("mechanics", "false: only heat is computed, particles stay where they are").by_default("true");
    declare_numerics(s);
    declare_time(s);
    Schema& domain = s.table("domain", "periodic directions and planes of symmetry");
    domain.texts("periodic", "directions that are periodic: \"x\", \"y\", \"z\"").by_default("[]");
    domain.reals("low", "lower corner of the periodic box").unit("m").count(2, 3).optional();
    domain.reals("high", "upper corner of the periodic box").unit("m").count(2, 3).optional();
    Schema& symmetry =
        domain.table("symmetry", "planes of symmetry: the metal lies above them, its mirror image below");
    for (const char* axis : {"x", "y", "z"})
      symmetry.real(axis, std::string("place of the plane across ") + axis).unit("m").optional();
    declare_bodies(s);
    declare_rigids(s);
    declare_contacts(s);
    declare_sets_and_probes(s);
    declare_tracking(s);
    declare_vector_expression(s, "body_force", "m/s2", {"t"},
                              "body force per physical mass, quantities or formulas of t");
    declare_heat_and_output(s);
    return s;
  }();
  return schema;
}

}  // namespace stirsph
