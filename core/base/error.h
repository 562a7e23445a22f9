/// What a user can cause and mend: thrown anywhere, caught once in tool/main.cpp.
#pragma once

#include <stdexcept>
#include <string>

namespace softreel {

/// Exit status of the program for a failure of this kind (design sec. 7).
enum class ErrorKind {
  Work = 1,        ///< the work failed: a step that cannot be solved, a full disk
  Input = 2,       ///< the input is wrong, or the part is not built in
  Interrupt = 130  ///< the user pressed Ctrl-C
};

/// One message of up to five parts: where, what is wrong, with which value, what is accepted, what to do next.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

/// The input (file, field, value, missing part) is wrong; exit status 2.
inline Error input_error(const std::string& message) {
  return {ErrorKind::Input, message};
}

/// The work failed although the input could be read; exit status 1.
inline Error work_error(const std::string& message) {
  return {ErrorKind::Work, message};
}

/// The user asked to stop; exit status 130.
inline Error interrupted() {
  return {ErrorKind::Interrupt, "Interrupted; what is finished is kept. Run the same command again to go on."};
}

}  // namespace softreel
