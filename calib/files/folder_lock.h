#pragma once

#include <filesystem>
#include <string>

#include "calib/model/descriptor.h"

namespace rgbdt {

/// For as long as it lives no other process has a lock on the folder, which is made where it is not
/// there and removed again where it is still empty at the end. It goes with its process, however
/// that ends, and leaves no file. Where the file system knows no locks, nothing is locked.
class FolderLock {
 public:
  /// Throws InputError, which says `who` is at work there, where another one has it, and where the
  /// folder cannot be made.
  FolderLock(std::filesystem::path folder, const std::string& who);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path folder_;
  bool made_ = false;
  Descriptor descriptor_;
};

}  // namespace rgbdt
