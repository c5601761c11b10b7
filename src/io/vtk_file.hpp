/// What the snapshots of particles and of rigid bodies share: a file with one unstructured grid in VTKHDF 1.0, the
/// version that ParaView 5.11 reads.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/comm.hpp"
#include "io/hdf5_file.hpp"

namespace stirsph::vtk {

inline const std::string group = "VTKHDF", point_data = "VTKHDF/PointData", cell_data = "VTKHDF/CellData";

/// Cell types of VTK.
inline constexpr std::uint8_t vertex = 1, triangle = 5, tetrahedron = 10;

/// Attributes that say what a dataset holds.
void describe(Hdf5File& file, const std::string& dataset, std::string_view unit, std::string_view meaning);

/// Collective. The three counts of the grid over all ranks.
void write_counts(Hdf5File& file, std::int64_t points, std::int64_t cells, std::int64_t connectivity);

/// Collective. Writes the file whose grid and data `fill` writes. It appears under its name only when it is complete.
/// `expected_bytes`: room to ask the file system for before writing begins.
void write_file(const Comm& comm, const std::string& path, double time, std::int64_t step, std::int64_t expected_bytes,
                const std::function<void(Hdf5File&)>& fill);

}  // namespace stirsph::vtk
