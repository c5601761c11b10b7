#include "driver/partition_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/timer.hpp"
#include "driver/step_cost.hpp"
#include "io/files.hpp"
#include "mechanics/mechanics.hpp"
#include "neighbours/cluster_order.hpp"
#include "particles/field_names.hpp"
#include "scene/populate.hpp"

namespace stirsph {
namespace {

/// The particles of one part as its rank would hold them.
struct Part {
  explicit Part(SpaceLayout layout) : particles(layout) {
    particles.add(field::id);
    particles.add(field::position);
  }
  std::vector<std::int32_t> members;  ///< indices in the set of all particles, in the part's own order
  ParticleSet particles;
  std::vector<Vec3> copies;  ///< positions of the halo copies it receives [m]
};

void copy_members(const ParticleSet& all, Part& part) {
  part.particles.resize_owned(part.members.size());
  for (std::size_t k = 0; k < part.members.size(); ++k) {
    part.particles[field::id][k] = all[field::id][part.members[k]];
    for (int d = 0; d < all.layout().dim; ++d)
      part.particles.component(field::position, d)[k] = all.component(field::position, d)[part.members[k]];
  }
}

void put_in_order(Part& part) {
  const std::vector<std::int32_t> order = cluster_order(part.particles);
  part.particles.reorder(order);
  std::vector<std::int32_t> members(order.size());
  std::transform(order.begin(), order.end(), members.begin(), [&](std::int32_t k) { return part.members[k]; });
  part.members = std::move(members);
}

/// Counts the pair list of the part; `work`: cost of each particle, which a run balances.
void count_work(const Scene& scene, Part& part, double reach, PartShare& share, std::vector<double>& work) {
  ParticleSet& particles = part.particles;
  particles.resize_halo(part.copies.size());
  for (std::size_t k = 0; k < part.copies.size(); ++k)
    for (int d = 0; d < particles.layout().dim; ++d)
      particles.component(field::position, d)[particles.owned() + k] = part.copies[k][d];
  PairList pairs;
  pairs.build(particles, reach);
  share.candidates = static_cast<std::int64_t>(pairs.size());
  const std::vector<double> costs = particle_costs(scene, particles, pairs, nullptr, {});
  for (std::size_t k = 0; k < costs.size(); ++k) {
    work[part.members[k]] = costs[k];
    share.cost += costs[k];
  }
}

/// Cuts by `work` (one per particle, empty for equal ones), counts the shares and renews `work`.
Partition cut(const Comm& comm, const Scene& scene, const ParticleSet& all, double reach, int part_count,
              std::vector<double>& work) {
  CellTable cells(comm, all, scene.domain, reach, work);
  Partition partition;
  partition.parts = part_count;
  partition.by_work = !work.empty();
  const double start = wall_seconds();
  const std::vector<int> owners = partition_cells(comm, cells, part_count);
  partition.metis_seconds = wall_seconds() - start;
  cells.set_owners(owners);

  std::vector<Part> parts;
  for (int p = 0; p < part_count; ++p) parts.emplace_back(all.layout());
  for (std::size_t i = 0; i < all.owned(); ++i)
    parts[owners[cells.particle_cells()[i]]].members.push_back(static_cast<std::int32_t>(i));
  partition.shares.resize(part_count);
  for (Part& part : parts) copy_members(all, part);
  work.resize(all.owned());
  const double listing = wall_seconds();
  for (int p = 0; p < part_count; ++p) {
    put_in_order(parts[p]);
    PartShare& share = partition.shares[p];
    share.particles = static_cast<std::int64_t>(parts[p].members.size());
    for (const auto& [to, copies] : plan_halo(parts[p].particles, cells, reach, p)) {
      share.sent += static_cast<std::int64_t>(copies.sent.size());
      partition.shares[to].received += static_cast<std::int64_t>(copies.sent.size());
      if (to != p) {
        share.destinations += 1;
        partition.shares[to].sources += 1;
      }
      for (std::size_t k = 0; k < copies.sent.size(); ++k) {
        Vec3 place;
        for (int d = 0; d < all.layout().dim; ++d)
          place[d] = copies.images[k].coordinate(parts[p].particles.component(field::position, d)[copies.sent[k]], d);
        parts[to].copies.push_back(place);
      }
    }
  }
  for (int p = 0; p < part_count; ++p) count_work(scene, parts[p], reach, partition.shares[p], work);
  partition.list_seconds = (wall_seconds() - listing) / part_count;
  return partition;
}

std::int64_t bytes_of_copy(const ParticleSet& particles, Halo role) {
  std::size_t components = 0;
  for (const auto& field : particles.fields())
    if (field->info->halo == role) components += field->components.size();
  return static_cast<std::int64_t>(components * sizeof(double));
}

/// Of three: other work on the machine must not decide.
template <class Work>
double median_seconds(Work&& work) {
  std::array<double, 3> seconds{};
  for (double& time : seconds) {
    const double start = wall_seconds();
    work();
    time = wall_seconds() - start;
  }
  std::ranges::sort(seconds);
  return seconds[1];
}

/// The part of a rebuild that does not become smaller with more ranks: one particle in every cell shows it.
double measure_table(const Comm& comm, const Scene& scene, const ParticleSet& all, double reach) {
  const CellTable cells(comm, all, scene.domain, reach);
  Part sample(all.layout());
  sample.members.resize(cells.keys().size());
  for (std::size_t i = 0; i < all.owned(); ++i)
    sample.members[cells.particle_cells()[i]] = static_cast<std::int32_t>(i);
  copy_members(all, sample);
  return median_seconds([&] { Decomposition(comm).redistribute(sample.particles, scene.domain, reach, false, {}); });
}

template <class Value>
std::pair<double, double> largest_and_mean(const Partition& partition, Value&& value) {
  double largest = 0, sum = 0;
  for (const PartShare& share : partition.shares) {
    largest = std::max(largest, static_cast<double>(value(share)));
    sum += static_cast<double>(value(share));
  }
  return {largest, sum / static_cast<double>(partition.shares.size())};
}

}  // namespace

double Partition::imbalance() const {
  const auto [largest, mean] = largest_and_mean(*this, [](const PartShare& share) { return share.cost; });
  return mean > 0 ? largest / mean : 1.0;
}

PartitionStudy study_partitions(const Scene& scene, const std::vector<int>& part_counts) {
  const Comm comm(MPI_COMM_SELF);
  ParticleSet all(layout_of(scene.space));
  Neighbourhood::add_fields(all);
  double support = scene.numerics.h_over_dx * scene.numerics.spacing * kernel_support(scene.numerics.kernel);
  if (scene.mechanics) {
    const auto mechanics = make_mechanics(scene.space, scene.numerics, scene.materials);
    mechanics->add_fields(all);
    populate(scene, comm, all);
    mechanics->initialise(all);
    support = mechanics->support(all);
  } else {
    populate(scene, comm, all);
  }
  PartitionStudy study;
  study.particles = static_cast<std::int64_t>(all.owned());
  study.repartition_imbalance = scene.repartition_imbalance;
  study.kinematic_bytes = bytes_of_copy(all, Halo::Kinematic);
  study.stress_bytes = bytes_of_copy(all, Halo::Stress);

  const double skin = scene.skin * scene.numerics.spacing, reach = support + skin;
  {
    Neighbourhood neighbourhood(comm, scene.domain, skin);
    neighbourhood.rebuild(all, support, true);  // from now on particles are in order, as they are in a run
    study.rebuild_seconds = median_seconds([&] { neighbourhood.rebuild(all, support, false); });
  }
  all.resize_halo(0);
  study.cells = static_cast<std::int64_t>(CellTable(comm, all, scene.domain, reach).keys().size());
  study.table_seconds = measure_table(comm, scene, all, reach);

  for (const int part_count : part_counts) {
    std::vector<double> work;
    study.partitions.push_back(cut(comm, scene, all, reach, part_count, work));
    if (study.partitions.back().imbalance() > scene.repartition_imbalance)
      study.partitions.back() = cut(comm, scene, all, reach, part_count, work);
  }
  return study;
}

void report_partitions(const Comm& comm, const Scene& scene, const std::vector<int>& part_counts,
                       const std::string& file) {
  comm.together([&] {
    if (!comm.is_root()) return;
    const PartitionStudy study = study_partitions(scene, part_counts);
    if (!file.empty()) write_text_file(file, partition_csv(study));
    fmt::print("{}", partition_table(study));
  });
}

std::string partition_table(const PartitionStudy& study) {
  std::string text = fmt::format(
      "{} particles in {} cells; a halo copy takes {} B after the drift and {} B after the stress update;\n"
      "a list rebuild on one rank takes {:.3g} s, of which {:.3g} s are for the table of cells and stay on every "
      "rank\n",
      study.particles, study.cells, study.kinematic_bytes, study.stress_bytes, study.rebuild_seconds,
      study.table_seconds);
  text += fmt::format("{:>6} {:>20} {:>10} {:>20} {:>16} {:>14} {:>9}\n", "parts", "particles of a part", "work",
                      "halo copies of one", "neighbour parts", "MB per step", "METIS [s]");
  text += fmt::format("{:>6} {:>20} {:>10} {:>20} {:>16} {:>14} {:>9}\n", "", "most, mean", "most/mean", "most, mean",
                      "most, mean", "most received", "");
  bool uneven = false;
  for (const Partition& partition : study.partitions) {
    const auto [particles, particles_mean] =
        largest_and_mean(partition, [](const PartShare& share) { return share.particles; });
    const auto [halo, halo_mean] = largest_and_mean(partition, [](const PartShare& share) { return share.received; });
    const auto [sources, sources_mean] =
        largest_and_mean(partition, [](const PartShare& share) { return share.sources; });
    const bool over = partition.imbalance() > study.repartition_imbalance;
    uneven |= over;
    text += fmt::format(
        "{:>6} {:>20} {:>10} {:>20} {:>16} {:>14.4g} {:>9.3g}\n", partition.parts,
        fmt::format("{:.0f}, {:.1f}", particles, particles_mean),
        fmt::format("{:.3f}{}", partition.imbalance(), over ? " !" : "  "),
        fmt::format("{:.0f}, {:.1f}", halo, halo_mean), fmt::format("{:.0f}, {:.1f}", sources, sources_mean),
        1e-6 * halo * static_cast<double>(study.kinematic_bytes + study.stress_bytes), partition.metis_seconds);
  }
  if (uneven)
    text += fmt::format(
        "! more uneven than numerics.repartition_imbalance = {} even after a cut by work: a cell is the smallest piece "
        "that moves,\n  and parts of few cells cannot be even\n",
        study.repartition_imbalance);
  return text;
}

std::string partition_csv(const PartitionStudy& study) {
  std::string text = fmt::format(
      "# particles={}\n# cells={}\n# repartition_imbalance={}\n# kinematic_bytes={}\n# stress_bytes={}\n"
      "# rebuild_s={:.6g}\n# table_s={:.6g}\n",
      study.particles, study.cells, study.repartition_imbalance, study.kinematic_bytes, study.stress_bytes,
      study.rebuild_seconds, study.table_seconds);
  for (const Partition& partition : study.partitions)
    text += fmt::format("# metis_s[{0}]={1:.6g}\n# list_s[{0}]={2:.6g}\n", partition.parts, partition.metis_seconds,
                        partition.list_seconds);
  text += "parts,part,particles,candidates,sent,received,destinations,sources\n";
  for (const Partition& partition : study.partitions)
    for (std::size_t p = 0; p < partition.shares.size(); ++p) {
      const PartShare& share = partition.shares[p];
      text += fmt::format("{},{},{},{},{},{},{},{}\n", partition.parts, p, share.particles, share.candidates,
                          share.sent, share.received, share.destinations, share.sources);
    }
  return text;
}

}  // namespace stirsph
