// A state as numbers in fixed order: written by visit(), and read back by the same one.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "failure.hpp"
#include "members.hpp"
#include "statistics.hpp"

namespace zspring {

using Numbers = std::vector<double>;

// Takes `f` to each number and vector of numbers in `x`, whose structs have ZSPRING_MEMBERS.
template <class T, class Visitor>
void visit(T& x, Visitor& f) {
  if constexpr (std::is_array_v<T>)
    for (auto& element : x) visit(element, f);
  else if constexpr (std::is_aggregate_v<T>)
    std::apply([&](auto&... member) { (visit(member, f), ...); }, members(x));
  else
    f(x);
}

struct Writer {
  Numbers& out;
  void operator()(double x) { out.push_back(x); }
  void operator()(bool x) { out.push_back(x); }
  void operator()(Count x) { out.push_back(static_cast<double>(x)); }
  template <class Vector>
  void operator()(const Vector& x) {
    out.insert(out.end(), x.data(), x.data() + x.size());
  }
};

// Throws Refusal where the numbers end too early, or one cannot be a count.
struct Reader {
  const double* in;
  const double* end;
  const double* next(std::ptrdiff_t n) {
    if (end - in < n) refuse("FMU state: ends before all its values are there");
    return std::exchange(in, in + n);
  }
  void operator()(double& x) { x = *next(1); }
  void operator()(bool& x) { x = *next(1) != 0; }
  void operator()(Count& x) {
    const double number = *next(1);
    constexpr double most = 9007199254740992;  // 2^53: up to there a double counts
    if (!(number >= 0 && number <= most && number == std::floor(number))) refuse("FMU state: %g is no count", number);
    x = static_cast<Count>(number);
  }
  template <class Vector>
  void operator()(Vector& x) {
    std::copy_n(next(x.size()), x.size(), x.data());
  }
};

}  // namespace zspring
