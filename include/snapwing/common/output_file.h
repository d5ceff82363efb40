#pragma once
/// Output files of a command: checked before the work, written completely or not at all.
///
/// Links are followed to the file itself. Pipes, terminals, `/dev/null` and `/dev/stdout` are written to directly and
/// never replaced. A regular file is replaced atomically: readers see the old or the new bytes, and a killed run leaves
/// the old ones.

#include <string>
#include <vector>

namespace snapwing::common {

/// Writes a whole file and flushes it to the disk. @throws FileError naming `path`; the previous content is then
/// unchanged, except for a pipe
void writeFileAtomically(const std::string& path, const std::string& bytes);

/// Creates a folder and its parents. @throws FileError
void makeFolder(const std::string& path);

/// The path with links and dots resolved, as far as it exists. @throws FileError for a cycle of links, or a relative
/// path in a working folder that was removed
std::string resolvedPath(const std::string& path);

/// Checks before long work that its result can be written to `path`. @throws FileError if the folder does not exist or
/// is not writable, or if an existing file cannot be replaced
void requireWritable(const std::string& path);

/// All input and output files of one command, so that none overwrites another.
class OutputFiles {
 public:
  /// Adds an input file. @param what  its name in messages, e.g. "the scene"
  void reads(const std::string& path, const std::string& what);
  void reads(const std::vector<std::string>& paths, const std::string& what);
  /// Adds an output file; an empty path is ignored. @param option  its name in messages, e.g. "--summary"
  /// @throws FileError as requireWritable, or if it is an input or another output, under any name or link
  void writes(const std::string& path, const std::string& option);
  /// Adds an output folder and creates it if missing. Files in it that may be inputs must also be added by writes().
  /// @throws FileError if it cannot be created or written to
  void fills(const std::string& folder, const std::string& option);

 private:
  struct Entry {
    std::string resolved, what;
    unsigned long long device = 0, inode = 0;
    bool exists = false, through = false;
  };
  static Entry entryOf(const std::string& path, const std::string& what);
  /// True for a file in a folder of fills() that does not exist yet.
  bool toBeMade(const std::string& path) const;
  static bool same(const Entry& a, const Entry& b);
  std::vector<Entry> inputs_, outputs_;
  std::vector<std::string> folders_;  ///< of fills()
};

}  // namespace snapwing::common
