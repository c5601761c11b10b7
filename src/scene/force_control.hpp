/// The force programme of a tool and the controller that turns its force into a speed.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "scene/scene.hpp"

namespace stirsph {

/// What the force controller must know of the billet it presses, all with density and elastic scaling.
struct BilletStiffness {
  double stiffness = 0;          ///< N/m, E A/L
  double angular_frequency = 0;  ///< rad/s of the first axial mode
  double impedance = 0;          ///< N s/m, rho c A: the force per speed of an impact on a rod
};

/// Contact search, preload, dwell, ramp, hold, end of stroke.
///
/// Without contact the tool approaches at a speed whose impact force stays below a share of the preload. Once a force
/// is felt a PI controller on the filtered force takes over, critically damped around the billet as a spring (after
/// feasibility.md section 1): V = I + Kp e, dI/dt = Ki e, with limits of V and an integral that stops while a limit
/// holds. The programme starts with the force that is felt, and its clock runs only in contact.
class ForceControl {
 public:
  enum class Phase { Search, Preload, Ramp, Hold, StrokeEnd };

  ForceControl(const ForceScene& scene, const BilletStiffness& billet);
  /// New gains and approach speed for a billet that was scaled anew; the state of the controller stays.
  void renew_gains(const BilletStiffness& billet);

  /// Speed [m/s] into the billet during the next `dt` [s]. `force` [N]: compression felt in the last step; `travel`
  /// [m]: way so far.
  double speed(double dt, double force, double travel);

  double target_force() const;  ///< N that is asked for now; 0 while contact is searched
  /// Filtered force less the target, over the target; infinite while contact is searched, 0 at the end of the stroke.
  double error() const;
  Phase phase() const;
  bool at_velocity_limit() const { return at_limit_; }
  double time_at_velocity_limit() const { return time_at_limit_; }      ///< s since the start
  double contact_time() const { return clock_; }                        ///< s, the programme's clock
  double time_since_end() const { return since_end_; }                  ///< s since target force or stroke limit
  double approach_speed() const { return approach_speed_; }             ///< m/s
  double impact_force() const { return approach_speed_ * impedance_; }  ///< N, rho c A v at the approach speed

  /// All that a continued run needs.
  static constexpr std::size_t state_size = 9;
  std::array<double, state_size> state() const;
  void restore(std::span<const double, state_size> state);

 private:
  bool finds_contact(double force);
  double programme() const;
  double programme_end() const;

  ForceScene scene_;
  double proportional_ = 0, integral_gain_ = 0, filter_rate_ = 0;
  double approach_speed_ = 0, impedance_ = 0;

  bool in_contact_ = false, stroke_ended_ = false, at_limit_ = false;
  double integral_ = 0;       ///< m/s
  double filtered_ = 0;       ///< N
  double clock_ = 0;          ///< s in contact
  double applied_ = 0;        ///< share of the programme's force applied since contact was found, 0 .. 1
  double since_end_ = 0;      ///< s
  double time_at_limit_ = 0;  ///< s
};

}  // namespace stirsph
