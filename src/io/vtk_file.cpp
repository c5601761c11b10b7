#include "io/vtk_file.hpp"

#include <vector>

#include "io/files.hpp"

namespace stirsph::vtk {

void describe(Hdf5File& file, const std::string& dataset, std::string_view unit, std::string_view meaning) {
  file.set_attribute(dataset, "unit", std::string(unit));
  file.set_attribute(dataset, "meaning", std::string(meaning));
}

void write_counts(Hdf5File& file, std::int64_t points, std::int64_t cells, std::int64_t connectivity) {
  const auto put = [&](const char* name, std::int64_t count) {
    file.write_replicated<std::int64_t>(group + "/" + name, std::vector<std::int64_t>{count});
  };
  put("NumberOfPoints", points);
  put("NumberOfCells", cells);
  put("NumberOfConnectivityIds", connectivity);
}

void write_file(const Comm& comm, const std::string& path, double time, std::int64_t step, std::int64_t expected_bytes,
                const std::function<void(Hdf5File&)>& fill) {
  const std::string temporary = path + ".part";
  try {
    Hdf5File file(comm, temporary, Hdf5File::Mode::Create, expected_bytes);
    file.create_group(group);
    file.set_attribute(group, "Version", std::vector<std::int64_t>{1, 0});
    file.set_attribute(group, "Type", "UnstructuredGrid");
    file.set_attribute(group, "time", time);
    file.set_attribute(group, "step", step);
    fill(file);
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

}  // namespace stirsph::vtk
