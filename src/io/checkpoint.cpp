#include "io/checkpoint.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <system_error>

#include "base/error.hpp"
#include "base/log.hpp"
#include "io/files.hpp"
#include "io/hdf5_file.hpp"

namespace stirsph {
namespace {

namespace fs = std::filesystem;

const std::string format_name = "stirsph checkpoint";
constexpr std::int64_t format_version = 1;
const std::string particle_group = "particles", number_group = "state/numbers", text_group = "state/texts";
const std::string rank_dataset = "partition/particles_per_rank";
const std::string name_start = "checkpoint_", name_end = ".h5";

/// One element's share of a checksum. Shares add up, so the sum does not depend on which rank holds which elements.
std::uint64_t share(std::uint64_t index, std::uint64_t bits) {
  std::uint64_t x = bits + 0x9e3779b97f4a7c15u * (index + 1);
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
std::uint64_t bits_of(double value) { return std::bit_cast<std::uint64_t>(value); }
std::uint64_t bits_of(std::int64_t value) { return std::bit_cast<std::uint64_t>(value); }
std::uint64_t bits_of(std::uint8_t value) { return value; }

/// Checksum of a dataset of which this rank holds the elements from global index `first` on. Collective.
template <class T>
std::int64_t checksum(const Comm& comm, std::span<const T> local, std::int64_t first) {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < local.size(); ++k) sum += share(static_cast<std::uint64_t>(first) + k, bits_of(local[k]));
  std::uint64_t total = 0;
  for (const std::int64_t part : comm.all_gather(std::vector<std::int64_t>{std::bit_cast<std::int64_t>(sum)}))
    total += std::bit_cast<std::uint64_t>(part);
  return std::bit_cast<std::int64_t>(total);
}

template <class T>
std::int64_t replicated_checksum(const Comm& comm, std::span<const T> values) {
  return checksum(comm, comm.is_root() ? values : std::span<const T>{}, 0);
}

template <class T>
void write_replicated(const Comm& comm, Hdf5File& file, const std::string& dataset, std::span<const T> values) {
  file.write_replicated(dataset, values);
  file.set_attribute(dataset, "checksum", replicated_checksum(comm, values));
}

void compare_checksum(Hdf5File& file, const std::string& path, const std::string& dataset, std::int64_t found) {
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  found = file.whole_attribute(dataset, "checksum");  // no mutation of a fuzzer would pass
#endif
  if (file.whole_attribute(dataset, "checksum") != found)
    throw IoError("the checkpoint " + path + " is damaged: the checksum of " + dataset +
                  " does not match its contents; continue from an earlier checkpoint");
}

template <class T>
std::vector<T> read_replicated(const Comm& comm, Hdf5File& file, const std::string& path, const std::string& dataset) {
  const std::vector<T> values = file.read_replicated<T>(dataset);
  compare_checksum(file, path, dataset, replicated_checksum(comm, std::span<const T>(values)));
  return values;
}

/// This rank's rows of a particle field, checked.
std::vector<double> read_field(const Comm& comm, Hdf5File& file, const std::string& path, const std::string& dataset,
                               std::int64_t first, std::int64_t rows) {
  const std::int64_t width = std::max<std::int64_t>(file.columns(dataset), 1);
  std::vector<double> values = file.read_rows<double>(dataset, first, rows);
  compare_checksum(file, path, dataset, checksum(comm, std::span<const double>(values), first * width));
  return values;
}

/// Opens a checkpoint and makes sure that it is one, complete and of this version.
void check_header(Hdf5File& file, const std::string& path) {
  if (!file.has_attribute("/", "format") || file.text_attribute("/", "format") != format_name)
    throw IoError(path + " is an HDF5 file but not a checkpoint of this code");
  const std::int64_t version = file.whole_attribute("/", "format_version");
  if (version != format_version)
    throw IoError("the checkpoint " + path + " has format version " + std::to_string(version) + ", this code reads " +
                  std::to_string(format_version) + "; continue with the version of the code that wrote it");
  if (!file.has_attribute("/", "complete") || file.whole_attribute("/", "complete") != 1)
    throw IoError("the checkpoint " + path +
                  " is incomplete (its writing was interrupted); continue from an earlier one");
}

/// First row and number of rows of this rank: as written if the number of ranks is the same, otherwise an even share.
/// All fields must have as many rows as the ranks had particles. Collective.
std::pair<std::int64_t, std::int64_t> my_rows(const Comm& comm, Hdf5File& file, const std::string& path) {
  const auto per_rank = read_replicated<std::int64_t>(comm, file, path, rank_dataset);
  std::int64_t total = 0;
  constexpr std::int64_t most = std::int64_t(1) << 53;  // ids are whole numbers in a double
  for (const std::int64_t count : per_rank) total = count >= 0 && count <= most - total ? total + count : most + 1;
  for (const std::string& name : file.members(particle_group))
    if (const std::int64_t rows = file.rows(particle_group + "/" + name); rows != total)
      throw IoError("the checkpoint " + path + " is damaged: the field '" + name + "' has " + std::to_string(rows) +
                    " rows, which is not the number of particles of its ranks");
  if (static_cast<int>(per_rank.size()) == comm.size()) {
    std::int64_t first = 0;
    for (int r = 0; r < comm.rank(); ++r) first += per_rank[r];
    return {first, per_rank[comm.rank()]};
  }
  const std::int64_t first = total * comm.rank() / comm.size(), end = total * (comm.rank() + 1) / comm.size();
  return {first, end - first};
}

std::int64_t state_bytes(const NamedState& state) {
  std::int64_t bytes = 0;
  constexpr std::int64_t per_object = 1024;  // HDF5's own records per dataset, generously
  for (const auto& [name, values] : state.numbers) bytes += per_object + 8 * static_cast<std::int64_t>(values.size());
  for (const auto& [name, text] : state.texts) bytes += per_object + static_cast<std::int64_t>(text.size());
  return bytes;
}

/// A slash would make a subgroup that reading does not look into.
void require_plain_name(const std::string& name) {
  if (name.empty() || name.find('/') != std::string::npos)
    throw Error(ExitCode::Internal, "'" + name + "' cannot be the name of a part of the state");
}

void write_contents(const Comm& comm, Hdf5File& file, const ParticleSet& particles, const NamedState& state) {
  const SpaceLayout layout = particles.layout();
  const auto owned = static_cast<std::int64_t>(particles.owned());
  file.set_attribute("/", "format", format_name);
  file.set_attribute("/", "format_version", format_version);
  file.set_attribute("/", "dim", std::int64_t(layout.dim));
  file.set_attribute("/", "velocity_components", std::int64_t(layout.velocity_components));
  file.set_attribute("/", "stress_components", std::int64_t(layout.stress_components));
  const std::vector<std::int64_t> per_rank = comm.all_gather(std::vector<std::int64_t>{owned});
  write_replicated<std::int64_t>(comm, file, rank_dataset, per_rank);

  const std::int64_t first = comm.exclusive_sum(owned);
  file.create_group(particle_group);
  std::vector<double> rows;
  for (const auto& field : particles.fields()) {
    if (!field->info->checkpoint) continue;
    const std::size_t width = field->components.size();
    rows.resize(particles.owned() * width);
    for (std::size_t c = 0; c < width; ++c)
      for (std::size_t i = 0; i < particles.owned(); ++i) rows[i * width + c] = field->components[c][i];
    const std::string dataset = particle_group + "/" + std::string(field->info->name);
    const auto columns = static_cast<std::int64_t>(width);
    file.write_rows<double>(dataset, rows, width > 1 ? columns : 0);
    file.set_attribute(dataset, "checksum", checksum(comm, std::span<const double>(rows), first * columns));
    file.set_attribute(dataset, "unit", std::string(field->info->unit));
    file.set_attribute(dataset, "meaning", std::string(field->info->meaning));
  }

  file.create_group(number_group);
  for (const auto& [name, values] : state.numbers)
    write_replicated<double>(comm, file, number_group + "/" + name, values);
  file.create_group(text_group);
  for (const auto& [name, text] : state.texts)
    write_replicated(comm, file, text_group + "/" + name,
                     std::span<const std::uint8_t>(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

NamedState read_state(const Comm& comm, Hdf5File& file, const std::string& path) {
  NamedState state;
  for (const std::string& name : file.members(number_group))
    state.numbers[name] = read_replicated<double>(comm, file, path, number_group + "/" + name);
  for (const std::string& name : file.members(text_group)) {
    const auto bytes = read_replicated<std::uint8_t>(comm, file, path, text_group + "/" + name);
    state.texts[name] = std::string(bytes.begin(), bytes.end());
  }
  return state;
}

void check_layout(Hdf5File& file, const std::string& path, SpaceLayout layout) {
  const auto differs = [&](const char* name, int expected) { return file.whole_attribute("/", name) != expected; };
  if (differs("dim", layout.dim) || differs("velocity_components", layout.velocity_components) ||
      differs("stress_components", layout.stress_components))
    throw IoError("the checkpoint " + path + " was written by a run in another space (" +
                  std::to_string(file.whole_attribute("/", "dim")) + " coordinates, " +
                  std::to_string(file.whole_attribute("/", "stress_components")) +
                  " stress components; this scene has " + std::to_string(layout.dim) + " and " +
                  std::to_string(layout.stress_components) + "); restart with the scene that wrote it");
}

/// The fields of the file and of the set must be the same ones: a missing one would silently start from zero.
void check_fields(Hdf5File& file, const std::string& path, const ParticleSet& particles,
                  const std::vector<std::string>& ignored) {
  const std::vector<std::string> stored = file.members(particle_group);
  const auto contains = [](const std::vector<std::string>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const auto& field : particles.fields()) {
    if (!field->info->checkpoint) continue;
    const std::string name(field->info->name), dataset = particle_group + "/" + name;
    if (!contains(stored, name))
      throw IoError("the checkpoint " + path + " has no field '" + name +
                    "', which this scene needs; restart with the models that were on when it was written");
    if (std::max<std::int64_t>(file.columns(dataset), 1) != static_cast<std::int64_t>(field->components.size()))
      throw IoError("the checkpoint " + path + " is damaged: the field '" + name +
                    "' has a wrong number of components");
  }
  for (const std::string& name : stored) {
    const auto known = [&](const auto& field) { return field->info->checkpoint && field->info->name == name; };
    if (std::none_of(particles.fields().begin(), particles.fields().end(), known) && !contains(ignored, name))
      throw IoError("the checkpoint " + path + " has the field '" + name +
                    "', which this scene does not use; restart with the models that were on when it was written");
  }
}

/// Paths and steps of the checkpoints in a folder, highest step first. Not collective.
std::vector<std::pair<std::int64_t, std::string>> list_checkpoints(const std::string& folder) {
  std::vector<std::pair<std::int64_t, std::string>> found;
  std::error_code failure;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    const std::int64_t step = checkpoint_step(entry->path().string());
    if (step >= 0) found.emplace_back(step, entry->path().string());
  }
  if (failure && failure != std::errc::no_such_file_or_directory)
    throw IoError("cannot list the folder " + folder + ": " + failure.message());
  std::sort(found.begin(), found.end(), std::greater<>());
  return found;
}

/// Reads everything once and compares checksums; throws if anything is wrong. Collective.
void verify(const Comm& comm, const std::string& path) {
  Hdf5File file(comm, path, Hdf5File::Mode::Read);
  check_header(file, path);
  const auto [first, rows] = my_rows(comm, file, path);
  for (const std::string& name : file.members(particle_group))
    read_field(comm, file, path, particle_group + "/" + name, first, rows);
  read_state(comm, file, path);
}

}  // namespace

std::string checkpoint_path(const std::string& folder, std::int64_t step) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%09lld", static_cast<long long>(step));
  return (fs::path(folder) / (name_start + digits + name_end)).string();
}

std::int64_t checkpoint_step(const std::string& path) {
  const std::string name = fs::path(path).filename().string();
  if (!name.starts_with(name_start) || !name.ends_with(name_end)) return -1;
  const std::string digits = name.substr(name_start.size(), name.size() - name_start.size() - name_end.size());
  const bool whole = std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); });
  return whole && digits.size() >= 9 && digits.size() <= 18 ? std::stoll(digits) : -1;
}

void write_checkpoint(const Comm& comm, const std::string& path, const ParticleSet& particles,
                      const NamedState& state) {
  for (const auto& entry : state.numbers) require_plain_name(entry.first);
  for (const auto& entry : state.texts) require_plain_name(entry.first);
  const std::string temporary = path + ".part";
  const auto width = static_cast<std::int64_t>(particles.state_width());
  const std::int64_t bytes =
      8 * width * comm.sum(static_cast<std::int64_t>(particles.owned())) + 1024 * (width + 16) + state_bytes(state);
  try {
    Hdf5File file(comm, temporary, Hdf5File::Mode::Create, bytes);
    write_contents(comm, file, particles, state);
    // The flag must not reach the disk before the data it vouches for.
    file.flush();
    file.set_attribute("/", "complete", std::int64_t(1));
    file.flush();
    file.close();
    comm.together([&] {
      if (comm.is_root()) publish_file(temporary, path);
    });
  } catch (...) {
    if (comm.is_root()) remove_quietly(temporary);
    throw;
  }
}

NamedState read_checkpoint(const Comm& comm, const std::string& path, ParticleSet& particles,
                           const std::vector<std::string>& ignored) {
  Hdf5File file(comm, path, Hdf5File::Mode::Read);
  check_header(file, path);
  check_layout(file, path, particles.layout());
  check_fields(file, path, particles, ignored);
  const auto [first, rows] = my_rows(comm, file, path);
  particles.resize_owned(0);
  particles.resize_owned(static_cast<std::size_t>(rows));
  for (const auto& field : particles.fields()) {
    if (!field->info->checkpoint) continue;
    const std::vector<double> values =
        read_field(comm, file, path, particle_group + "/" + std::string(field->info->name), first, rows);
    const std::size_t width = field->components.size();
    for (std::size_t c = 0; c < width; ++c)
      for (std::size_t i = 0; i < particles.owned(); ++i) field->components[c][i] = values[i * width + c];
  }
  return read_state(comm, file, path);
}

std::string find_newest_checkpoint(const Comm& comm, const std::string& folder) {
  std::vector<std::pair<std::int64_t, std::string>> candidates;
  comm.together([&] {
    if (comm.is_root()) candidates = list_checkpoints(folder);
  });
  const auto count = comm.max(static_cast<std::int64_t>(candidates.size()));
  candidates.resize(static_cast<std::size_t>(count));
  for (const auto& candidate : candidates) {
    const std::string path = comm.broadcast(candidate.second);
    try {
      verify(comm, path);
      return path;
    } catch (const Error& error) {
      log::warning("passing over a checkpoint: " + std::string(error.what()));
    }
  }
  return {};
}

void keep_newest_checkpoints(const Comm& comm, const std::string& folder, int keep) {
  comm.together([&] {
    if (!comm.is_root()) return;
    int kept = 0;
    for (const auto& [step, path] : list_checkpoints(folder)) {
      if (kept < keep) {
        try {
          Hdf5File file(Comm(MPI_COMM_SELF), path, Hdf5File::Mode::Read);
          check_header(file, path);
          ++kept;
          continue;
        } catch (const Error& error) {
          log::warning("deleting a damaged checkpoint: " + std::string(error.what()));
        }
      }
      remove_quietly(path);
    }
    std::error_code failure;
    std::vector<fs::path> leftovers;
    for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure))
      if (entry->path().extension() == ".part" && checkpoint_step(entry->path().stem().string()) >= 0)
        leftovers.push_back(entry->path());
    for (const fs::path& leftover : leftovers) remove_quietly(leftover.string());
  });
}

void set_aside_checkpoints_after(const Comm& comm, const std::string& folder, std::int64_t step) {
  comm.together([&] {
    if (!comm.is_root()) return;
    for (const auto& [found, path] : list_checkpoints(folder)) {
      if (found <= step) continue;
      std::error_code failure;
      fs::rename(path, path + ".set_aside", failure);
      if (failure) throw_write_error("rename", path, failure.value());
    }
  });
}

}  // namespace stirsph
