// A finite supply of choices: what the fuzzer gives, or random bytes. All zero when it is used up.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>

namespace fuzz {

// Numbers that break things, and some that do not.
inline constexpr double telling_numbers[] = {0,
                                             1,
                                             -1,
                                             0.5,
                                             2,
                                             3,
                                             5,
                                             120,
                                             100,
                                             0.001,
                                             -0.001,
                                             0.01,
                                             0.05,
                                             1e-9,
                                             4.5,
                                             -3,
                                             1e12,
                                             1e15,
                                             -1e15,
                                             1e300,
                                             -1e300,
                                             1e-300,
                                             5e-324,
                                             2147483647.0,
                                             -2147483648.0,
                                             4294967296.0,
                                             9007199254740993.0,
                                             -0.0,
                                             0.3,
                                             -0.3333333333333333,
                                             20000,
                                             1000};

class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : next_(data), end_(data + size) {}

  bool done() const { return next_ == end_; }
  std::uint8_t byte() { return done() ? 0 : *next_++; }
  unsigned below(std::size_t n) { return byte() % static_cast<unsigned>(n); }
  bool one_in(unsigned n) { return below(n) == n - 1; }
  template <class Item, std::size_t n>
  Item pick(const Item (&items)[n]) {
    return items[below(n)];
  }

  double finite_number() {
    const unsigned kind = byte();
    if (kind < 100) return telling_numbers[kind % std::size(telling_numbers)];
    return static_cast<std::int8_t>(byte()) * (kind < 180 ? 1e-3 : 1.0);
  }
  double number() {
    if (!one_in(16)) return finite_number();
    const double inf = std::numeric_limits<double>::infinity();
    const double wrong[] = {inf, -inf, std::numeric_limits<double>::quiet_NaN()};
    return pick(wrong);
  }

 private:
  const std::uint8_t *next_, *end_;
};

}  // namespace fuzz
