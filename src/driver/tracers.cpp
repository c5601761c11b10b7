#include "driver/tracers.hpp"

#include <algorithm>
#include <numeric>

#include "driver/mixing.hpp"
#include "driver/particle_values.hpp"
#include "driver/probes.hpp"
#include "particles/field_names.hpp"

namespace stirsph {

Tracer::Tracer(const TracerScene& scene, std::string folder)
    : scene_(scene), path_(std::move(folder) + "/tracer_" + scene.name + ".csv"), schedule_(scene.interval) {}

std::vector<std::string> Tracer::fields_of(const Simulation& simulation) const {
  if (!scene_.fields.empty()) return scene_.fields;
  std::vector<std::string> fields;
  for (const FieldInfo* info : {&field::material, &field::temperature, &field::equivalent_plastic_strain})
    if (simulation.particles().has(*info)) fields.emplace_back(info->name);
  return fields;
}

std::vector<HistoryColumn> Tracer::columns(const Simulation& simulation) const {
  std::vector<HistoryColumn> columns{{"id", "1"}, {"x", "m"}, {"y", "m"}, {"z", "m"}};
  for (const std::string& name : fields_of(simulation)) columns.push_back({name, unit_of(simulation.scene(), name)});
  return columns;
}

void Tracer::begin(const Simulation& simulation) {
  const Comm& comm = simulation.comm();
  comm.together([&] { file_ = History::begin(comm.is_root(), path_, columns(simulation)); });
  record(simulation);
  schedule_.begin(simulation.clock());
}

void Tracer::resume(const Simulation& simulation) {
  const Comm& comm = simulation.comm();
  comm.together([&] { file_ = History::resume(comm.is_root(), path_, columns(simulation), simulation.clock().time); });
  schedule_.begin(simulation.clock());
}

void Tracer::after_step(const Simulation& simulation) {
  if (schedule_.due(simulation.clock())) record(simulation);
}

void Tracer::record(const Simulation& simulation) {
  const ParticleSet& particles = simulation.particles();
  std::vector<std::function<double(std::size_t)>> values;
  for (const std::string& name : fields_of(simulation)) values.push_back(particle_value(simulation, name));
  const std::size_t width = 4 + values.size();

  std::vector<double> rows;
  for (std::size_t i = 0; i < particles.owned(); ++i) {
    if (!in_set(particles, scene_.set, i)) continue;
    const Vec3 x = particles.vector_at(field::position, i);
    rows.insert(rows.end(), {particles[field::id][i], x.x, x.y, x.z});
    for (const auto& value : values) rows.push_back(value(i));
  }
  const Comm& comm = simulation.comm();
  rows = comm.gather(rows);
  std::vector<std::size_t> order(rows.size() / width);
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::sort(order, {}, [&](std::size_t k) { return rows[k * width]; });
  std::vector<double> sorted;
  for (std::size_t k = 0; k < order.size(); k += static_cast<std::size_t>(scene_.every_nth))
    sorted.insert(sorted.end(), rows.begin() + static_cast<std::ptrdiff_t>(order[k] * width),
                  rows.begin() + static_cast<std::ptrdiff_t>((order[k] + 1) * width));
  comm.together([&] { file_.write(simulation.clock().time, sorted); });
}

}  // namespace stirsph
