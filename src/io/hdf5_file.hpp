/// One HDF5 file written or read by all ranks together through MPI-IO. The only place that knows HDF5; the rest of io/
/// says which rows go where. Every method is collective: all ranks call it in the same order, and if it fails on one
/// rank all ranks throw the same Error(Io).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/comm.hpp"

namespace stirsph {

/// Element types: double, float, std::int64_t, std::uint8_t, stored as they are in memory. Datasets are contiguous and
/// one- or two-dimensional.
class Hdf5File {
 public:
  enum class Mode { Create, Read };

  /// `expected_bytes`: room to ask the file system for before writing begins (Mode::Create only).
  Hdf5File(const Comm& comm, const std::string& path, Mode mode, std::int64_t expected_bytes = 1);
  /// Closes without a check; call close() to learn whether the last bytes were written.
  ~Hdf5File();
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;

  void flush();
  void close();

  /// Writes a dataset made of every rank's rows in rank order. `columns` = 0 makes a one-dimensional dataset; otherwise
  /// `local` holds whole rows of that many values.
  template <class T>
  void write_rows(const std::string& dataset, std::span<const T> local, std::int64_t columns = 0);
  /// Writes values that all ranks hold alike; the root's are taken.
  template <class T>
  void write_replicated(const std::string& dataset, std::span<const T> values, std::int64_t columns = 0);

  /// The rows [first, first + rows) of a dataset of type T; every rank names its own.
  template <class T>
  std::vector<T> read_rows(const std::string& dataset, std::int64_t first, std::int64_t rows);
  /// A whole dataset on every rank.
  template <class T>
  std::vector<T> read_replicated(const std::string& dataset);

  /// Extents of a dataset; columns = 0 for a one-dimensional one.
  std::int64_t rows(const std::string& dataset);
  std::int64_t columns(const std::string& dataset);
  bool has(const std::string& object);
  bool has_attribute(const std::string& object, const std::string& name);
  /// Names of the members of a group, sorted.
  std::vector<std::string> members(const std::string& group);
  void create_group(const std::string& group);

  /// Attributes of a group or dataset ("/" is the file itself). Texts are stored as ASCII of fixed length.
  void set_attribute(const std::string& object, const std::string& name, const std::string& text);
  void set_attribute(const std::string& object, const std::string& name, double value);
  void set_attribute(const std::string& object, const std::string& name, std::int64_t value);
  void set_attribute(const std::string& object, const std::string& name, const std::vector<std::int64_t>& values);
  std::string text_attribute(const std::string& object, const std::string& name);
  double number_attribute(const std::string& object, const std::string& name);
  std::int64_t whole_attribute(const std::string& object, const std::string& name);

 private:
  using Id = std::int64_t;  // HDF5's own handle type; the .cpp checks that it is

  /// What the ranks must know of a dataset to reach its rows.
  struct Place {
    std::int64_t offset, rows, columns;
  };

  template <class Work>
  void on_root(Work&& work) const {
    comm_.together([&] {
      if (comm_.is_root()) work();
    });
  }
  /// Throws IoError with the cause: the system's word if a write failed, otherwise HDF5's innermost complaint.
  [[noreturn]] void fail(const std::string& action) const;
  Id check(Id result, const std::string& action) const;
  void check_written(const std::string& action) const;
  void check_transfer(int status, MPI_Status& transfer, int count, const std::string& action) const;
  Place place(const std::string& dataset, Id expected_type);
  template <class T>
  void write_block(const std::string& dataset, std::span<const T> local, std::int64_t columns);
  void write_attribute(const std::string& object, const std::string& name, Id type, Id space, const void* data);
  void read_attribute(const std::string& object, const std::string& name, Id type, void* data);
  void release() noexcept;

  const Comm comm_;
  const std::string path_;
  const bool writes_;
  int write_failure_ = 0;  // errno of the first failed write of HDF5, 0 if none; root only
  Id file_ = -1;           // root only
  MPI_File bytes_ = MPI_FILE_NULL;
};

}  // namespace stirsph
