// Messages, none of which allocates, and how things fail, one way for each kind:
//
//   a caller is wrong        throws Refusal, before anything has changed
//   a step cannot be made    returns a Discard, with the state as before; no exception, which would allocate
//   there may be no answer   returns std::optional of it; false where it would be worked out in place
#pragma once

#include <cstdarg>
#include <cstdio>
#include <stdexcept>

namespace zspring {

struct Text {
  char chars[640];  // the longest of them, with what values of %.17g can take
};

#ifdef __GNUC__
#define ZSPRING_LIKE_PRINTF __attribute__((format(printf, 1, 2)))
#else
#define ZSPRING_LIKE_PRINTF
#endif

inline Text text_of(const char* format, std::va_list values) {
  Text result;
  std::vsnprintf(result.chars, sizeof result.chars, format, values);
  return result;
}

// As printf formats; what does not fit is cut off.
ZSPRING_LIKE_PRINTF inline Text text(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  const Text result = text_of(format, values);
  va_end(values);
  return result;
}

// Parameters that make no model, calls that break a rule: names the variable, its value and what is allowed.
class Refusal : public std::runtime_error {
 public:
  explicit Refusal(const Text& reason) : std::runtime_error(reason.chars) {}
};

// With a text as by printf.
[[noreturn]] ZSPRING_LIKE_PRINTF inline void refuse(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  const Text reason = text_of(format, values);
  va_end(values);
  throw Refusal(reason);
}

// Why a communication step was not made.
struct Discard {
  double time;          // s since its begin
  Text reason;          // for the log
  bool at_end = false;  // the run can go no further
};

inline constexpr char overflow[] = "values overflow: parameters or inputs are too large or too small";

}  // namespace zspring
