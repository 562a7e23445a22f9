/// Assertions for programming errors: CHECK(a == b) prints both operands and aborts, in release builds too.
#pragma once

#include <sstream>
#include <string>

namespace softreel::detail {

[[noreturn]] void check_failed(const char* expression, const std::string& operands, const char* file, int line);

template <typename T>
std::string printed(const T& value) {
  if constexpr (requires(std::ostream & out) { out << value; }) {
    std::ostringstream out;
    out << value;
    return out.str();
  } else {
    return "(unprintable)";
  }
}

/// The outcome of one comparison; its operands are printed only if it failed.
struct CheckResult {
  bool passed;
  std::string operands;
};

/// Left operand of the checked expression, caught by operator<< of higher precedence than comparisons.
template <typename L>
struct CheckLeft {
  const L& left;

  template <typename R>
  CheckResult outcome(bool passed, const char* op, const R& right) const {
    return {passed, passed ? std::string() : printed(left) + op + printed(right)};
  }
  template <typename R>
  CheckResult operator==(const R& right) const {
    return outcome(left == right, " == ", right);
  }
  template <typename R>
  CheckResult operator!=(const R& right) const {
    return outcome(left != right, " != ", right);
  }
  template <typename R>
  CheckResult operator<(const R& right) const {
    return outcome(left < right, " < ", right);
  }
  template <typename R>
  CheckResult operator<=(const R& right) const {
    return outcome(left <= right, " <= ", right);
  }
  template <typename R>
  CheckResult operator>(const R& right) const {
    return outcome(left > right, " > ", right);
  }
  template <typename R>
  CheckResult operator>=(const R& right) const {
    return outcome(left >= right, " >= ", right);
  }
};

struct CheckStart {
  template <typename L>
  CheckLeft<L> operator<<(const L& left) const {
    return {left};
  }
};

inline CheckResult check_result(CheckResult result) {
  return result;
}
template <typename L>
CheckResult check_result(const CheckLeft<L>& alone) {
  const auto passed = static_cast<bool>(alone.left);
  return {passed, passed ? std::string() : printed(alone.left)};
}

}  // namespace softreel::detail

#define CHECK(...)                                                                                          \
  do {                                                                                                      \
    if (const auto check_outcome =                                                                          \
            ::softreel::detail::check_result(::softreel::detail::CheckStart{} << __VA_ARGS__); /* NOLINT */ \
        !check_outcome.passed)                                                                              \
      ::softreel::detail::check_failed(#__VA_ARGS__, check_outcome.operands, __FILE__, __LINE__);           \
  } while (false)
