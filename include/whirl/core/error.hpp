#pragma once
// Errors that travel as exceptions. Each says how the program ends if nobody handles it.

#include <stdexcept>
#include <string>

namespace whirl::core {

/// Process exit codes, the same on every rank.
enum class Exit : int { success = 0, failure = 1, input = 2, not_delivered = 3, bug = 70 };

/// Base of all errors raised by Whirl.
class Error : public std::runtime_error {
public:
  explicit Error(const std::string& what, Exit exit = Exit::failure) : std::runtime_error(what), exit_(exit) {}
  [[nodiscard]] Exit exit() const noexcept { return exit_; }
  /// True once every rank of the communicator in use throws this error together (set by agree()).
  [[nodiscard]] bool agreed() const noexcept { return agreed_; }
  void mark_agreed() noexcept { agreed_ = true; }

private:
  Exit exit_;
  bool agreed_ = false;
};

/// The user's deck, table or command line is wrong; exit code 2. The text starts with `file:line:column: ` if there is
/// a place.
class InputError : public Error {
public:
  explicit InputError(const std::string& what) : Error(what, Exit::input) {}
};

/// A model was evaluated outside its validity (h <= 0, table range). Recoverable: a nonlinear solver shortens its step.
class DomainError : public Error {
public:
  explicit DomainError(const std::string& what) : Error(what) {}
};

/// An iteration ended without an answer; a study turns this into a result with a reason.
class NotConverged : public Error {
public:
  explicit NotConverged(const std::string& what) : Error(what, Exit::not_delivered) {}
};

/// Our own mistake; exit code 70.
class Bug : public Error {
public:
  explicit Bug(const std::string& what) : Error(what, Exit::bug) {}
};

/// Throws Bug with `what` unless `condition` holds; on in every build, so keep it out of inner loops.
inline void require(bool condition, const char* what) {
  if (!condition) throw Bug(std::string("internal error: ") + what);
}

}  // namespace whirl::core
