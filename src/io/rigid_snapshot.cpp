#include "io/rigid_snapshot.hpp"

#include <cstdio>
#include <filesystem>

#include "base/error.hpp"
#include "io/vtk_file.hpp"
#include "particles/field_names.hpp"

namespace stirsph {
namespace {

/// The arrays of the file.
struct Grid {
  std::vector<float> points, temperature;
  std::vector<std::int64_t> connectivity, offsets{0}, body;
  std::vector<std::uint8_t> types;

  std::int64_t bytes() const {
    return static_cast<std::int64_t>(4 * (points.size() + temperature.size()) +
                                     8 * (connectivity.size() + offsets.size() + body.size()) + types.size());
  }
};

void append(Grid& grid, const MeshState& state) {
  const SimplexMesh& mesh = *state.mesh;
  STIRSPH_EXPECT(state.points.size() == mesh.nodes.size() && state.temperature.size() == mesh.nodes.size(),
                 "a meshed body has one place and one temperature per node");
  const auto first = static_cast<std::int64_t>(grid.temperature.size());
  for (const Vec3& x : state.points)
    for (int c = 0; c < 3; ++c) grid.points.push_back(static_cast<float>(x[c]));
  grid.temperature.insert(grid.temperature.end(), state.temperature.begin(), state.temperature.end());
  for (const auto& element : mesh.elements) {
    for (int c = 0; c < mesh.corners(); ++c) grid.connectivity.push_back(first + element[c]);
    grid.offsets.push_back(std::ssize(grid.connectivity));
    grid.types.push_back(mesh.dim == 3 ? vtk::tetrahedron : vtk::triangle);
    grid.body.push_back(state.body);
  }
}

void write_grid(Hdf5File& file, const Grid& grid) {
  vtk::write_counts(file, std::ssize(grid.temperature), std::ssize(grid.types), std::ssize(grid.connectivity));
  const std::string points = vtk::group + "/Points", temperature = vtk::point_data + "/temperature",
                    body = vtk::cell_data + "/body";
  file.write_replicated<float>(points, grid.points, 3);
  vtk::describe(file, points, field::position.unit, "position of the node");
  file.write_replicated<std::int64_t>(vtk::group + "/Connectivity", grid.connectivity);
  file.write_replicated<std::int64_t>(vtk::group + "/Offsets", grid.offsets);
  file.write_replicated<std::uint8_t>(vtk::group + "/Types", grid.types);
  file.write_replicated<float>(temperature, grid.temperature);
  vtk::describe(file, temperature, field::temperature.unit, "temperature of the node");
  file.write_replicated<std::int64_t>(body, grid.body);
  vtk::describe(file, body, "1", "place of the body among the rigid bodies of the scene, from 0");
}

}  // namespace

std::vector<Vec3> nodes_in_scene(const SimplexMesh& mesh, const RigidPose& pose) {
  std::vector<Vec3> points;
  points.reserve(mesh.nodes.size());
  for (const Vec3& node : mesh.nodes)
    // A section stands for the whole body and stays in its half-plane when the body turns.
    points.push_back(mesh.axisymmetric ? node + pose.translation
                                       : rotated(node - pose.centre, pose.axis, pose.angle) + pose.axis_point());
  return points;
}

void write_rigid_snapshot(const Comm& comm, const std::string& path, const std::vector<MeshState>& bodies, double time,
                          std::int64_t step) {
  Grid grid;
  comm.together([&] {
    if (!comm.is_root()) return;
    for (const MeshState& state : bodies) append(grid, state);
  });
  constexpr std::int64_t headers = 1 << 14;  // the structures of HDF5 around ten small datasets
  vtk::write_file(comm, path, time, step, grid.bytes() + headers, [&](Hdf5File& file) { write_grid(file, grid); });
}

std::string rigid_snapshot_path(const std::string& folder, int number) {
  char name[64];
  std::snprintf(name, sizeof name, "rigid_%06d.vtkhdf", number);
  return (std::filesystem::path(folder) / name).string();
}

}  // namespace stirsph
