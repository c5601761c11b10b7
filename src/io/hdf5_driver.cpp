#include "io/hdf5_driver.hpp"

#include <fcntl.h>
#include <hdf5.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <memory>

namespace stirsph {
namespace {

/// What the property list hands to the driver.
struct DriverInfo {
  int* failure;
};

/// An open file as HDF5 sees it; HDF5 requires its own part first.
struct DriverFile {
  H5FD_t base{};
  int descriptor = -1;
  int* failure = nullptr;
  haddr_t allocated = 0;
  haddr_t written = 0;
};

DriverFile& cast(H5FD_t* file) { return *reinterpret_cast<DriverFile*>(file); }
const DriverFile& cast(const H5FD_t* file) { return *reinterpret_cast<const DriverFile*>(file); }

void remember(const DriverFile& file, int error_number) {
  if (*file.failure == 0) *file.failure = error_number;
}

H5FD_t* open_file(const char* path, unsigned flags, hid_t access, haddr_t) {
  const auto* info = static_cast<const DriverInfo*>(H5Pget_driver_info(access));
  if (!info) return nullptr;
  int mode = (flags & H5F_ACC_RDWR) ? O_RDWR : O_RDONLY;
  if (flags & H5F_ACC_CREAT) mode |= O_CREAT;
  if (flags & H5F_ACC_TRUNC) mode |= O_TRUNC;
  auto file = std::make_unique<DriverFile>();
  file->failure = info->failure;
  file->descriptor = ::open(path, mode | O_CLOEXEC, 0666);
  struct stat status {};
  if (file->descriptor < 0 || ::fstat(file->descriptor, &status) != 0) {
    *file->failure = errno;
    if (file->descriptor >= 0) ::close(file->descriptor);
    return nullptr;
  }
  file->written = static_cast<haddr_t>(status.st_size);
  return &file.release()->base;
}

herr_t close_file(H5FD_t* base) {
  const std::unique_ptr<DriverFile> file(&cast(base));
  // Network file systems report a write that failed late only here.
  if (::close(file->descriptor) != 0) remember(*file, errno);
  return 0;
}

herr_t query(const H5FD_t*, unsigned long* flags) {
  *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA;
  return 0;
}

haddr_t allocated_end(const H5FD_t* base, H5FD_mem_t) { return cast(base).allocated; }
haddr_t written_end(const H5FD_t* base, H5FD_mem_t) { return cast(base).written; }
herr_t set_allocated_end(H5FD_t* base, H5FD_mem_t, haddr_t end) {
  cast(base).allocated = end;
  return 0;
}

herr_t read_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, size_t size, void* buffer) {
  auto* place = static_cast<char*>(buffer);
  while (size > 0) {
    const ssize_t got = ::pread(cast(base).descriptor, place, size, static_cast<off_t>(address));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return -1;
    if (got == 0) {  // beyond the end: HDF5 expects zeros there
      std::fill_n(place, size, '\0');
      return 0;
    }
    place += got;
    address += static_cast<haddr_t>(got);
    size -= static_cast<size_t>(got);
  }
  return 0;
}

herr_t write_bytes(H5FD_t* base, H5FD_mem_t, hid_t, haddr_t address, size_t size, const void* buffer) {
  DriverFile& file = cast(base);
  file.written = std::max<haddr_t>(file.written, address + size);
  const auto* place = static_cast<const char*>(buffer);
  while (size > 0 && *file.failure == 0) {
    const ssize_t done = ::pwrite(file.descriptor, place, size, static_cast<off_t>(address));
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) {
      remember(file, errno);
      break;
    }
    place += done;
    address += static_cast<haddr_t>(done);
    size -= static_cast<size_t>(done);
  }
  return 0;
}

/// Gives the file the length HDF5 expects; rows written by other ranks and room reserved beyond are not HDF5's concern.
herr_t truncate(H5FD_t* base, hid_t, hbool_t) {
  DriverFile& file = cast(base);
  if (*file.failure == 0 && ::ftruncate(file.descriptor, static_cast<off_t>(file.allocated)) != 0)
    remember(file, errno);
  file.written = file.allocated;
  return 0;
}

hid_t registered_driver() {
  static const hid_t driver = [] {
    H5FD_class_t functions{};
    functions.name = "stirsph";
    functions.maxaddr = static_cast<haddr_t>(INT64_MAX);
    functions.fc_degree = H5F_CLOSE_STRONG;
    functions.fapl_size = sizeof(DriverInfo);
    functions.open = open_file;
    functions.close = close_file;
    functions.query = query;
    functions.get_eoa = allocated_end;
    functions.set_eoa = set_allocated_end;
    functions.get_eof = written_end;
    functions.read = read_bytes;
    functions.write = write_bytes;
    functions.truncate = truncate;
    const H5FD_mem_t one_list_for_all[H5FD_MEM_NTYPES] = H5FD_FLMAP_SINGLE;
    std::copy(std::begin(one_list_for_all), std::end(one_list_for_all), functions.fl_map);
    return H5FDregister(&functions);
  }();
  return driver;
}

}  // namespace

std::int64_t hdf5_access_with_remembered_failures(int* failure) {
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  const DriverInfo info{failure};
  if (access < 0 || registered_driver() < 0 || H5Pset_driver(access, registered_driver(), &info) < 0 ||
      H5Pset_fclose_degree(access, H5F_CLOSE_STRONG) < 0 ||
      // The format since HDF5 1.8: its headers carry checksums, so that HDF5 refuses damaged ones. In the older one it
      // follows them wherever they point, beyond its own memory too.
      H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST) < 0)
    return -1;
  return access;
}

}  // namespace stirsph
