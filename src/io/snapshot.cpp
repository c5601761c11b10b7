#include "io/snapshot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string_view>

#include "base/error.hpp"
#include "base/tensor.hpp"
#include "io/files.hpp"
#include "io/vtk_file.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

namespace fs = std::filesystem;

/// Fields whose values name something; single precision would merge large ones.
bool holds_whole_numbers(std::string_view name) {
  constexpr std::array names{field::id.name, field::body.name, field::material.name, field::sets.name,
                             field::recrystallised.name};
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string name_of(const std::string& path) { return fs::path(path).filename().string(); }

std::string exact(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.15g", value);
  return text;
}

/// One line of ParaView's index of a series.
void add_to_series(std::string& lines, const std::string& name, const std::string& time) {
  lines += (lines.empty() ? "\n" : ",\n") + ("    {\"name\": \"" + name + "\", \"time\": " + time + "}");
}

void write_series(const std::string& path, const std::string& lines) {
  write_text_file(path, "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [" + lines + "\n  ]\n}\n");
}

/// Rows of `width` floats; column k of a row is the field's component source[k], missing components are zero.
std::vector<float> rows_of(const Field& field, std::size_t owned, const std::vector<std::size_t>& source) {
  const std::size_t width = source.size();
  std::vector<float> rows(owned * width, 0.0F);
  for (std::size_t k = 0; k < width; ++k) {
    if (source[k] >= field.components.size()) continue;
    const AlignedVector& values = field.components[source[k]];
    for (std::size_t i = 0; i < owned; ++i) rows[i * width + k] = static_cast<float>(values[i]);
  }
  return rows;
}

/// Which component of a field VTK expects in each column.
std::vector<std::size_t> vtk_columns(Shape shape, const SpaceLayout& layout) {
  if (shape == Shape::Scalar) return {0};
  if (shape == Shape::Position) {
    std::vector<std::size_t> columns(3, std::size_t(layout.dim));  // no such component: zero
    for (int c = 0; c < layout.dim; ++c) columns[std::size_t(layout.axes[c])] = std::size_t(c);
    return columns;
  }
  if (shape == Shape::SymmetricTensor)
    return {0,
            1,
            2,
            std::size_t(symmetric_index(0, 1)),
            std::size_t(symmetric_index(1, 2)),
            std::size_t(symmetric_index(0, 2))};
  return {0, 1, 2};
}

void write_grid(const Comm& comm, Hdf5File& file, const ParticleSet& particles) {
  const std::size_t owned = particles.owned();
  const auto count = static_cast<std::int64_t>(owned);
  const std::int64_t total = comm.sum(count);
  vtk::write_counts(file, total, total, total);

  std::vector<float> points(3 * owned);
  for (std::size_t i = 0; i < owned; ++i)
    for (int c = 0; c < 3; ++c)
      points[3 * i + std::size_t(c)] = static_cast<float>(particles.vector_at(field::position, i)[c]);
  file.write_rows<float>(vtk::group + "/Points", points, 3);
  vtk::describe(file, vtk::group + "/Points", field::position.unit, field::position.meaning);

  // Cell k is the vertex k. There is one more offset than there are cells: the end of the last one.
  std::vector<std::int64_t> numbers(owned);
  std::iota(numbers.begin(), numbers.end(), comm.exclusive_sum(count));
  file.write_rows<std::int64_t>(vtk::group + "/Connectivity", numbers);
  if (comm.rank() == comm.size() - 1) numbers.push_back(total);
  file.write_rows<std::int64_t>(vtk::group + "/Offsets", numbers);
  file.write_rows<std::uint8_t>(vtk::group + "/Types", std::vector<std::uint8_t>(owned, vtk::vertex));
}

void write_field(Hdf5File& file, const ParticleSet& particles, const Field& field) {
  const std::string dataset = vtk::point_data + "/" + std::string(field.info->name);
  const std::size_t owned = particles.owned();
  if (holds_whole_numbers(field.info->name)) {
    std::vector<std::int64_t> values(owned);
    for (std::size_t i = 0; i < owned; ++i) values[i] = std::llround(field.components[0][i]);
    file.write_rows<std::int64_t>(dataset, values);
  } else {
    const std::vector<std::size_t> columns = vtk_columns(field.info->shape, particles.layout());
    const auto width = static_cast<std::int64_t>(columns.size());
    file.write_rows<float>(dataset, rows_of(field, owned, columns), width > 1 ? width : 0);
  }
  vtk::describe(file, dataset, field.info->unit, field.info->meaning);
}

}  // namespace

std::string snapshot_path(const std::string& folder, int number) {
  char name[64];
  std::snprintf(name, sizeof name, "snapshot_%06d.vtkhdf", number);
  return (fs::path(folder) / name).string();
}

SnapshotSeries::SnapshotSeries(const Comm& comm, const std::string& folder, const std::vector<std::string>& fields,
                               std::string_view also)
    : comm_(comm), folder_(folder), fields_(fields), also_(also) {}

bool SnapshotSeries::selected(const FieldInfo& info) const {
  if (info.name == field::position.name) return false;  // it is the geometry
  if (info.name == also_) return true;
  if (fields_.empty()) return info.snapshot;
  return std::find(fields_.begin(), fields_.end(), info.name) != fields_.end();
}

void SnapshotSeries::resume(double time, double time_tolerance) {
  entries_.clear();
  std::vector<std::int64_t> steps, with_rigid;
  std::vector<double> times;
  comm_.together([&] {
    if (!comm_.is_root()) return;
    std::ifstream index(fs::path(folder_) / "snapshots.csv");
    std::string line;
    std::getline(index, line);  // header
    while (std::getline(index, line)) {
      int number = 0;
      long long step = 0;
      double at = 0;
      if (std::sscanf(line.c_str(), "%d,%lld,%lf", &number, &step, &at) != 3 ||
          number != static_cast<int>(steps.size()))
        throw IoError("cannot continue " + folder_ + "/snapshots.csv: the line '" + line +
                      "' is not one this code wrote; move the file away to start a new series");
      if (at > time + time_tolerance) break;
      steps.push_back(step);
      times.push_back(at);
      with_rigid.push_back(line.ends_with("," + name_of(rigid_snapshot_path(folder_, number))));
    }
  });
  comm_.broadcast(steps);
  comm_.broadcast(times);
  comm_.broadcast(with_rigid);
  for (std::size_t k = 0; k < steps.size(); ++k) entries_.push_back({steps[k], times[k], with_rigid[k] != 0});
  write_index();
}

void SnapshotSeries::check_names(const ParticleSet& particles, const std::vector<DerivedField>& derived) const {
  for (const std::string& name : fields_) {
    const auto named = [&](const auto& field) { return field->info->name == name; };
    const auto derived_named = [&](const DerivedField& field) { return field.name == name; };
    if (std::none_of(particles.fields().begin(), particles.fields().end(), named) &&
        std::none_of(derived.begin(), derived.end(), derived_named))
      throw InputError("the scene asks for the field '" + name + "' in snapshots, but no model of it has that field");
  }
}

std::string SnapshotSeries::write(const ParticleSet& particles, double time, std::int64_t step,
                                  const std::vector<DerivedField>& derived, const std::vector<MeshState>& rigid) {
  comm_.together([&] { check_names(particles, derived); });
  const std::string path = snapshot_path(folder_, next());
  // 8 bytes per value are more than enough, and this much room is only asked for, not used.
  const auto columns = static_cast<std::int64_t>(particles.state_width() + derived.size()) + 16;
  const std::int64_t bytes = 8 * columns * comm_.sum(static_cast<std::int64_t>(particles.owned())) + 1024 * columns;
  vtk::write_file(comm_, path, time, step, bytes, [&](Hdf5File& file) {
    write_grid(comm_, file, particles);
    file.create_group(vtk::point_data);
    for (const auto& field : particles.fields())
      if (selected(*field->info)) write_field(file, particles, *field);
    for (const DerivedField& field : derived) {
      STIRSPH_EXPECT(field.values.size() == particles.owned(), "a derived field has one value per owned particle");
      const std::string dataset = vtk::point_data + "/" + field.name;
      file.write_rows<float>(dataset, std::vector<float>(field.values.begin(), field.values.end()));
      vtk::describe(file, dataset, field.unit, field.meaning);
    }
  });
  if (!rigid.empty()) write_rigid_snapshot(comm_, rigid_snapshot_path(folder_, next()), rigid, time, step);
  entries_.push_back({step, time, !rigid.empty()});
  write_index();
  return path;
}

void SnapshotSeries::write_index() const {
  comm_.together([&] {
    if (!comm_.is_root()) return;
    std::string table = "number,step,time [s],file,rigid file\n", particle_series, rigid_series;
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      const Entry& entry = entries_[k];
      const std::string time = exact(entry.time), name = name_of(snapshot_path(folder_, static_cast<int>(k)));
      const std::string rigid = entry.rigid ? name_of(rigid_snapshot_path(folder_, static_cast<int>(k))) : "";
      table += std::to_string(k) + "," + std::to_string(entry.step) + "," + time + "," + name + "," + rigid + "\n";
      add_to_series(particle_series, name, time);
      if (entry.rigid) add_to_series(rigid_series, rigid, time);
    }
    const fs::path folder(folder_);
    write_text_file((folder / "snapshots.csv").string(), table);
    write_series((folder / "snapshots.vtkhdf.series").string(), particle_series);
    const std::string rigid_index = (folder / "rigid.vtkhdf.series").string();
    if (rigid_series.empty())
      remove_quietly(rigid_index);  // one of an earlier run in this folder would show bodies that are not there
    else
      write_series(rigid_index, rigid_series);
  });
}

}  // namespace stirsph
