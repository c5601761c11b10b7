#include "scene/read_numerics.hpp"

namespace stirsph {

using input::Parameters;

namespace {

Kernel kernel_of(const std::string& keyword) {
  if (keyword == WendlandC2::keyword) return WendlandC2{};
  if (keyword == WendlandC4::keyword) return WendlandC4{};
  if (keyword == QuinticSpline::keyword) return QuinticSpline{};
  return CubicSpline{};
}

}  // namespace

void read_numerics(const Parameters& root, Scene& scene) {
  const Parameters n = root.table("numerics");
  MechanicsSettings& m = scene.numerics;
  m.kernel = kernel_of(n.text("kernel"));
  m.spacing = n.real("spacing");
  m.h_over_dx = n.real("h_over_dx");
  m.variable_h = n.boolean("variable_h");
  const std::string& correction = n.text("gradient_correction");
  m.gradient_correction = correction == "full"       ? GradientCorrection::Full
                          : correction == "velocity" ? GradientCorrection::Velocity
                                                     : GradientCorrection::None;
  if (n.has("largest_correction")) m.largest_correction = n.real("largest_correction");
  if (m.largest_correction > 0 && m.gradient_correction == GradientCorrection::None)
    n.fail("largest_correction", "there is no correction to bound. Give gradient_correction as well.");
  m.viscosity_alpha = n.real("viscosity_alpha");
  m.viscosity_beta = n.real("viscosity_beta");
  m.viscosity_reconstruction = n.boolean("viscosity_reconstruction");
  m.density_diffusion = n.real("density_diffusion");
  m.density_reconstruction = n.boolean("density_reconstruction");
  m.artificial_stress = n.real("artificial_stress");
  m.hourglass_control = n.real("hourglass_control");
  if (m.hourglass_control > 0 && m.gradient_correction != GradientCorrection::Full)
    n.fail("hourglass_control",
           "it works on what the velocity gradient does not see, and its stress must act as the adjoint of that "
           "gradient, also at free surfaces. Give gradient_correction = \"full\".");
  if (m.hourglass_control > 0 && m.variable_h)
    n.fail("hourglass_control", "its springs have the kernel of the start. Give variable_h = false.");
  m.density_scale = n.real("density_scale");
  m.elastic_scale = n.real("elastic_scale");
  m.swirl_inertia = n.text("inertia") == "full";
  m.swirl_density_ratio = n.real("swirl_density_ratio");
  m.viscosity_without_swirl = n.text("viscosity_velocity") == "no_swirl";
  if (m.swirl_density_ratio < 1 && m.swirl_inertia)
    n.fail("swirl_density_ratio",
           "a swirl that is lighter than other motion needs inertia = \"no_swirl\": its "
           "centrifugal force would not fit its mass.");
  if (m.swirl_density_ratio < 1 && !m.viscosity_without_swirl && m.viscosity_alpha + m.viscosity_beta > 0 &&
      scene.space.index() == Space(Cartesian3{}).index())
    n.fail(
        "swirl_density_ratio",
        "viscosity of the whole velocity acts on the lighter swirl as one over this ratio times as much viscosity and "
        "exceeds the stable step. Take viscosity_velocity = \"no_swirl\", or the ratio 1.");
  if (scene.space.index() == Space(PlaneStrain{}).index() && (!m.swirl_inertia || m.viscosity_without_swirl))
    n.fail(m.swirl_inertia ? "viscosity_velocity" : "inertia",
           "in plane strain there is no axis of swirl. Allowed: \"full\".");
  if (n.has("density_scale_for_step")) scene.target_step = n.real("density_scale_for_step");
  if (scene.target_step > 0 && m.density_scale != 1)
    n.fail("density_scale_for_step", "give either density_scale or density_scale_for_step, not both.");
  scene.inertia_tolerance = n.real("inertia_tolerance");
  if (n.has("density_scale_before_flow")) scene.scale_before_flow = n.real("density_scale_before_flow");
  if (scene.scale_before_flow > 0 && scene.inertia_tolerance == 0)
    n.fail("density_scale_before_flow",
           "without inertia_tolerance density_scale stays constant. Give inertia_tolerance, for example 0.5, or leave "
           "this out.");
  scene.skin = n.real("skin");
  scene.repartition_imbalance = n.real("repartition_imbalance");
}

}  // namespace stirsph
