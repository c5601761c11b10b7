/// The HDF5 file driver of Hdf5File: plain system calls, and a failed write is remembered instead of reported.
#pragma once

#include <cstdint>

namespace stirsph {

/// A file access property list (HDF5 handle) with this driver, or a negative value. HDF5 1.10 cannot close a file whose
/// metadata it failed to write: the handle stays behind with freed memory and the program crashes when HDF5 shuts down.
/// So the driver tells HDF5 that every write succeeded and puts the errno of the first that did not into *failure,
/// which must outlive the file; the caller looks there. It takes no file locks either, which some clusters refuse.
std::int64_t hdf5_access_with_remembered_failures(int* failure);

}  // namespace stirsph
