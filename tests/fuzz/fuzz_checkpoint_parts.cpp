/// libFuzzer over what a checkpoint is made of: HDF5 files that are sound in themselves, but whose groups, datasets and
/// attributes may be missing or of another type, shape or content than a checkpoint has. Damage of the bytes hardly
/// gets so far, as HDF5's own checksums stop it (fuzz_checkpoint).
#include <fuzzer/FuzzedDataProvider.h>
#include <hdf5.h>

#include <cstdint>
#include <vector>

#include "checkpoint_input.hpp"

namespace {

using namespace stirsph;

hid_t odd_type(FuzzedDataProvider& choices) {
  switch (choices.ConsumeIntegralInRange(0, 7)) {
    case 0:
      return H5Tcopy(H5T_NATIVE_DOUBLE);
    case 1:
      return H5Tcopy(H5T_NATIVE_INT64);
    case 2:
      return H5Tcopy(H5T_NATIVE_UINT8);
    case 3:
      return H5Tcopy(H5T_NATIVE_FLOAT);
    case 4:
      return H5Tcopy(H5T_IEEE_F64BE);
    case 5: {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, H5T_VARIABLE);
      return type;
    }
    case 6: {
      const hid_t type = H5Tcreate(H5T_COMPOUND, 16);
      H5Tinsert(type, "a", 0, H5T_NATIVE_DOUBLE);
      H5Tinsert(type, "b", 8, H5T_NATIVE_INT);
      return type;
    }
    default: {
      const hid_t type = H5Tcopy(H5T_C_S1);
      H5Tset_size(type, choices.ConsumeIntegralInRange<std::size_t>(1, 200));
      return type;
    }
  }
}

hid_t odd_space(FuzzedDataProvider& choices) {
  const int rank = choices.ConsumeIntegralInRange(0, 3);
  if (rank == 0) return H5Screate(choices.ConsumeBool() ? H5S_SCALAR : H5S_NULL);
  hsize_t extent[3];
  for (int d = 0; d < rank; ++d) extent[d] = choices.ConsumeIntegralInRange<hsize_t>(0, 5);
  return H5Screate_simple(rank, extent, nullptr);
}

hid_t usual_space(hsize_t rows, hsize_t columns) {
  const hsize_t extent[2] = {rows, columns};
  return rows == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(columns > 0 ? 2 : 1, extent, nullptr);
}

/// Bytes for the elements of a type that holds no pointers.
std::vector<std::uint8_t> content(FuzzedDataProvider& choices, hid_t type, hid_t space) {
  const auto points = static_cast<std::size_t>(std::max<hssize_t>(H5Sget_simple_extent_npoints(space), 0));
  std::vector<std::uint8_t> bytes(points * H5Tget_size(type) + 1);
  if (choices.ConsumeBool()) choices.ConsumeData(bytes.data(), bytes.size());
  return bytes;
}

bool is_plain(hid_t type) { return H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) == 0; }

/// Now and then something else than the part that belongs here.
bool is_odd(FuzzedDataProvider& choices) { return choices.ConsumeIntegralInRange(0, 9) == 9; }

void add_attribute(FuzzedDataProvider& choices, hid_t object, const char* name, hid_t usual_type, const void* usual) {
  const bool odd = is_odd(choices);
  if (odd && choices.ConsumeBool()) return;
  const hid_t type = odd ? odd_type(choices) : H5Tcopy(usual_type);
  const hid_t space = odd ? odd_space(choices) : usual_space(0, 0);
  const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  if (!odd && usual) {
    H5Awrite(attribute, type, usual);
  } else if (is_plain(type)) {
    H5Awrite(attribute, type, content(choices, type, space).data());
  }
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
}

void add_dataset(FuzzedDataProvider& choices, hid_t file, const std::string& name, hid_t usual_type, hsize_t rows,
                 hsize_t columns, const void* usual) {
  const bool odd = is_odd(choices);
  const int kind = odd ? choices.ConsumeIntegralInRange(0, 6) : 6;
  if (kind == 0) return;
  const hid_t links = H5Pcreate(H5P_LINK_CREATE), creation = H5Pcreate(H5P_DATASET_CREATE);
  H5Pset_create_intermediate_group(links, 1);
  if (kind == 1) {
    H5Gclose(H5Gcreate2(file, name.c_str(), links, H5P_DEFAULT, H5P_DEFAULT));
  } else if (kind == 2) {
    H5Lcreate_soft(choices.ConsumeBool() ? name.c_str() : "/particles/position", file, name.c_str(), links,
                   H5P_DEFAULT);
  } else {
    const hid_t type = odd ? odd_type(choices) : H5Tcopy(usual_type);
    const hid_t space = odd ? odd_space(choices) : usual_space(rows, columns);
    if (kind == 3) H5Pset_layout(creation, H5D_COMPACT);
    if (kind == 4) H5Pset_alloc_time(creation, H5D_ALLOC_TIME_LATE);
    if (kind == 6) H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    const hid_t dataset = H5Dcreate2(file, name.c_str(), type, space, links, creation, H5P_DEFAULT);
    if (!odd && usual && !is_odd(choices)) {
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, usual);
    } else if (kind != 4 && is_plain(type)) {
      H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, content(choices, type, space).data());
    }
    if (dataset >= 0) {
      const std::int64_t checksum = 0;  // not compared in this build
      add_attribute(choices, dataset, "checksum", H5T_NATIVE_INT64, &checksum);
      H5Dclose(dataset);
    }
    H5Sclose(space);
    H5Tclose(type);
  }
  H5Pclose(creation);
  H5Pclose(links);
}

void write_file(FuzzedDataProvider& choices) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  const hid_t file = H5Fcreate(fuzz::file_name().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Tset_size(text, 18);
  H5Tset_strpad(text, H5T_STR_NULLPAD);
  const SpaceLayout layout = layout_of<Cartesian3>();
  const std::int64_t one = 1, dim = layout.dim, velocity = layout.velocity_components,
                     stress = layout.stress_components;
  add_attribute(choices, file, "format", text, "stirsph checkpoint");
  add_attribute(choices, file, "format_version", H5T_NATIVE_INT64, &one);
  add_attribute(choices, file, "complete", H5T_NATIVE_INT64, &one);
  add_attribute(choices, file, "dim", H5T_NATIVE_INT64, &dim);
  add_attribute(choices, file, "velocity_components", H5T_NATIVE_INT64, &velocity);
  add_attribute(choices, file, "stress_components", H5T_NATIVE_INT64, &stress);
  const std::vector<std::int64_t> per_rank{1, 2};
  const bool two_ranks = choices.ConsumeBool();
  add_dataset(choices, file, "partition/particles_per_rank", H5T_NATIVE_INT64, two_ranks ? 2 : 1, 0, per_rank.data());
  const hsize_t rows = two_ranks ? 3 : 1;
  add_dataset(choices, file, "particles/id", H5T_NATIVE_DOUBLE, rows, 0, nullptr);
  add_dataset(choices, file, "particles/position", H5T_NATIVE_DOUBLE, rows, 3, nullptr);
  add_dataset(choices, file, "particles/temperature", H5T_NATIVE_DOUBLE, rows, 0, nullptr);
  add_dataset(choices, file, "state/numbers/clock", H5T_NATIVE_DOUBLE, 2, 0, nullptr);
  add_dataset(choices, file, "state/texts/scene", H5T_NATIVE_UINT8, 9, 0, nullptr);
  if (is_odd(choices)) {
    const std::string name = choices.ConsumeRandomLengthString(8);
    if (!name.empty() && name.find('\0') == std::string::npos)
      add_dataset(choices, file, (choices.ConsumeBool() ? "particles/" : "state/numbers/") + name, H5T_NATIVE_DOUBLE, 1,
                  0, nullptr);
  }
  H5Tclose(text);
  H5Fclose(file);
  H5Pclose(access);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  fuzz::start_mpi();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider choices(data, size);
  write_file(choices);
  fuzz::read_or_refuse();
  return 0;
}
