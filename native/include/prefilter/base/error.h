// SPDX-License-Identifier: GPL-3.0-or-later

// The one exception type of the library.
//
// Entry functions throw it for arguments that are out of range; the message names the argument,
// what was found and what is allowed. Inner functions trust their preconditions and assert them.
#pragma once

#include <stdexcept>
#include <string>

namespace prefilter {

enum class ErrorCode {
  kInvalidArgument,  // a value that the caller can correct
  kCancelled,        // the progress callback asked to stop
  kOutOfMemory,      // the result would not fit into memory
  kFile,             // the system refuses to open, read or write a file
};

class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

[[noreturn]] inline void throw_invalid(const std::string& message) {
  throw Error(ErrorCode::kInvalidArgument, message);
}

}  // namespace prefilter
