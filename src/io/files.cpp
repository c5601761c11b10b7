#include "io/files.hpp"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "base/error.hpp"

namespace stirsph {
namespace {

/// A file descriptor that closes itself; closing early with a check is close().
class Descriptor {
 public:
  Descriptor(const std::string& path, int flags, const char* action)
      : path_(path), number_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
    if (number_ < 0) throw_write_error(action, path, errno);
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  int number() const { return number_; }

  void sync() const {
    // Pipes and some network folders cannot be synchronised (EINVAL); nothing can be lost there that we could save.
    if (::fsync(number_) != 0 && errno != EINVAL) throw_write_error("save", path_, errno);
  }

 private:
  std::string path_;
  int number_;
};

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

void choose_mpi_io() {
  constexpr int keep_the_users_choice = 0;
  ::setenv("OMPI_MCA_io", "romio321", keep_the_users_choice);
  ::signal(SIGXFSZ, SIG_IGN);
}

void throw_write_error(const std::string& action, const std::string& path, int error_number) {
  throw IoError("cannot " + action + " " + path + ": " + std::strerror(error_number) + "; " + write_advice);
}

void make_folder(const std::string& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw_write_error("create the folder", folder, failure.value());
}

void reserve_room(const std::string& path, std::int64_t bytes) {
  const std::string action = "reserve " + std::to_string((bytes + 999'999) / 1'000'000) + " MB for";
  rlimit limit{};
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      static_cast<rlim_t>(bytes) > limit.rlim_cur)
    throw_write_error(action, path, EFBIG);
  const Descriptor file(path, O_WRONLY, "open");
  if (::fallocate(file.number(), FALLOC_FL_KEEP_SIZE, 0, bytes) == 0) return;
  if (errno == ENOSPC || errno == EDQUOT || errno == EFBIG) throw_write_error(action, path, errno);
}

void publish_file(const std::string& temporary, const std::string& path) {
  Descriptor(temporary, O_RDONLY, "open").sync();
  if (std::rename(temporary.c_str(), path.c_str()) != 0) throw_write_error("rename " + temporary + " to", path, errno);
  Descriptor(folder_of(path), O_RDONLY | O_DIRECTORY, "open the folder").sync();
}

void write_text_file(const std::string& path, const std::string& text) {
  const std::string temporary = path + ".part";
  try {
    {
      const Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC, "create");
      for (std::size_t done = 0; done < text.size();) {
        const ssize_t written = ::write(file.number(), text.data() + done, text.size() - done);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_write_error("write", path, errno);
        done += static_cast<std::size_t>(written);
      }
    }
    publish_file(temporary, path);
  } catch (...) {
    remove_quietly(temporary);
    throw;
  }
}

void remove_quietly(const std::string& path) noexcept {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

}  // namespace stirsph
