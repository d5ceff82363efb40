#include "snapwing/common/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "snapwing/common/error.h"

namespace snapwing::common {

namespace fs = std::filesystem;

namespace {

std::string reason() { return std::strerror(errno); }

/// The standard stream (1 or 2) that leads to the same file; -1: none. Replacing it would lose what is printed.
int streamOf(const struct stat& at) {
  for (const int fd : {1, 2}) {
    struct stat stream {};
    if (::fstat(fd, &stream) == 0 && stream.st_dev == at.st_dev && stream.st_ino == at.st_ino) return fd;
  }
  return -1;
}

bool writtenThrough(const struct stat& at) { return !S_ISREG(at.st_mode) || streamOf(at) >= 0; }

/// An open file that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }
  bool close() {
    const int fd = fd_;
    fd_ = -1;
    return fd < 0 || ::close(fd) == 0;
  }

 private:
  int fd_;
};

bool writeAll(int fd, const std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n = ::write(fd, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = ENOSPC;
    if (n <= 0) return false;
    done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Opens what is there. A pipe without a reader would hold the program for ever, deaf to Ctrl-C: it waits a minute.
int openThrough(const std::string& path, bool pipe) {
  constexpr int FLAGS = O_WRONLY | O_CLOEXEC | O_NOCTTY;
  if (!pipe) return ::open(path.c_str(), FLAGS);
  constexpr int TRIES = 1200, WAIT = 50000;  // [us]
  for (int k = 0; k < TRIES; ++k) {
    const int fd = ::open(path.c_str(), FLAGS | O_NONBLOCK);
    if (fd >= 0) ::fcntl(fd, F_SETFL, O_WRONLY);  // from here on it waits for its reader
    if (fd >= 0 || errno != ENXIO) return fd;
    ::usleep(WAIT);
  }
  throw FileError(path, "cannot be written: the pipe has no reader");
}

void writeThrough(const std::string& path, const struct stat& at, const std::string& bytes) {
  std::fflush(nullptr);  // what was printed before comes before
  const int stream = streamOf(at);
  Descriptor file(stream >= 0 ? ::dup(stream) : openThrough(path, S_ISFIFO(at.st_mode)));
  if (file.get() < 0 || !writeAll(file.get(), bytes) || !file.close())
    throw FileError(path, "cannot be written: " + reason());
}

/// A file without a name in the folder: what is killed leaves nothing behind. Not every file system has that.
int openUnnamed(const std::string& folder, mode_t mode) {
#ifdef O_TMPFILE
  return ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
#else
  return -1;
#endif
}

void replace(const std::string& path, const std::string& target, mode_t mode, const std::string& bytes) {
  const std::string part = target + ".part" + std::to_string(::getpid());
  Descriptor file(openUnnamed(fs::path(target).parent_path().string(), 0666));
  const bool unnamed = file.get() >= 0;
  Descriptor named(unnamed ? -1 : ::open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
  Descriptor& out = unnamed ? file : named;
  const auto fail = [&](const char* what) {
    const std::string why = reason();
    ::unlink(part.c_str());
    throw FileError(path, what + why);
  };
  if (out.get() < 0) fail("cannot be written: ");
  if (mode != 0) ::fchmod(out.get(), mode);
  // Flushed, so that the rename that follows cannot leave an empty file after a power cut.
  if (!writeAll(out.get(), bytes) || ::fsync(out.get()) != 0) fail("cannot be written: ");
  if (unnamed) {
    const std::string source = "/proc/self/fd/" + std::to_string(out.get());
    ::unlink(part.c_str());
    if (::linkat(AT_FDCWD, source.c_str(), AT_FDCWD, part.c_str(), AT_SYMLINK_FOLLOW) != 0) fail("cannot be written: ");
  }
  if (!out.close()) fail("cannot be written: ");
  if (std::rename(part.c_str(), target.c_str()) != 0) fail("cannot be replaced: ");
}

}  // namespace

std::string resolvedPath(const std::string& path) {
  std::error_code error;
  fs::path at = fs::absolute(path, error);
  if (error) throw FileError(path, "the working folder no longer exists");
  // A link whose file does not exist yet means that file.
  for (int links = 0; fs::is_symlink(at, error); ++links) {
    if (links == 40) throw FileError(path, "its links form a loop");
    // Links of /proc to pipes and removed files have no name to follow.
    if (at.parent_path().string().compare(0, 6, "/proc/") == 0) return at.string();
    const fs::path next = fs::read_symlink(at, error);
    if (error) break;
    at = next.is_absolute() ? next : at.parent_path() / next;
  }
  const fs::path folder = fs::canonical(at.parent_path(), error);
  if (error) return at.lexically_normal().string();
  if (at.filename() == "." || at.filename() == ".." || at.filename().empty()) {
    const fs::path whole = fs::canonical(at, error);
    return error ? at.lexically_normal().string() : whole.string();
  }
  // Such a link may lie behind a folder's link, as in /dev/fd.
  const fs::path found = folder / at.filename();
  return found != at && fs::is_symlink(found, error) ? resolvedPath(found.string()) : found.string();
}

void requireWritable(const std::string& path) {
  const std::string target = resolvedPath(path);
  struct stat at {};
  const bool exists = ::stat(target.c_str(), &at) == 0;
  if (exists && S_ISDIR(at.st_mode)) throw FileError(path, "is a folder, not a file");
  if (exists && S_ISBLK(at.st_mode)) throw FileError(path, "is a disk, not a file");
  if (exists && S_ISSOCK(at.st_mode)) throw FileError(path, "is a socket, not a file");
  if (exists && streamOf(at) >= 0) return;
  if (exists && ::access(target.c_str(), W_OK) != 0) throw FileError(path, "cannot be written: " + reason());
  if (exists && writtenThrough(at)) return;
  const std::string folder = fs::path(target).parent_path().string();
  struct stat in {};
  if (::stat(folder.c_str(), &in) != 0 || !S_ISDIR(in.st_mode)) throw FileError(path, "its folder does not exist");
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw FileError(path, "its folder cannot be written to: " + reason());
  }
}

void writeFileAtomically(const std::string& path, const std::string& bytes) {
  requireWritable(path);
  const std::string target = resolvedPath(path);
  struct stat at {};
  const bool exists = ::stat(target.c_str(), &at) == 0;
  if (exists && writtenThrough(at)) return writeThrough(path, at, bytes);
  replace(path, target, exists ? at.st_mode & 07777 : 0, bytes);
}

void makeFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) throw FileError(path, "the folder cannot be made: " + error.message());
}

OutputFiles::Entry OutputFiles::entryOf(const std::string& path, const std::string& what) {
  Entry entry;
  entry.resolved = resolvedPath(path);
  entry.what = what;
  struct stat at {};
  entry.exists = ::stat(path.c_str(), &at) == 0;
  if (!entry.exists) return entry;
  entry.device = at.st_dev;
  entry.inode = at.st_ino;
  entry.through = S_ISCHR(at.st_mode);
  return entry;
}

bool OutputFiles::same(const Entry& a, const Entry& b) {
  if (a.through || b.through) return false;  // a terminal or /dev/null takes any number
  if (a.exists && b.exists) return a.device == b.device && a.inode == b.inode;
  return a.resolved == b.resolved;
}

void OutputFiles::reads(const std::string& path, const std::string& what) {
  if (!path.empty()) inputs_.push_back(entryOf(path, what));
}

void OutputFiles::reads(const std::vector<std::string>& paths, const std::string& what) {
  for (const std::string& path : paths) reads(path, what);
}

void OutputFiles::writes(const std::string& path, const std::string& option) {
  if (path.empty()) return;
  const Entry entry = entryOf(path, option);
  for (const Entry& input : inputs_) {
    if (same(entry, input)) throw FileError(path, option + " would overwrite " + input.what);
  }
  for (const Entry& other : outputs_) {
    if (same(entry, other)) throw FileError(path, option + " and " + other.what + " are one file");
  }
  if (!toBeMade(path)) requireWritable(path);
  outputs_.push_back(entry);
}

bool OutputFiles::toBeMade(const std::string& path) const {
  std::error_code error;
  const fs::path folder = fs::absolute(path, error).lexically_normal().parent_path();
  return std::find(folders_.begin(), folders_.end(), folder.string()) != folders_.end() && !fs::exists(folder, error);
}

void OutputFiles::fills(const std::string& folder, const std::string& option) {
  if (folder.empty()) return;
  std::error_code error;
  fs::path at = resolvedPath(folder);
  while (!fs::exists(at, error) && at.has_relative_path()) at = at.parent_path();
  if (!fs::is_directory(at, error)) throw FileError(folder, option + ": '" + at.string() + "' is not a folder");
  if (::access(at.c_str(), W_OK | X_OK) != 0) throw FileError(folder, option + ": cannot be written to: " + reason());
  folders_.push_back((fs::absolute(folder, error) / "any").lexically_normal().parent_path().string());
}

}  // namespace snapwing::common
