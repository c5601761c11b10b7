/// A run: the state of a simulation and its time step.
#pragma once

#include <exception>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/comm.hpp"
#include "base/timer.hpp"
#include "contact/contact.hpp"
#include "driver/inertia_guards.hpp"
#include "driver/scaling_schedule.hpp"
#include "driver/step_vote.hpp"
#include "io/checkpoint.hpp"
#include "mechanics/mechanics.hpp"
#include "parallel/repartition_rule.hpp"
#include "scene/populate.hpp"
#include "scene/rigid_heat_bodies.hpp"
#include "scene/rigid_motion.hpp"
#include "scene/scene.hpp"
#include "thermal/heat_solver.hpp"

namespace stirsph {

struct Clock {
  double time = 0;  ///< s
  std::int64_t step = 0;
  double dt = 0;       ///< s, of the step being made or just made
  double next_dt = 0;  ///< s, agreed for the next step
};

/// Work that is not kept by mechanics and contact; this rank's share since the start [J].
struct LoadLedger {
  double body_force = 0;
  double grips = 0;
  double rescaling = 0;        ///< kinetic energy that changes of the density scale made
  double initial_kinetic = 0;  ///< scaled inertia, all ranks
};

/// Heat balance of the whole run, all ranks [J].
struct HeatLedger {
  double particles = 0, rigid = 0, source = 0, fixed = 0, ambient = 0;
  std::vector<BodyHeat> bodies;  ///< per rigid body
  /// (gained + given away - put in)/(largest of the terms): what the solve lost.
  double residual() const;
};

/// Reaction of a grip in the last step [N, N m about its centre], this rank's share.
struct GripLoad {
  Vec3 force, torque;
};

/// Upkeep of pair lists since this program started.
struct ListUpkeep {
  long renewals = 0;      ///< lists made after the first one
  long repartitions = 0;  ///< of these, with a new partition
  long steps = 0;         ///< steps made
  double steps_per_list() const { return static_cast<double>(steps) / static_cast<double>(renewals + 1); }
};

class Simulation {
 public:
  Simulation(Comm comm, Scene scene);
  ~Simulation();

  /// Creates particles, lists, initial stress and acceleration. Collective. Throws InputError when the scene makes no
  /// sense.
  void start();
  /// Continues from a checkpoint instead. Collective.
  void resume(const std::string& checkpoint);

  /// One time step. Collective; a failure on any rank is thrown on all, with the state of the last finished phase
  /// intact.
  void step();
  /// A heat solve out of turn, over the time since the last one; for measurements. Collective.
  void solve_heat_now();
  /// New pair lists out of turn; for measurements. Collective.
  void renew_neighbours_now() { renew_neighbours(); }
  bool finished() const;
  /// From now on, another scaling of the mass, with all that depends on it. Between steps.
  void change_density_scale(double scale);

  /// State that is not a particle field, for the checkpoint.
  NamedState named_state() const;

  const Comm& comm() const { return comm_; }
  const Scene& scene() const { return scene_; }
  const Clock& clock() const { return clock_; }
  ParticleSet& particles() { return particles_; }
  const ParticleSet& particles() const { return particles_; }
  const Neighbourhood& neighbourhood() const { return *neighbourhood_; }
  Mechanics* mechanics() const { return mechanics_.get(); }
  Contact* contact() const { return contact_.get(); }
  /// Null without mechanics or when they are switched off; the schedule also when the scaling is constant.
  const InertiaGuards* guards() const { return guards_.get(); }
  const ScalingSchedule* schedule() const { return schedule_.get(); }
  const std::vector<RigidBody>& rigids() const { return rigids_; }
  const std::vector<RigidMotion>& motions() const { return motions_; }
  const std::vector<RigidHeat>& rigid_heat() const { return rigid_heat_; }
  /// Where the point probes of meshed bodies lie in their meshes.
  const std::vector<NodeWeight>& probe_nodes(const std::string& probe) const { return probe_nodes_.at(probe); }
  const std::vector<GripLoad>& grip_loads() const { return grip_loads_; }
  const LoadLedger& load_ledger() const { return load_ledger_; }
  const HeatLedger& heat_ledger() const { return heat_ledger_; }
  const HeatSolver* heat_solver() const { return heat_.get(); }
  const HeatReport& last_heat() const { return last_heat_; }
  const ListUpkeep& list_upkeep() const { return list_upkeep_; }
  /// What a renewal of the lists costs in steps without one; 0 before there was one. This rank's.
  double renewal_cost() const;
  /// Most loaded rank over the mean, by the costs that a new partition would weigh now. Collective.
  double imbalance() const;
  /// The same by the seconds since the start that ranks spent in sweeps and contact, messages not counted. Collective.
  double measured_imbalance() const;
  const PhaseTimers& timers() const { return timers_; }
  const std::vector<BodyCount>& body_counts() const { return body_counts_; }
  std::int64_t particle_count() const { return particle_count_; }
  /// Force and torque [N, N m] of the particles on a rigid body in the last step, all ranks.
  Vec3 rigid_force(int rigid) const { return rigid_force_[rigid]; }
  Vec3 rigid_torque(int rigid) const { return rigid_torque_[rigid]; }
  double largest_penetration() const { return penetration_; }  ///< m, last step, all ranks
  double largest_speed() const { return speed_; }              ///< m/s, last step, all ranks

  /// Requests of the outside world, agreed with the vote of the next step.
  struct Requests {
    bool stop = false, progress = false, checkpoint = false;
  };
  Requests requests;  ///< set by this rank before step(), holds what was agreed after it

 private:
  void add_fields();
  void build_contact();
  void refuse_overlaps();
  void refuse_misplaced_meshes();
  void refuse_coincident_particles();
  void refuse_empty_sets();
  void refuse_hopeless_step();
  void prepare_rigids();
  void place_probes();
  BilletStiffness billet_stiffness(const RigidScene& rigid) const;

  void kick(double dt);
  void drift(double dt);
  void drift_rings(double dt);
  void drift_on_circles(double dt);
  void bounce_off_planes();
  void add_centrifugal(double dt);
  void move_rigids(double dt);
  void renew_neighbours();
  std::vector<double> particle_costs() const;
  void apply_loads(double dt);
  double travel_of_contact(double dt) const;  ///< m, upper bound of how far particles and surfaces move in a step
  void apply_grips(double dt);
  void advance_heat(double dt);
  void absorb_heat_at_once();
  void conduct(double dt);
  void add_heat_sources(double dt, const std::vector<double>& free_area);
  bool needs_free_surface() const;
  void vote();
  double stable_step() const;
  void look_at_inertia();
  void set_density_scale(double scale);
  double kinetic_energy() const;
  double largest_force_error() const;
  double surface_speed() const;
  void mark_held_particles();
  void collect_grip_members();
  void measure_extent();
  void set_grip_velocities();

  /// Runs a phase that may fail on one rank only; the failure is agreed on in the vote.
  template <class Work>
  void guarded(Work&& work);
  template <class Work>
  void sweep(const char* phase, Halo role, bool exchange, Work&& work);

  Comm comm_;
  Scene scene_;
  ParticleSet particles_;
  Clock clock_;
  std::unique_ptr<Neighbourhood> neighbourhood_;
  std::unique_ptr<Mechanics> mechanics_;
  std::unique_ptr<Contact> contact_;
  std::unique_ptr<HeatSolver> heat_;
  std::unique_ptr<GrainEvolution> grains_;
  std::unique_ptr<StepVote> vote_;
  std::unique_ptr<InertiaGuards> guards_;
  std::unique_ptr<ScalingSchedule> schedule_;
  std::vector<RigidBody> rigids_;
  std::vector<RigidMotion> motions_;
  std::vector<RigidHeat> rigid_heat_;
  std::unique_ptr<InterfaceSearch> interfaces_;
  std::map<std::string, std::vector<NodeWeight>> probe_nodes_;
  std::vector<Vec3> rigid_force_, rigid_torque_;
  std::vector<std::vector<std::int32_t>> grip_members_;
  std::vector<GripLoad> grip_loads_;
  std::vector<BodyCount> body_counts_;
  std::int64_t particle_count_ = 0;
  LoadLedger load_ledger_;
  HeatLedger heat_ledger_;
  HeatReport last_heat_;
  PhaseTimers timers_;
  ListUpkeep list_upkeep_;
  RepartitionRule repartition_rule_;
  std::exception_ptr failure_;
  double time_since_heat_ = 0;
  double speed_ = 0, penetration_ = 0, least_h_ = 0;
  bool list_expired_ = false;
  double farthest_ = 0;  ///< m, farthest owned particle from the origin at the last vote or list build
};

}  // namespace stirsph
