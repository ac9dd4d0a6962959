#include "common/files/regular_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

#include "common/errors/input_error.h"

namespace rayfarm {

RegularFile open_regular_file(const std::string& path) {
  const auto fail = [&path](const std::string& problem) { throw IoError(path + ": " + problem); };
  const char* const irregular = "is not a regular file (but a pipe, a socket or a device); a file is needed";
  // Without blocking: opening a pipe would wait for a writer.
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (descriptor < 0) {
    const int error = errno;
    std::error_code ignored;
    if (error == ENOENT && std::filesystem::path(path).is_absolute()) fail("no such file; check the path");
    if (error == ENOENT)
      fail(fmt::format("no such file; check the path (it is relative to {})",
                       std::filesystem::current_path(ignored).string()));
    fail(error == ENXIO ? irregular : fmt::format("can't be opened: {}", std::strerror(error)));
  }
  RegularFile opened{OpenFile(fdopen(descriptor, "rb")), 0};
  if (!opened.file) {
    close(descriptor);
    fail(std::strerror(ENOMEM));
  }
  struct stat status {};
  if (fstat(descriptor, &status) != 0) fail(fmt::format("can't be opened: {}", std::strerror(errno)));
  if (S_ISDIR(status.st_mode)) fail("is a folder; a file is needed");
  if (!S_ISREG(status.st_mode)) fail(irregular);
  opened.size_bytes = static_cast<uintmax_t>(status.st_size);
  return opened;
}

size_t read_at(std::FILE* file, uint64_t position, std::span<std::byte> to) {
  size_t done = 0;
  while (done < to.size()) {
    const ssize_t count =
        pread(fileno(file), to.data() + done, to.size() - done, static_cast<off_t>(position + done));
    if (count == 0) break;
    if (count < 0 && errno != EINTR) throw std::runtime_error(std::strerror(errno));
    if (count > 0) done += static_cast<size_t>(count);
  }
  return done;
}

RegularFile open_bytes(std::span<const std::byte> bytes) {
  const auto fail = [] {
    throw IoError(fmt::format("no room for a file in memory: {}", std::strerror(errno)));
  };
  const int descriptor = memfd_create("rayfarm", MFD_CLOEXEC);
  if (descriptor < 0) fail();
  RegularFile opened{OpenFile(fdopen(descriptor, "w+b")), bytes.size()};
  if (!opened.file) {
    close(descriptor);
    fail();
  }
  if (std::fwrite(bytes.data(), 1, bytes.size(), opened.file.get()) != bytes.size() ||
      std::fflush(opened.file.get()) != 0 || std::fseek(opened.file.get(), 0, SEEK_SET) != 0)
    fail();
  return opened;
}

}  // namespace rayfarm
