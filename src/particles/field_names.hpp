/// Every particle field of the code, declared once.
#pragma once

#include "particles/field_info.hpp"

namespace stirsph::field {

// identity
inline constexpr FieldInfo id{"id", "1", "global particle number", Shape::Scalar, Halo::Static, true, true};
inline constexpr FieldInfo body{"body", "1", "index of the body in the scene", Shape::Scalar, Halo::Static, true, true};
inline constexpr FieldInfo material{"material", "1", "index of the material in the scene", Shape::Scalar, Halo::Static,
                                    true,       true};
inline constexpr FieldInfo sets{"sets", "1", "bit mask of the particle sets it belongs to"};
inline constexpr FieldInfo mass{"mass", "kg", "physical mass", Shape::Scalar, Halo::Static};

// kinematics
inline constexpr FieldInfo position{"position", "m", "position", Shape::Position, Halo::Kinematic, true, true};
inline constexpr FieldInfo initial_position{"initial_position", "m", "position at the start of the process",
                                            Shape::Position};
inline constexpr FieldInfo position_at_list_build{
    "position_at_list_build",
    "m",
    "position when the pair list was made; a restart rebuilds the same list from it",
    Shape::Position,
    Halo::None,
    true};
inline constexpr FieldInfo smooth_velocity{
    "smooth_velocity",
    "m/s",
    "smooth motion at the place where the pair list was made; the list ages relative to it",
    Shape::Position,
    Halo::None,
    true};
inline constexpr FieldInfo velocity{"velocity", "m/s", "velocity", Shape::Velocity, Halo::Kinematic, true, true};
inline constexpr FieldInfo acceleration{"acceleration", "m/s2", "acceleration by all forces", Shape::Velocity};
inline constexpr FieldInfo volumetric_strain{"volumetric_strain", "1", "ln(rho0/rho), the integral of div v",
                                             Shape::Scalar, Halo::Stress};
inline constexpr FieldInfo volumetric_strain_gradient{"volumetric_strain_gradient", "1/m",
                                                      "gradient of the volumetric strain, for the density diffusion",
                                                      Shape::Position, Halo::Stress};
inline constexpr FieldInfo volume{"volume", "m3", "m/rho", Shape::Scalar, Halo::Stress, true};
inline constexpr FieldInfo smoothing_length{"smoothing_length", "m", "kernel smoothing length h", Shape::Scalar,
                                            Halo::Stress};

// stress and material state
inline constexpr FieldInfo stress_deviator{"stress_deviator", "Pa", "Cauchy stress deviator", Shape::SymmetricTensor,
                                           Halo::None};
inline constexpr FieldInfo stress{
    "stress", "Pa", "Cauchy stress, positive in tension", Shape::SymmetricTensor, Halo::Stress, false, true};
inline constexpr FieldInfo artificial_stress{
    "artificial_stress",    "Pa",         "Gray-Monaghan artificial stress against the tensile instability",
    Shape::SymmetricTensor, Halo::Stress, false};
inline constexpr FieldInfo corrected_stress{
    "corrected_stress", "Pa", "stress times the gradient correction, sigma M^-1", Shape::Matrix, Halo::Stress, false};
inline constexpr FieldInfo velocity_gradient{
    "velocity_gradient", "1/s", "velocity gradient, rows velocity components", Shape::Matrix, Halo::Gradient, false};
inline constexpr FieldInfo strain_rate{"strain_rate",          "1/s",        "symmetric part of the velocity gradient",
                                       Shape::SymmetricTensor, Halo::Stress, false};
inline constexpr FieldInfo inverse_moment{"inverse_moment", "1",        "correction of the kernel gradient, M^-1",
                                          Shape::Matrix,    Halo::None, false};
inline constexpr FieldInfo hourglass_force{"hourglass_force", "N", "force of the hourglass control", Shape::Velocity};
inline constexpr FieldInfo hourglass_stress{
    "hourglass_stress", "Pa", "what the hourglass control adds to the stress, not symmetric", Shape::Matrix};
inline constexpr FieldInfo contact_traction{"contact_traction",
                                            "Pa",
                                            "force of the rigid bodies over the area that touches them",
                                            Shape::Velocity,
                                            Halo::None,
                                            false,
                                            true};
inline constexpr FieldInfo layer_moment{"layer_moment", "J",
                                        "normal forces of contact times their distances from the centre, F a n (x) n",
                                        Shape::SymmetricTensor};
inline constexpr FieldInfo layer_stretch{"layer_stretch", "1",
                                         "left Cauchy-Green tensor of the metal between a centre and its surface",
                                         Shape::SymmetricTensor};
inline constexpr FieldInfo equivalent_plastic_strain{
    "equivalent_plastic_strain", "1", "accumulated equivalent plastic strain", Shape::Scalar, Halo::None, true, true};
inline constexpr FieldInfo plastic_strain_rate{"plastic_strain_rate",
                                               "1/s",
                                               "equivalent plastic strain rate of the last step",
                                               Shape::Scalar,
                                               Halo::None,
                                               true,
                                               true};
inline constexpr FieldInfo flow_stress{"flow_stress", "Pa",       "current flow stress sigma_y",
                                       Shape::Scalar, Halo::None, true};

// beside rigid grips (mechanics/grip_rate.hpp)
inline constexpr FieldInfo held{"held", "1", "1 for particles of a grip that moves as a rigid body, else 0",
                                Shape::Scalar, Halo::Static};
inline constexpr FieldInfo plastic_rate_mean{"plastic_rate_mean", "1/s", "running mean of the plastic strain rate"};
inline constexpr FieldInfo shared_plastic_rate{
    "shared_plastic_rate", "1/s", "what a held particle gives of its plastic rate, or a free one has with what it took",
    Shape::Scalar, Halo::Stress};
inline constexpr FieldInfo rate_factor{"rate_factor", "1",
                                       "plastic rate that the strength feels over the particle's own"};

// microstructure
inline constexpr FieldInfo strain_at_window_start{"strain_at_window_start", "1",
                                                  "equivalent plastic strain when the present averaging window began"};
inline constexpr FieldInfo strain_rate_average{"strain_rate_average",
                                               "1/s",
                                               "equivalent plastic strain rate, mean over the last complete window",
                                               Shape::Scalar,
                                               Halo::None,
                                               true,
                                               true};
inline constexpr FieldInfo grain_size{
    "grain_size", "m", "grain diameter of the last recrystallisation, or initial", Shape::Scalar, Halo::None,
    true,         true};
inline constexpr FieldInfo recrystallised{
    "recrystallised", "1", "1 where the material has recrystallised, else 0", Shape::Scalar, Halo::None, true, true};

// heat
inline constexpr FieldInfo temperature{"temperature", "K", "temperature", Shape::Scalar, Halo::Thermal, true, true};
inline constexpr FieldInfo heat_input{"heat_input", "J", "plastic and friction heat since the last heat solve",
                                      Shape::Scalar, Halo::None};
inline constexpr FieldInfo rigid_heat{
    "rigid_heat", "J", "friction heat for each heat-conducting rigid body since the last heat solve", Shape::List};
inline constexpr FieldInfo rigid_impulse{
    "rigid_impulse", "N s", "normal contact impulse on each heat-conducting rigid body since the last heat solve",
    Shape::List};
inline constexpr FieldInfo conductivity{
    "conductivity", "W/m/K", "thermal conductivity at the present temperature", Shape::Scalar, Halo::Thermal, false};
inline constexpr FieldInfo conduction_correction{
    "conduction_correction", "1",           "weight of the heat links of a particle that lacks neighbours at a surface",
    Shape::Scalar,           Halo::Thermal, false};
inline constexpr FieldInfo matrix_row{"matrix_row",  "1",           "row of the particle in the heat matrix",
                                      Shape::Scalar, Halo::Thermal, false};

}  // namespace stirsph::field
