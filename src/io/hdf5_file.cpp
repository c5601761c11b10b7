#include "io/hdf5_file.hpp"

#include <hdf5.h>

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include "base/error.hpp"
#include "io/files.hpp"
#include "io/hdf5_driver.hpp"

namespace stirsph {
namespace {

static_assert(std::is_same_v<hid_t, std::int64_t>, "Hdf5File::Id must be HDF5's handle type");

/// An HDF5 handle that closes itself.
class Handle {
 public:
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

template <class T>
hid_t memory_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
}

/// HDF5's innermost complaint: the most specific line of its error stack.
std::string innermost_error() {
  std::string text = "unknown cause";
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned depth, const H5E_error2_t* error, void* result) -> herr_t {
        if (depth == 0 && error->desc) *static_cast<std::string*>(result) = error->desc;
        return 0;
      },
      &text);
  return text;
}

constexpr std::int64_t largest_transfer = std::int64_t(1) << 28;  // bytes; MPI counts are ints
constexpr std::size_t longest_text = std::size_t(1) << 20;  // bytes of an attribute; one that claims more is damaged

template <class T>
std::span<const std::uint8_t> bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes()};
}

}  // namespace

Hdf5File::Hdf5File(const Comm& comm, const std::string& path, Mode mode, std::int64_t expected_bytes)
    : comm_(comm), path_(path), writes_(mode == Mode::Create) {
  try {
    on_root([&] {
      // HDF5 would print its whole error stack; the messages of this class carry the line that matters.
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
      const Handle access(check(hdf5_access_with_remembered_failures(&write_failure_), "prepare"), H5Pclose);
      file_ = writes_ ? H5Fcreate(path_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access)
                      : H5Fopen(path_.c_str(), H5F_ACC_RDONLY, access);
      check(file_, writes_ ? "create the file" : "open the file");
      if (writes_) reserve_room(path_, expected_bytes);
    });
    comm_.together([&] {
      const int access = writes_ ? MPI_MODE_WRONLY : MPI_MODE_RDONLY;
      const int status = MPI_File_open(comm_.handle(), path_.c_str(), access, MPI_INFO_NULL, &bytes_);
      if (status != MPI_SUCCESS) fail("open the file with MPI");
    });
  } catch (...) {
    release();
    throw;
  }
}

Hdf5File::~Hdf5File() { release(); }

void Hdf5File::release() noexcept {
  if (bytes_ != MPI_FILE_NULL) MPI_File_close(&bytes_);
  if (file_ >= 0) H5Fclose(std::exchange(file_, -1));
}

void Hdf5File::fail(const std::string& action) const {
  throw IoError("cannot " + action + ": " + path_ + ": " +
                (write_failure_ ? std::strerror(write_failure_) : innermost_error()) + "; " +
                (writes_ ? write_advice : "the file is missing, damaged, cut off or not of this kind"));
}

Hdf5File::Id Hdf5File::check(Id result, const std::string& action) const {
  if (result < 0) fail(action);
  return result;
}

void Hdf5File::check_written(const std::string& action) const {
  if (write_failure_ != 0) fail(action);
}

void Hdf5File::check_transfer(int status, MPI_Status& transfer, int count, const std::string& action) const {
  int done = 0;
  if (status == MPI_SUCCESS && MPI_Get_count(&transfer, MPI_BYTE, &done) == MPI_SUCCESS && done == count) return;
  char text[MPI_MAX_ERROR_STRING] = "the end of the file or of the disk came too early";
  int length = 0;
  if (status != MPI_SUCCESS) MPI_Error_string(status, text, &length);
  throw IoError("cannot " + action + " in " + path_ + ": " + text + "; " +
                (writes_ ? write_advice : "the file is damaged or cut off"));
}

void Hdf5File::flush() {
  on_root([&] {
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "save the data");
    check_written("save the data");
  });
  comm_.together([&] {
    if (MPI_File_sync(bytes_) != MPI_SUCCESS) fail("save the data");
  });
}

void Hdf5File::close() {
  comm_.together([&] {
    if (MPI_File_close(&bytes_) != MPI_SUCCESS) fail("save the last data");
  });
  on_root([&] {
    check(H5Fclose(std::exchange(file_, -1)), "save the last data");
    check_written("save the last data");
  });
}

template <class T>
void Hdf5File::write_block(const std::string& dataset, std::span<const T> local, std::int64_t columns) {
  const std::int64_t width = std::max<std::int64_t>(columns, 1);
  STIRSPH_EXPECT(static_cast<std::int64_t>(local.size()) % width == 0, "a dataset gets whole rows");
  const std::int64_t rows = static_cast<std::int64_t>(local.size()) / width;
  const std::int64_t first = comm_.exclusive_sum(rows), total = comm_.sum(rows);
  const std::string action = "write " + dataset;
  std::vector<std::int64_t> start(1);
  on_root([&] {
    const hsize_t extent[2] = {static_cast<hsize_t>(total), static_cast<hsize_t>(width)};
    const Handle links(check(H5Pcreate(H5P_LINK_CREATE), action), H5Pclose);
    check(H5Pset_create_intermediate_group(links, 1), action);
    const Handle creation(check(H5Pcreate(H5P_DATASET_CREATE), action), H5Pclose);
    // Contiguous, placed at once and left blank: the ranks fill it past HDF5.
    check(H5Pset_layout(creation, H5D_CONTIGUOUS), action);
    check(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY), action);
    check(H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER), action);
    const Handle space(check(H5Screate_simple(columns > 0 ? 2 : 1, extent, nullptr), action), H5Sclose);
    const Handle target(
        check(H5Dcreate2(file_, dataset.c_str(), memory_type<T>(), space, links, creation, H5P_DEFAULT), action),
        H5Dclose);
    const haddr_t offset = total > 0 ? H5Dget_offset(target) : 0;
    if (offset == HADDR_UNDEF) fail(action);
    start[0] = static_cast<std::int64_t>(offset);
    check_written(action);
  });
  comm_.broadcast(start);
  comm_.together([&] {
    const std::span<const std::uint8_t> bytes = bytes_of(local);
    const std::int64_t begin = start[0] + first * width * static_cast<std::int64_t>(sizeof(T));
    for (std::int64_t done = 0; done < std::ssize(bytes);) {
      const int count = static_cast<int>(std::min(std::ssize(bytes) - done, largest_transfer));
      MPI_Status transfer;
      const int status = MPI_File_write_at(bytes_, begin + done, bytes.data() + done, count, MPI_BYTE, &transfer);
      check_transfer(status, transfer, count, action);
      done += count;
    }
  });
}

template <class T>
void Hdf5File::write_rows(const std::string& dataset, std::span<const T> local, std::int64_t columns) {
  write_block(dataset, local, columns);
}

template <class T>
void Hdf5File::write_replicated(const std::string& dataset, std::span<const T> values, std::int64_t columns) {
  write_block(dataset, comm_.is_root() ? values : std::span<const T>{}, columns);
}

Hdf5File::Place Hdf5File::place(const std::string& dataset, Id expected_type) {
  std::vector<std::int64_t> found(3);
  on_root([&] {
    const std::string action = "find the dataset " + dataset;
    const Handle source(check(H5Dopen2(file_, dataset.c_str(), H5P_DEFAULT), action), H5Dclose);
    const Handle space(check(H5Dget_space(source), action), H5Sclose);
    const Handle type(check(H5Dget_type(source), action), H5Tclose);
    const Handle creation(check(H5Dget_create_plist(source), action), H5Pclose);
    if (expected_type >= 0 && H5Tequal(type, expected_type) <= 0)
      throw IoError("cannot read " + dataset + " in " + path_ + ": it holds another type of number");
    if (H5Pget_layout(creation) != H5D_CONTIGUOUS)
      throw IoError("cannot read " + dataset + " in " + path_ +
                    ": it is chunked or compressed; use the file as written");
    hsize_t extent[2] = {0, 0};
    const int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > 2 || H5Sget_simple_extent_dims(space, extent, nullptr) < 0) fail(action);
    const haddr_t offset = H5Dget_offset(source);
    const bool empty = extent[0] == 0;
    if (!empty && offset == HADDR_UNDEF) fail(action);
    // What a damaged header claims must not become the size of an allocation: the rows must lie within the file.
    MPI_Offset end = 0;
    const std::size_t element = H5Tget_size(type);
    const hsize_t width = rank == 2 ? extent[1] : 1;
    if (MPI_File_get_size(bytes_, &end) != MPI_SUCCESS || element == 0) fail(action);
    const hsize_t room = offset < static_cast<haddr_t>(end) ? (static_cast<haddr_t>(end) - offset) / element : 0;
    if (!empty && (width == 0 || width > room || extent[0] > room / width))
      throw IoError("cannot read " + dataset + " in " + path_ +
                    ": it reaches beyond the end of the file; the file is damaged or cut off");
    if (empty && width > hsize_t(1) << 20) fail(action);
    found = {empty ? 0 : static_cast<std::int64_t>(offset), static_cast<std::int64_t>(extent[0]),
             rank == 2 ? static_cast<std::int64_t>(extent[1]) : 0};
  });
  comm_.broadcast(found);
  return {found[0], found[1], found[2]};
}

template <class T>
std::vector<T> Hdf5File::read_rows(const std::string& dataset, std::int64_t first, std::int64_t rows) {
  const Place source = place(dataset, comm_.is_root() ? memory_type<T>() : -1);
  const std::int64_t row_values = std::max<std::int64_t>(source.columns, 1);
  const std::string action = "read " + dataset;
  std::vector<T> values;
  comm_.together([&] {
    if (first < 0 || rows < 0 || first + rows > source.rows)
      throw IoError("cannot read " + dataset + " in " + path_ + ": it has " + std::to_string(source.rows) +
                    " rows, not " + std::to_string(first + rows) + "; the file is damaged");
    values.resize(static_cast<std::size_t>(rows * row_values));
    const std::int64_t begin = source.offset + first * row_values * static_cast<std::int64_t>(sizeof(T));
    const auto size = static_cast<std::int64_t>(values.size() * sizeof(T));
    for (std::int64_t done = 0; done < size;) {
      const int count = static_cast<int>(std::min(size - done, largest_transfer));
      MPI_Status transfer;
      auto* place_in_memory = reinterpret_cast<std::uint8_t*>(values.data()) + done;
      const int status = MPI_File_read_at(bytes_, begin + done, place_in_memory, count, MPI_BYTE, &transfer);
      check_transfer(status, transfer, count, action);
      done += count;
    }
  });
  return values;
}

template <class T>
std::vector<T> Hdf5File::read_replicated(const std::string& dataset) {
  return read_rows<T>(dataset, 0, rows(dataset));
}

std::int64_t Hdf5File::rows(const std::string& dataset) { return place(dataset, -1).rows; }
std::int64_t Hdf5File::columns(const std::string& dataset) { return place(dataset, -1).columns; }

bool Hdf5File::has(const std::string& object) {
  std::vector<std::int64_t> found{object == "/"};
  on_root([&] {
    // HDF5 answers with an error, not with "no", when a folder on the way is missing: ask level by level.
    for (std::size_t end = 0; !found[0] && end != std::string::npos;) {
      end = object.find('/', end + 1);
      if (H5Lexists(file_, object.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return;
      found[0] = end == std::string::npos;
    }
  });
  comm_.broadcast(found);
  return found[0] != 0;
}

bool Hdf5File::has_attribute(const std::string& object, const std::string& name) {
  std::vector<std::int64_t> found(1);
  on_root([&] { found[0] = H5Aexists_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT) > 0; });
  comm_.broadcast(found);
  return found[0] != 0;
}

std::vector<std::string> Hdf5File::members(const std::string& group) {
  std::string joined;
  std::vector<std::int64_t> lengths;
  on_root([&] {
    const std::string action = "list the group " + group;
    const Handle folder(check(H5Gopen2(file_, group.c_str(), H5P_DEFAULT), action), H5Gclose);
    H5G_info_t info;
    check(H5Gget_info(folder, &info), action);
    for (hsize_t i = 0; i < info.nlinks; ++i) {
      const ssize_t length = H5Lget_name_by_idx(folder, ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
      check(length, action);
      std::string name(static_cast<std::size_t>(length) + 1, '\0');
      check(H5Lget_name_by_idx(folder, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT),
            action);
      joined.append(name, 0, static_cast<std::size_t>(length));
      lengths.push_back(length);
    }
  });
  joined = comm_.broadcast(joined);
  comm_.broadcast(lengths);
  std::vector<std::string> names;
  std::size_t begin = 0;
  for (const std::int64_t length : lengths) {
    names.push_back(joined.substr(begin, static_cast<std::size_t>(length)));
    begin += static_cast<std::size_t>(length);
  }
  return names;
}

void Hdf5File::create_group(const std::string& group) {
  on_root([&] {
    const std::string action = "create the group " + group;
    const Handle links(check(H5Pcreate(H5P_LINK_CREATE), action), H5Pclose);
    check(H5Pset_create_intermediate_group(links, 1), action);
    const Handle created(check(H5Gcreate2(file_, group.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), action), H5Gclose);
  });
}

void Hdf5File::write_attribute(const std::string& object, const std::string& name, Id type, Id space,
                               const void* data) {
  const std::string action = "write the attribute " + name + " of " + object;
  const Handle attribute(
      check(H5Acreate_by_name(file_, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
            action),
      H5Aclose);
  check(H5Awrite(attribute, type, data), action);
  check_written(action);
}

void Hdf5File::read_attribute(const std::string& object, const std::string& name, Id type, void* data) {
  const std::string action = "read the attribute " + name + " of " + object;
  const Handle attribute(check(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), action),
                         H5Aclose);
  const Handle space(check(H5Aget_space(attribute), action), H5Sclose);
  if (H5Sget_simple_extent_npoints(space) != 1) fail(action);
  check(H5Aread(attribute, type, data), action);
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, const std::string& text) {
  on_root([&] {
    const Handle type(check(H5Tcopy(H5T_C_S1), "prepare"), H5Tclose);
    check(H5Tset_size(type, std::max<std::size_t>(text.size(), 1)), "prepare");
    check(H5Tset_strpad(type, H5T_STR_NULLPAD), "prepare");
    const Handle space(check(H5Screate(H5S_SCALAR), "prepare"), H5Sclose);
    write_attribute(object, name, type, space, text.c_str());
  });
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, double value) {
  on_root([&] {
    const Handle space(check(H5Screate(H5S_SCALAR), "prepare"), H5Sclose);
    write_attribute(object, name, H5T_NATIVE_DOUBLE, space, &value);
  });
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name, std::int64_t value) {
  on_root([&] {
    const Handle space(check(H5Screate(H5S_SCALAR), "prepare"), H5Sclose);
    write_attribute(object, name, H5T_NATIVE_INT64, space, &value);
  });
}

void Hdf5File::set_attribute(const std::string& object, const std::string& name,
                             const std::vector<std::int64_t>& values) {
  on_root([&] {
    const hsize_t count = values.size();
    const Handle space(check(H5Screate_simple(1, &count, nullptr), "prepare"), H5Sclose);
    write_attribute(object, name, H5T_NATIVE_INT64, space, values.data());
  });
}

std::string Hdf5File::text_attribute(const std::string& object, const std::string& name) {
  std::string text;
  on_root([&] {
    const std::string action = "read the attribute " + name + " of " + object;
    const Handle attribute(
        check(H5Aopen_by_name(file_, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), action), H5Aclose);
    const Handle type(check(H5Aget_type(attribute), action), H5Tclose);
    const Handle space(check(H5Aget_space(attribute), action), H5Sclose);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) != 0 || H5Tget_size(type) > longest_text ||
        H5Sget_simple_extent_npoints(space) != 1)
      fail(action);
    text.resize(H5Tget_size(type));
    check(H5Aread(attribute, type, text.data()), action);
    text.erase(std::find(text.begin(), text.end(), '\0'), text.end());
  });
  return comm_.broadcast(text);
}

double Hdf5File::number_attribute(const std::string& object, const std::string& name) {
  std::vector<double> value(1);
  on_root([&] { read_attribute(object, name, H5T_NATIVE_DOUBLE, value.data()); });
  comm_.broadcast(value);
  return value[0];
}

std::int64_t Hdf5File::whole_attribute(const std::string& object, const std::string& name) {
  std::vector<std::int64_t> value(1);
  on_root([&] { read_attribute(object, name, H5T_NATIVE_INT64, value.data()); });
  comm_.broadcast(value);
  return value[0];
}

#define STIRSPH_HDF5_ELEMENT(T)                                                                      \
  template void Hdf5File::write_rows<T>(const std::string&, std::span<const T>, std::int64_t);       \
  template void Hdf5File::write_replicated<T>(const std::string&, std::span<const T>, std::int64_t); \
  template std::vector<T> Hdf5File::read_rows<T>(const std::string&, std::int64_t, std::int64_t);    \
  template std::vector<T> Hdf5File::read_replicated<T>(const std::string&);
STIRSPH_HDF5_ELEMENT(double)
STIRSPH_HDF5_ELEMENT(float)
STIRSPH_HDF5_ELEMENT(std::int64_t)
STIRSPH_HDF5_ELEMENT(std::uint8_t)
#undef STIRSPH_HDF5_ELEMENT

}  // namespace stirsph
