/// The temperature nodes of all rigid bodies: their ranks, their rows of the heat matrix, conduction between them.
///
/// Nodes of all bodies are numbered through; every rank knows every temperature (a few hundred kilobytes at the paper's
/// 380,716 tetrahedra), but rows, elements and the solve are shared out by METIS. A lumped body or one of fixed
/// temperature is a single node. Element conduction: G_ab = -k V grad N_a . grad N_b [W/K], mass lumped. Of a section V
/// is the volume of the ring: gradients are constant in an element, so that its integral of 2 pi r is exact.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/comm.hpp"
#include "thermal/heat_matrix.hpp"
#include "thermal/interface_point.hpp"
#include "thermal/rigid_heat.hpp"

namespace stirsph {

/// A heat path between an owned particle and nodes of a body: flow into the nodes G sum_a w_a (T_i - T_a) [W].
struct RigidLink {
  std::int32_t particle;
  std::int32_t body;
  double conductance;                 ///< G, W/K
  double heat;                        ///< J of friction heat for the nodes
  std::span<const NodeWeight> nodes;  ///< numbered through all bodies
};

class RigidNodes {
 public:
  /// Shares the nodes out. Collective; the bodies, with their meshes, must not change afterwards.
  RigidNodes(const Comm& comm, std::span<const RigidHeat> bodies);

  std::size_t total() const { return owner_.size(); }
  std::size_t owned() const { return mine_.size(); }
  /// Number of a body's first node; -1 for an insulated body.
  std::int32_t first_node(std::size_t body) const { return first_node_[body]; }
  std::size_t body_nodes(std::size_t body) const { return node_count_[body]; }
  bool fixed(std::int32_t node) const { return fixed_[node]; }
  std::size_t bytes() const;

  /// Decides the rows: on each rank first its particles, then its nodes. Collective.
  void number_rows(const Comm& comm, std::size_t owned_particles);
  std::int64_t first_row() const { return first_row_; }
  std::int64_t row(std::int32_t node) const { return row_base_[owner_[node]] + local_[node]; }

  /// Takes the temperatures of the bodies as the start of a step.
  void begin_step(std::span<const RigidHeat> bodies);
  double start(std::int32_t node) const { return start_[node]; }  ///< K
  /// Properties at the time level of the fluxes between start and the present end temperatures.
  void linearise(std::span<const RigidHeat> bodies, double implicit_share);
  /// Brings the links of all particles to the owners of the nodes. `row` and `temperature` [K] per owned particle.
  /// Collective.
  void receive_links(const Comm& comm, std::span<const RigidLink> links, std::span<const double> row,
                     std::span<const double> temperature);
  /// Writes the rows of this rank's nodes and their right sides (heat_solver.cpp says which system).
  void fill(HeatMatrixWriter& writer, std::span<double> right, double dt, double implicit_share) const;

  /// Heat capacity [J/K] of this rank's k-th node as linearised.
  double capacity(std::size_t k) const { return capacity_[k]; }
  /// End temperatures from the heat [J] that each of this rank's nodes received; `rise` [K] is the solution. Returns
  /// the largest change of an end temperature and the largest rise. Collective.
  std::pair<double, double> update_end(const Comm& comm, std::span<const RigidHeat> bodies,
                                       std::span<const double> heat, std::span<const double> rise);
  /// Temperature [K] at the time level of the fluxes, after update_end.
  double between(std::int32_t node, double implicit_share) const { return start_[node] + implicit_share * rise_[node]; }

  /// What the outside of each body did in the step, this rank's share [J].
  struct Outflow {
    double film = 0;     ///< to the surroundings
    double fixed = 0;    ///< into nodes of fixed temperature by conduction, films and sources, not by links
    double sources = 0;  ///< node_input of the body's nodes
    double gained = 0;   ///< by its free nodes
  };
  std::vector<Outflow> outflow(std::span<const double> heat, double dt, double implicit_share) const;
  /// Writes the end temperatures back to the bodies.
  void finish_step(std::span<RigidHeat> bodies) const;

 private:
  struct Received {
    std::int64_t row;
    double conductance, difference, heat;  ///< W/K; sum of w (T_i - T_a) at the start [K]; J
    std::size_t first, last;               ///< into received_nodes_
  };
  void share_out(const Comm& comm, std::span<const RigidHeat> bodies);
  void build_conduction(std::span<const RigidHeat> bodies);

  int rank_;
  std::vector<std::int32_t> first_node_;  ///< per body
  std::vector<std::size_t> node_count_;
  // of all nodes
  std::vector<std::int32_t> body_;
  std::vector<int> owner_;
  std::vector<std::int32_t> local_;  ///< index among the owner's nodes
  std::vector<bool> fixed_;
  std::vector<double> start_, end_, rise_;
  std::vector<std::int32_t> gathered_order_;  ///< node at each place of a gather in rank order
  // of this rank
  std::vector<std::int32_t> mine_;
  std::vector<double> capacity_, film_conductance_, film_source_, input_;
  std::vector<std::size_t> starts_;       ///< conduction links of the k-th node: starts_[k] .. starts_[k + 1]
  std::vector<std::int32_t> neighbours_;  ///< their nodes, ascending
  std::vector<double> conductances_;      ///< W/K
  /// One element's share of a link: its conductivity times `factor` [m] is added to conductances_[link].
  struct Share {
    std::int32_t body, element;
    std::size_t link;
    double factor;
  };
  std::vector<Share> shares_;           ///< kept only where the conductivity depends on temperature
  std::vector<std::int64_t> row_base_;  ///< row of each rank's first node
  std::int64_t first_row_ = 0;
  std::vector<Received> received_;
  std::vector<NodeWeight> received_nodes_;
  struct Touch {
    std::size_t link;
    double weight;
  };
  std::vector<std::size_t> touch_starts_;
  std::vector<Touch> touches_;  ///< links that touch the k-th node
};

/// The temperature rise d with  integral of c_p from T to T + d  =  heat [J/kg].
double temperature_rise(const TemperaturePolynomial& specific_heat, double temperature, double heat);
/// The specific heat that turns a temperature change from `from` to `to` into the exact enthalpy difference.
double secant_specific_heat(const TemperaturePolynomial& specific_heat, double from, double to);

}  // namespace stirsph
