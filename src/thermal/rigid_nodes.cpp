#include "thermal/rigid_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "parallel/graph_partition.hpp"

namespace stirsph {
namespace {

bool has_nodes(const RigidHeat& body) { return body.role != RigidHeat::Role::Insulated; }

/// Mesh edges of all bodies as a graph; single nodes are vertices without edges.
Graph edge_graph(std::span<const RigidHeat> bodies, const std::vector<std::int32_t>& first_node, std::size_t total) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].mesh) continue;
    const SimplexMesh& mesh = bodies[b].mesh->mesh();
    for (const auto& element : mesh.elements)
      for (int i = 0; i < mesh.corners(); ++i)
        for (int j = 0; j < mesh.corners(); ++j)
          if (i != j) edges.emplace_back(first_node[b] + element[i], first_node[b] + element[j]);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  Graph graph;
  graph.first.assign(total + 1, 0);
  for (const auto& [from, to] : edges) {
    graph.first[from + 1] += 1;
    graph.adjacent.push_back(to);
  }
  std::partial_sum(graph.first.begin(), graph.first.end(), graph.first.begin());
  return graph;
}

}  // namespace

double temperature_rise(const TemperaturePolynomial& specific_heat, double temperature, double heat) {
  double rise = heat / specific_heat(temperature);
  if (specific_heat.constant()) return rise;
  // Newton, at home because c_p > 0.
  for (int k = 0; k < 50; ++k) {
    const double excess = specific_heat.integral(temperature, temperature + rise) - heat;
    const double change = excess / specific_heat(temperature + rise);
    rise -= change;
    if (std::abs(change) <= 1e-15 * std::abs(temperature)) break;
  }
  return rise;
}

double secant_specific_heat(const TemperaturePolynomial& specific_heat, double from, double to) {
  if (std::abs(to - from) <= 1e-9 * std::abs(from)) return specific_heat(from);
  return specific_heat.integral(from, to) / (to - from);
}

RigidNodes::RigidNodes(const Comm& comm, std::span<const RigidHeat> bodies) : rank_(comm.rank()) {
  for (const RigidHeat& body : bodies) {
    const std::size_t count = !has_nodes(body) ? 0 : body.mesh ? body.mesh->nodes() : 1;
    first_node_.push_back(count > 0 ? static_cast<std::int32_t>(body_.size()) : -1);
    node_count_.push_back(count);
    for (std::size_t n = 0; n < count; ++n) {
      body_.push_back(static_cast<std::int32_t>(node_count_.size() - 1));
      fixed_.push_back(body.mesh ? body.mesh->fixed(n) : body.role == RigidHeat::Role::FixedTemperature);
    }
  }
  share_out(comm, bodies);
  build_conduction(bodies);
}

void RigidNodes::share_out(const Comm& comm, std::span<const RigidHeat> bodies) {
  const std::size_t total = body_.size();
  owner_ = partition_graph(comm, comm.is_root() ? edge_graph(bodies, first_node_, total) : Graph{}, comm.size());
  std::vector<std::int32_t> counts(static_cast<std::size_t>(comm.size()), 0);
  for (std::size_t g = 0; g < total; ++g) {
    local_.push_back(counts[owner_[g]]++);
    if (owner_[g] == comm.rank()) mine_.push_back(static_cast<std::int32_t>(g));
  }
  gathered_order_.resize(total);
  std::iota(gathered_order_.begin(), gathered_order_.end(), 0);
  std::stable_sort(gathered_order_.begin(), gathered_order_.end(),
                   [&](std::int32_t a, std::int32_t b) { return owner_[a] < owner_[b]; });
}

void RigidNodes::build_conduction(std::span<const RigidHeat> bodies) {
  struct Part {
    std::int32_t node, neighbour, body, element;  ///< node: index among this rank's
    double factor;                                ///< m
  };
  std::vector<Part> parts;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].mesh) continue;
    const SimplexMesh& mesh = bodies[b].mesh->mesh();
    for (std::size_t e = 0; e < mesh.elements.size(); ++e) {
      const auto& nodes = mesh.elements[e];
      bool touches = false;
      for (int i = 0; i < mesh.corners(); ++i) touches = touches || owner_[first_node_[b] + nodes[i]] == rank_;
      if (!touches) continue;
      const auto gradients = shape_gradients(mesh, static_cast<std::int32_t>(e));
      const double volume = element_volume(mesh, static_cast<std::int32_t>(e));
      for (int i = 0; i < mesh.corners(); ++i) {
        const std::int32_t from = first_node_[b] + nodes[i];
        if (owner_[from] != rank_) continue;
        for (int j = 0; j < mesh.corners(); ++j)
          if (i != j)
            parts.push_back({local_[from], first_node_[b] + nodes[j], static_cast<std::int32_t>(b),
                             static_cast<std::int32_t>(e), -volume * dot(gradients[i], gradients[j])});
      }
    }
  }
  // Stable: the elements of a link stay in mesh order, so both of its ends get the same sum on any rank.
  std::stable_sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
    return a.node != b.node ? a.node < b.node : a.neighbour < b.neighbour;
  });
  starts_.assign(owned() + 1, 0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const Part& part = parts[p];
    if (p == 0 || parts[p - 1].node != part.node || parts[p - 1].neighbour != part.neighbour) {
      neighbours_.push_back(part.neighbour);
      conductances_.push_back(0);
      starts_[part.node + 1] += 1;
    }
    const TemperaturePolynomial& conductivity = bodies[part.body].mesh->material().conductivity;
    if (conductivity.constant())
      conductances_.back() += conductivity(0) * part.factor;
    else
      shares_.push_back({part.body, part.element, conductances_.size() - 1, part.factor});
  }
  std::partial_sum(starts_.begin(), starts_.end(), starts_.begin());
}

std::size_t RigidNodes::bytes() const {
  return total() * (4 * sizeof(std::int32_t) + 3 * sizeof(double)) +
         neighbours_.capacity() * (sizeof(std::int32_t) + sizeof(double)) + shares_.capacity() * sizeof(Share) +
         received_.capacity() * sizeof(Received) + received_nodes_.capacity() * sizeof(NodeWeight) +
         touches_.capacity() * sizeof(Touch);
}

void RigidNodes::number_rows(const Comm& comm, std::size_t owned_particles) {
  first_row_ = comm.exclusive_sum(static_cast<std::int64_t>(owned_particles + owned()));
  row_base_ = comm.all_gather(std::vector<std::int64_t>{first_row_ + static_cast<std::int64_t>(owned_particles)});
}

void RigidNodes::begin_step(std::span<const RigidHeat> bodies) {
  start_.clear();
  input_.assign(owned(), 0.0);
  film_conductance_.assign(owned(), 0.0);
  film_source_.assign(owned(), 0.0);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (node_count_[b] == 0) continue;
    if (bodies[b].mesh)
      start_.insert(start_.end(), bodies[b].node_temperature.begin(), bodies[b].node_temperature.end());
    else
      start_.push_back(bodies[b].temperature);
  }
  STIRSPH_EXPECT(start_.size() == total(), "every node of a mesh has a temperature");
  for (std::size_t k = 0; k < owned(); ++k) {
    const RigidHeat& body = bodies[body_[mine_[k]]];
    const auto node = static_cast<std::size_t>(mine_[k] - first_node_[body_[mine_[k]]]);
    if (!body.node_input.empty()) input_[k] = body.node_input[node];
    if (body.mesh) {
      film_conductance_[k] = body.mesh->film_conductance(node);
      film_source_[k] = body.mesh->film_source(node);
    } else if (!fixed_[mine_[k]]) {
      film_conductance_[k] = body.ambient_conductance;
      film_source_[k] = body.ambient_conductance * body.ambient_temperature;
    }
  }
  end_ = start_;
  rise_.assign(total(), 0.0);
}

void RigidNodes::linearise(std::span<const RigidHeat> bodies, double implicit_share) {
  capacity_.resize(owned());
  for (std::size_t k = 0; k < owned(); ++k) {
    const std::int32_t g = mine_[k];
    const RigidHeat& body = bodies[body_[g]];
    if (body.mesh)
      capacity_[k] = body.mesh->node_mass(static_cast<std::size_t>(g - first_node_[body_[g]])) *
                     secant_specific_heat(body.mesh->material().specific_heat, start_[g], end_[g]);
    else
      capacity_[k] = fixed_[g] ? 1.0 : body.heat_capacity;
  }
  if (shares_.empty()) return;
  for (const Share& share : shares_) conductances_[share.link] = 0;
  for (const Share& share : shares_) {
    const HeatMesh& mesh = *bodies[share.body].mesh;
    const auto& nodes = mesh.mesh().elements[share.element];
    double mean = 0;
    for (int c = 0; c < mesh.mesh().corners(); ++c) {
      const std::int32_t g = first_node_[share.body] + nodes[c];
      mean += (start_[g] + implicit_share * (end_[g] - start_[g])) / mesh.mesh().corners();
    }
    conductances_[share.link] += share.factor * mesh.material().conductivity(mean);
  }
}

/// A message is a run of records: row, conductance, difference, heat, number of nodes, then node and weight of each.
void RigidNodes::receive_links(const Comm& comm, std::span<const RigidLink> links, std::span<const double> row,
                               std::span<const double> temperature) {
  std::vector<std::vector<double>> outgoing(static_cast<std::size_t>(comm.size()));
  std::vector<int> destinations;
  for (const RigidLink& link : links) {
    double difference = 0;
    destinations.clear();
    for (const NodeWeight& node : link.nodes) {
      difference += node.weight * (temperature[link.particle] - start_[node.node]);
      const int owner = owner_[node.node];
      if (std::find(destinations.begin(), destinations.end(), owner) == destinations.end())
        destinations.push_back(owner);
    }
    for (const int rank : destinations) {
      auto& message = outgoing[rank];
      message.insert(message.end(), {row[link.particle], link.conductance, difference, link.heat,
                                     static_cast<double>(link.nodes.size())});
      for (const NodeWeight& node : link.nodes) message.insert(message.end(), {double(node.node), node.weight});
    }
  }
  const std::vector<double> incoming = comm.exchange(outgoing);
  received_.clear();
  received_nodes_.clear();
  touch_starts_.assign(owned() + 1, 0);
  for (std::size_t at = 0; at < incoming.size();) {
    const auto count = static_cast<std::size_t>(incoming[at + 4]);
    received_.push_back({static_cast<std::int64_t>(incoming[at]), incoming[at + 1], incoming[at + 2], incoming[at + 3],
                         received_nodes_.size(), received_nodes_.size() + count});
    at += 5;
    for (std::size_t k = 0; k < count; ++k, at += 2) {
      const auto node = static_cast<std::int32_t>(incoming[at]);
      received_nodes_.push_back({node, incoming[at + 1]});
      if (owner_[node] == rank_) touch_starts_[local_[node] + 1] += 1;
    }
  }
  std::partial_sum(touch_starts_.begin(), touch_starts_.end(), touch_starts_.begin());
  touches_.resize(touch_starts_.back());
  std::vector<std::size_t> next(touch_starts_.begin(), touch_starts_.end() - 1);
  for (std::size_t l = 0; l < received_.size(); ++l)
    for (std::size_t k = received_[l].first; k < received_[l].last; ++k)
      if (const NodeWeight& node = received_nodes_[k]; owner_[node.node] == rank_)
        touches_[next[local_[node.node]]++] = {l, node.weight};
}

void RigidNodes::fill(HeatMatrixWriter& writer, std::span<double> right, double dt, double implicit_share) const {
  const double weight = implicit_share * dt;
  for (std::size_t k = 0; k < owned() && writer.fits(); ++k) {
    const std::int32_t g = mine_[k];
    writer.begin_row();
    if (fixed_[g]) {  // its rise is known to be zero: the row says so, and no other row refers to it
      writer.add_global(row(g), capacity_[k]);
      writer.end_row();
      right[k] = 0;
      continue;
    }
    double sum = film_conductance_[k], power = film_source_[k] - film_conductance_[k] * start_[g], heat = input_[k];
    for (std::size_t n = starts_[k]; n < starts_[k + 1]; ++n) {
      const std::int32_t other = neighbours_[n];
      sum += conductances_[n];
      power += conductances_[n] * (start_[other] - start_[g]);
      if (!fixed_[other]) writer.add_global(row(other), -weight * conductances_[n]);
    }
    for (std::size_t t = touch_starts_[k]; t < touch_starts_[k + 1]; ++t) {
      const Received& link = received_[touches_[t].link];
      const double share = touches_[t].weight, conductance = link.conductance * share;
      power += conductance * link.difference;
      heat += share * link.heat;
      if (!(link.conductance > 0)) continue;
      writer.add_global(link.row, -weight * conductance);
      for (std::size_t n = link.first; n < link.last; ++n)
        if (const NodeWeight& other = received_nodes_[n]; !fixed_[other.node])
          writer.add_global(row(other.node), weight * conductance * other.weight);
    }
    writer.add_global(row(g), capacity_[k] + weight * sum);
    writer.end_row();
    right[k] = heat + dt * power;
  }
}

std::pair<double, double> RigidNodes::update_end(const Comm& comm, std::span<const RigidHeat> bodies,
                                                 std::span<const double> heat, std::span<const double> rise) {
  std::vector<double> mine;
  for (std::size_t k = 0; k < owned(); ++k) {
    const std::int32_t g = mine_[k];
    const RigidHeat& body = bodies[body_[g]];
    double reached = start_[g];
    if (!fixed_[g])
      reached += body.mesh ? temperature_rise(body.mesh->material().specific_heat, start_[g],
                                              heat[k] / body.mesh->node_mass(g - first_node_[body_[g]]))
                           : heat[k] / body.heat_capacity;
    mine.insert(mine.end(), {reached, rise[k]});
  }
  const std::vector<double> all = comm.all_gather(mine);
  double change = 0, largest = 0;
  for (std::size_t n = 0; n < total(); ++n) {
    const std::int32_t g = gathered_order_[n];
    change = std::max(change, std::abs(all[2 * n] - end_[g]));
    largest = std::max(largest, std::abs(all[2 * n] - start_[g]));
    end_[g] = all[2 * n];
    rise_[g] = all[2 * n + 1];
  }
  return {change, largest};
}

std::vector<RigidNodes::Outflow> RigidNodes::outflow(std::span<const double> heat, double dt,
                                                     double implicit_share) const {
  std::vector<Outflow> result(node_count_.size());
  for (std::size_t k = 0; k < owned(); ++k) {
    const std::int32_t g = mine_[k];
    Outflow& body = result[body_[g]];
    body.sources += input_[k];
    if (!fixed_[g]) {
      body.gained += heat[k];
      body.film += dt * (film_conductance_[k] * between(g, implicit_share) - film_source_[k]);
      continue;
    }
    body.fixed += input_[k];
    for (std::size_t n = starts_[k]; n < starts_[k + 1]; ++n)
      body.fixed += dt * conductances_[n] * (between(neighbours_[n], implicit_share) - between(g, implicit_share));
  }
  return result;
}

void RigidNodes::finish_step(std::span<RigidHeat> bodies) const {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidHeat& body = bodies[b];
    if (node_count_[b] == 0) continue;
    if (!body.mesh) {
      body.temperature = end_[first_node_[b]];
      continue;
    }
    double capacity = 0, sum = 0;
    for (std::size_t n = 0; n < node_count_[b]; ++n) {
      body.node_temperature[n] = end_[first_node_[b] + n];
      const double c = body.mesh->node_mass(n) * body.mesh->material().specific_heat(body.node_temperature[n]);
      capacity += c;
      sum += c * body.node_temperature[n];
    }
    body.temperature = sum / capacity;
    std::fill(body.node_input.begin(), body.node_input.end(), 0.0);
  }
}

}  // namespace stirsph
