/// Contact of particles with rigid bodies: penalty force with a soft-constraint floor (paper eqs 10-11), Coulomb
/// friction limited by the shear strength (eq. 12), friction heat and its split (eqs 14-15).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "contact/surface_layer.hpp"
#include "geometry/rigid_body.hpp"
#include "materials/flow_stress.hpp"
#include "particles/inertia.hpp"
#include "particles/particle_set.hpp"

namespace stirsph {

/// One contact pair: a rigid body and the particles of some bodies.
struct ContactPair {
  int rigid = 0;                  ///< index of the rigid body
  std::vector<bool> bodies;       ///< which particle bodies take part
  double friction = 0;            ///< Coulomb coefficient mu
  double shear_limit_factor = 1;  ///< factor on the shear strength sigma_y/sqrt(3) of the metal at the surface
  double shear_limit = -1;        ///< Pa; when >= 0 it replaces the flow stress limit
  double penalty_scale = 0.1;     ///< times E A/dx, A the particle's area: the standard penalty stiffness
  double soft_scale = 0.1;        ///< S_f of eq. 11
  double damping = 0;             ///< fraction of critical damping of the normal spring
  double heat_conversion = 0.9;   ///< eta of eq. 14
  int heat_component = -1;        ///< of field::rigid_heat for the body's share of the friction heat; -1: it takes none
  std::vector<double> heat_share;  ///< per material: share of friction heat that stays in the particle (f of eq. 15)
};

/// What contact needs to know of a material of the particles.
struct ContactMaterial {
  double youngs_modulus = 0;               ///< Pa, with the elastic scaling
  std::shared_ptr<const FlowStress> flow;  ///< null: elastic
};

/// What one rigid body felt in the last step, on this rank.
struct ContactLoad {
  Vec3 force;                 ///< N, of the particles on the body
  Vec3 torque;                ///< N m, about the body's axis point
  double friction_power = 0;  ///< W dissipated by sliding
  double sliding_speed = 0;   ///< sum over touching particles of |v_t| [m/s]
  double surface_speed = 0;   ///< sum over touching particles of the body's own tangential speed there [m/s]
  double area = 0;            ///< m2 in contact
  double normal_force = 0;    ///< N, sum of the normal forces' magnitudes
  double penetration = 0;     ///< m, deepest
  double heat = 0;            ///< J of friction heat into the body in this step
};

/// Work of this rank since the start [J].
struct ContactLedger {
  double external = 0;       ///< done by the moving rigid bodies on the particles
  double friction = 0;       ///< dissipated by sliding
  double normal = 0;         ///< stored in (and damped by) the penalty springs
  double friction_heat = 0;  ///< put into particles
};

class Contact {
 public:
  /// `spacing` [m]; a particle's surface lies spacing/2 outside its centre. `materials` by their number in
  /// field::material. `surface_layers`: the half spacing deforms (SurfaceLayer), and press() must be called before the
  /// momentum sum.
  Contact(std::vector<ContactPair> pairs, const SpaceLayout& layout, double spacing,
          std::vector<ContactMaterial> materials, const Inertia& inertia, bool surface_layers = false);

  bool has_surface_layers() const { return layer_.has_value(); }
  void add_fields(ParticleSet& particles) const {
    if (layer_) layer_->add_fields(particles);
  }
  void initialise(ParticleSet& particles) const {
    if (layer_) layer_->initialise(particles);
  }

  /// From now on, another scaling of the mass; the soft constraint keeps its stiffness.
  void set_density_scale(double scale) {
    contact_step_ *= std::sqrt(scale / inertia_.scale);
    inertia_.scale = scale;
  }

  /// Local indices are no longer valid (the particles were reordered).
  void forget_candidates() { candidates_valid_ = false; }

  /// Adds contact accelerations to the field `acceleration`, which must already hold all other forces, and friction
  /// heat; also the normal impulse where the particles have field::rigid_impulse. `travel` [m]: upper bound of how far
  /// any particle or body surface moved since the last call. dt [s]. With surface layers it needs what press() found.
  void apply(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel, bool heat_input);
  /// With surface layers, after the stress update and at the positions and velocities of the apply() that follows:
  /// deforms the layers and adds the stress that the normal forces have in them to field::corrected_stress. `travel` as
  /// in apply().
  void press(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel);

  /// Per pair the owned particles that contact has to look at while candidate lists live, at these positions.
  std::vector<std::vector<std::int32_t>> search(const ParticleSet& particles,
                                                const std::vector<RigidBody>& bodies) const;

  /// Searches for candidates that apply() has made.
  long searches() const { return searches_; }

  const std::vector<ContactLoad>& loads() const { return loads_; }
  ContactLedger& ledger() { return ledger_; }
  const ContactLedger& ledger() const { return ledger_; }
  const std::vector<ContactPair>& pairs() const { return pairs_; }
  /// Contact time step of eq. 11: grows with the solution step, never shrinks. Part of the state.
  double& contact_step() { return contact_step_; }
  /// Deepest overlap of each pair [m] and the id of that particle on this rank; for the check of the initial state.
  struct Overlap {
    double depth = 0;
    std::int64_t id = -1;
    Vec3 position;
  };
  std::vector<Overlap> overlaps(const ParticleSet& particles, const std::vector<RigidBody>& bodies) const;

 private:
  double margin() const;  ///< m that may be travelled while a candidate list lives
  /// m that a particle's surface can lie outside its centre.
  double largest_distance() const { return layer_ ? layer_->thickest() : 0.5 * spacing_; }
  void renew_candidates(const ParticleSet& particles, const std::vector<RigidBody>& bodies, double travel);
  /// m2 that a particle covers on a surface; of a ring all around, in plane strain per metre of depth.
  double area_of(double volume, double radius) const;
  /// How a particle touches a body.
  struct Touch {
    std::int32_t particle = 0;
    Vec3 position;          ///< m, of the centre
    Vec3 normal;            ///< out of the body
    double distance = 0;    ///< m from the body's surface to the centre
    double thickness = 0;   ///< m from the centre to the particle's surface
    Vec3 foot;              ///< m, where the body's surface is touched (its velocity and arm are taken there)
    Vec3 surface_velocity;  ///< m/s of the body at the foot
    double area = 0;        ///< m2
    double force = 0;       ///< N, normal
    double depth() const { return thickness - distance; }
  };
  /// Fills touches_ at the present positions and velocities.
  void find_touches(ParticleSet& particles, const std::vector<RigidBody>& bodies, double dt, double travel,
                    const LayerArrays* layers);
  /// Radius of the touched surface over that of a ring: the surface's friction has that area and arm, the metal between
  /// it and the ring's centre passes its torque on. 1 in other spaces, where a particle has no moment to take one by.
  double lever(const Touch& touch) const;
  /// Friction [N] at the surface that brings a slip [m/s] there to rest, which all other forces would leave at the end
  /// of the kick: friction never reverses the slip and a held particle does not creep, also where inertia depends on
  /// the direction.
  Vec3 sticking(const Vec3& x, const Vec3& slip, double lever, double mass, double dt) const;
  /// Friction [N] of the given magnitude that slows the slip down.
  Vec3 sliding(const Vec3& x, const Vec3& slip, double lever, double mass, double limit, double dt) const;
  /// Largest friction [N] of particle i: Coulomb's, or what the metal at the surface bears, sigma_y/sqrt(3) of its area
  /// (paper eq. 12). sigma_y is taken at the rate of the particle or at that of a layer of one spacing which shears
  /// with the slip left after the kick, whichever is the larger: a surface that slips and a layer that is sheared are
  /// the same thing at this resolution and must be equally strong. `stopping` [N]: what would stop the slip.
  double shear_limit(const ContactPair& pair, const ParticleSet& particles, std::size_t i, double area, double coulomb,
                     double slip, double stopping) const;

  std::vector<ContactPair> pairs_;
  int dim_;
  std::optional<SurfaceLayer> layer_;
  double spacing_;
  std::vector<ContactMaterial> materials_;
  Inertia inertia_;
  double contact_step_ = 0;
  bool candidates_valid_ = false;
  long searches_ = 0;
  double budget_ = 0;  ///< m that may still be travelled before a new particle could touch
  std::vector<std::vector<std::int32_t>> candidates_;
  std::vector<std::vector<Touch>> touches_;  ///< per pair
  std::vector<ContactLoad> loads_;
  ContactLedger ledger_;
};

}  // namespace stirsph
