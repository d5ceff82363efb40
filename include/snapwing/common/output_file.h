#pragma once
/// Files that a command writes: checked before the work, written whole or not at all.
///
/// A name is followed through links to the file it means. Pipes, terminals, `/dev/null` and `/dev/stdout` are written
/// through and never replaced. A regular file is replaced in one step: readers see the old or the new bytes, and a
/// killed run leaves the old ones.

#include <string>
#include <vector>

namespace snapwing::common {

/// Writes a whole file, flushed to the disk. @throws FileError naming `path`: what was there before is as it was,
/// except behind a pipe
void writeFileAtomically(const std::string& path, const std::string& bytes);

/// Makes a folder and those above it. @throws FileError
void makeFolder(const std::string& path);

/// A path without links and dots, as far as it exists. @throws FileError for a circle of links, or a relative path in a
/// working folder that was removed
std::string resolvedPath(const std::string& path);

/// To be asked before long work whose result goes to `path`. @throws FileError if its folder does not exist or cannot
/// be written to, or if what is there cannot be replaced
void requireWritable(const std::string& path);

/// All files of one command, so that none destroys another.
class OutputFiles {
 public:
  /// A file that the command reads. @param what  how it is called in a message, e.g. "the scene"
  void reads(const std::string& path, const std::string& what);
  void reads(const std::vector<std::string>& paths, const std::string& what);
  /// A file that it will write; an empty path is none. @param option  its name, e.g. "--summary"
  /// @throws FileError as requireWritable, or if it is an input or another output, whatever name or link leads there
  void writes(const std::string& path, const std::string& option);
  /// A folder that it will fill, made if it is not there. Files in it are stated by writes() if they may be inputs.
  /// @throws FileError if it cannot be made or written to
  void fills(const std::string& folder, const std::string& option);

 private:
  struct Entry {
    std::string resolved, what;
    unsigned long long device = 0, inode = 0;
    bool exists = false, through = false;
  };
  static Entry entryOf(const std::string& path, const std::string& what);
  /// True for a file in a folder of fills() that is not there yet.
  bool toBeMade(const std::string& path) const;
  static bool same(const Entry& a, const Entry& b);
  std::vector<Entry> inputs_, outputs_;
  std::vector<std::string> folders_;  ///< that fills() was told
};

}  // namespace snapwing::common
