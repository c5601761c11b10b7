/// A scene as plain data: what the input file said, validated and in SI, before any particle exists.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "base/tensor.hpp"
#include "geometry/shape.hpp"
#include "geometry/tabulated_curve.hpp"
#include "input/parameters.hpp"
#include "materials/material.hpp"
#include "mechanics/settings.hpp"
#include "microstructure/grain_evolution.hpp"
#include "parallel/domain.hpp"
#include "particles/space.hpp"

namespace stirsph {

/// A velocity component or another quantity that may be a formula; empty = not given.
using OptionalExpression = std::optional<input::Expression>;

/// Rigid rotation at `rate` [rad/s], a formula of t, about an axis.
struct RotationScene {
  Vec3 centre, axis{0, 0, 1};
  input::Expression rate;
};

/// Particles filled into a shape.
struct BodyScene {
  std::string name;
  int material = 0;
  ShapePointer shape;
  Vec3 lattice_origin;
  double fill_margin = 0.25;                   ///< of the spacing
  double jitter = 0;                           ///< of the spacing
  input::Expression temperature;               ///< K, of x y z
  std::array<OptionalExpression, 3> velocity;  ///< m/s, of x y z
  std::optional<RotationScene> rotation;       ///< added to the velocity
};

/// A force programme and the limits of its controller (physics.md section 1). The programme's clock runs in contact.
struct ForceScene {
  double preload = 0, dwell = 0, ramp_rate = 0, target = 0;       ///< N, s, N/s, N
  double approach_time = 0.2;                                     ///< s over which the preload is applied
  double approach_speed = 0;                                      ///< m/s until a force is felt, 0 = from the billet
  double velocity_limit = 1e-3;                                   ///< m/s into the billet
  double withdrawal_limit = 1e-3;                                 ///< m/s out of it
  double stroke_limit = std::numeric_limits<double>::infinity();  ///< m of travel at which the tool stops for good
  double stiffness = 0;                                           ///< N/m, 0 = estimated from the billet
  double bandwidth = 0.15;                                        ///< of the billet's first axial frequency
};

/// Lifting the tool off at the end. Begins at a time, or a dwell after the table or the programme has come to its end.
struct RetreatScene {
  std::optional<double> at{};  ///< s; empty: by the dwell
  double dwell = 0;            ///< s
  double speed = 0;            ///< m/s
  double distance = 0;         ///< m
  Vec3 direction{0, 0, 1};
  bool stop_rotation = false;
};

/// How a rigid body moves.
struct MotionScene {
  enum class Kind { Fixed, Velocity, Displacement, Force } kind = Kind::Fixed;
  std::array<OptionalExpression, 3> velocity;  ///< m/s, of t
  Vec3 direction{0, 0, -1};                    ///< of displacement and force control: into the billet
  std::optional<TabulatedCurve> table;         ///< m over s along direction
  ForceScene force;
  std::optional<RetreatScene> retreat;
  Vec3 centre, axis{0, 0, 1};
  OptionalExpression rotation;                   ///< rad/s, of t
  std::optional<TabulatedCurve> rotation_table;  ///< rad/s over s
};

/// The mesh of a rigid body: from its shape, or from a file.
struct MeshScene {
  std::string file;  ///< empty: the shape is meshed
  double scale = 1;  ///< m per unit of the file
  std::string body;  ///< physical volume of the file; empty: all
  double near = 0, far = 0, growth = 0.3;
  std::optional<Bounds> cut;
};

/// A condition on outer facets of a meshed body, chosen by a region or by a group of the mesh file.
struct SurfaceScene {
  ShapePointer region;
  std::string group;
  enum class Kind { FixedTemperature, Film, Flux } kind = Kind::Film;
  double temperature = 293.15;  ///< K, of the surface or of the surroundings
  double conductance = 0;       ///< W/m2/K
  OptionalExpression flux;      ///< W/m2 into the body, of t x y z (body's frame)
};

struct RigidHeatScene {
  enum class Role { Insulated, Fixed, Lumped, Mesh } role = Role::Insulated;
  enum class Interface { Film, Perfect, Hybrid } interface = Interface::Film;
  input::Expression temperature;  ///< K, of x y z at the start
  double conductance = 0;         ///< W/m2/K of the interface; infinity = perfect
  double pressure_conductance = 0, reference_pressure = 1e6, pressure_exponent = 0.95;
  double heat_capacity = 0;
  double ambient_conductance = 0, ambient_temperature = 293.15;
  std::vector<bool> bodies;  ///< which exchange heat with it
  MeshScene mesh;
  std::vector<SurfaceScene> surfaces;
};

/// Heat put into bodies: per volume, or per free surface of particle bodies.
struct HeatSourceScene {
  std::vector<bool> bodies, rigids;
  bool on_surface = false;
  input::Expression value;  ///< W/m3 or W/m2, of t x y z
};

struct RigidScene {
  std::string name;
  ShapePointer shape;
  MotionScene motion;
  int material = -1;  ///< for the heat partition; -1 = none
  Vec3 reference_point;
  RigidHeatScene heat;
};

struct ContactScene {
  int rigid = 0;
  std::vector<bool> bodies;
  double friction = 0, shear_limit_factor = 1, shear_limit = -1;
  double penalty_scale = 0.1, soft_scale = 0.1, damping = 0, heat_conversion = 0.9;
  double heat_share = -1;  ///< < 0: from the effusivities
};

/// A set of particles chosen at the start by a region.
struct SetScene {
  std::string name;
  std::vector<bool> bodies;
  ShapePointer region;  ///< null: all particles of the bodies
};

/// Prescribed motion of a set; components not given are free.
struct GripScene {
  /// Whether it prescribes all components of the velocity, and those of a rigid body.
  bool rigid(const Space& space) const;

  std::string name;
  int set = 0;
  std::array<OptionalExpression, 3> velocity;  ///< m/s, of t and the particle's x y z
  std::optional<RotationScene> rotation;       ///< replaces the velocity across the axis
};

struct ProbeScene {
  enum class Kind {
    Point,
    Average,
    Deviation,
    Minimum,
    Maximum,
    Sum,
    Extent,
    AngularSpread,
    Mixing,
    ExtrudedLength
  } kind;
  std::string name, field;
  int component = 0;
  int set = -1;  ///< -1: all particles
  Vec3 position;
  int rigid = -1;
  bool by_body = false;  ///< mixing of bodies instead of materials
};

/// Paths of the particles of a set, written at an interval of their own.
struct TracerScene {
  std::string name;
  int set = 0;
  double interval = 0;  ///< s
  std::int64_t every_nth = 1;
  std::vector<std::string> fields;  ///< recorded besides the position; empty = the usual ones
};

struct HeatScene {
  enum class Mode { Off, Adiabatic, Conduction } mode = Mode::Off;
  int every = 1;  ///< mechanical steps per heat step
  double relative_tolerance = 1e-8;
  int nonlinear_iterations = 1;
  bool crank_nicolson = false;
  double ambient_conductance = 0;  ///< W/m2/K of the particles' free surface; 0 = insulated
  double ambient_temperature = 293.15;
  std::vector<HeatSourceScene> sources;
};

struct TimeScene {
  double end = 0;  ///< s
  double cfl = 0.5;
  double fixed_step = 0;  ///< s, 0 = from the CFL condition
  double start_step = 0;
  std::int64_t most_steps = 0;  ///< 0 = no limit
};

struct OutputScene {
  double history_interval = 0;     ///< s
  double snapshot_interval = 0;    ///< s, 0 = first and last only
  double checkpoint_interval = 0;  ///< s of process time, 0 = off
  double checkpoint_wall = 0;      ///< s of wall time, 0 = off
  std::int64_t checkpoint_steps = 0;
  double progress_wall = 5;  ///< s between progress lines
  std::int64_t history_steps = 0;
  std::vector<double> snapshot_times;  ///< s, besides the interval
  std::vector<std::string> fields;     ///< empty = those marked for snapshots
  bool contact_traction = false;       ///< recorded, for snapshots
  bool initial_position = false;       ///< recorded at the start and written to snapshots
};

struct LimitScene {
  double penetration = 1.0;  ///< of the spacing: deeper is a blow-up
  double speed = 0;          ///< m/s, 0 = ten times the wave speed
  double travel = 0.25;      ///< of the spacing, that a particle may go along its circle in a step (no_swirl)
  // of the inertia guards (driver/inertia_guards.hpp)
  std::array<double, 4> guards{0.2, 0.05, 1.0, 0.25};  ///< viscous, inertia, spin_up, rim_travel
  std::int64_t guard_steps = 20;                       ///< steps between looks, 0 = off
  bool guards_stop = false;                            ///< a guard above its limit ends the run instead of a warning
};

struct Scene {
  std::string title, path, effective_input;
  Space space = Cartesian3{};
  bool mechanics = true;
  MechanicsSettings numerics;
  double target_step = 0;        ///< s: density_scale chosen so that this step is stable; 0 = density_scale as given
  double inertia_tolerance = 0;  ///< share of the guards' limits up to which density_scale is raised; 0 = constant
  double scale_before_flow = 0;  ///< largest density_scale of the schedule
  double skin = 0.3;             ///< of the spacing
  double repartition_imbalance = 1.15;
  Domain domain;
  TimeScene time;
  HeatScene heat;
  std::optional<RecrystallisationRule> microstructure;
  OutputScene output;
  LimitScene limits;
  std::array<OptionalExpression, 3> body_force;  ///< m/s2, of t
  std::vector<Material> materials;
  std::vector<BodyScene> bodies;
  std::vector<RigidScene> rigids;
  std::vector<ContactScene> contacts;
  std::vector<SetScene> sets;
  std::vector<GripScene> grips;
  std::vector<ProbeScene> probes;
  std::vector<TracerScene> tracers;
};

/// The grain laws by material index, for a scene with microstructure.
std::vector<GrainLaw> grain_laws(const Scene& scene);

/// Every key a scene file may hold.
const input::Schema& scene_schema();
/// Reads and validates a scene file. Throws InputError.
Scene read_scene(const std::string& path, const std::vector<std::string>& overrides = {});
Scene read_scene_text(const std::string& text, const std::string& folder,
                      const std::vector<std::string>& overrides = {});

}  // namespace stirsph
