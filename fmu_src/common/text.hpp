// Messages: all are made here, none allocates.
#pragma once

#include <cstdarg>
#include <cstdio>

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

}  // namespace zspring
