// SPDX-License-Identifier: GPL-3.0-or-later

// The only exception type of the library.
//
// Entry functions throw it for arguments that are out of range; the message contains the argument,
// its value and the valid range. Inner functions assert their preconditions.
#pragma once

#include <stdexcept>
#include <string>

namespace prefilter {

enum class ErrorCode {
  kInvalidArgument,  // a value that the caller can correct
  kCancelled,        // the progress callback requested cancellation
  kOutOfMemory,      // the result would exceed the memory
  kFile,             // a file cannot be opened, read or written
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
