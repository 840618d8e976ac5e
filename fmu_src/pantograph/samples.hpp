// The last few samples of a signal at communication points of any spacing, and the polynomial through them.
#pragma once

#include <algorithm>

#include "common/statistics.hpp"

namespace zspring {

struct Samples {
  static constexpr int most = 5;
  Count count = 0;
  double last_length = 0;   // s, of the last append
  double age[most] = {};    // s before the newest sample, ascending, age[0] = 0
  double value[most] = {};  // SI

  // `length` s after the last one. Samples of very different distances are no help to each other: one that comes
  // late begins anew with its neighbour, a single one that comes early replaces its neighbour.
  void append(double length, double x) {
    if (count >= 2 && length > 4 * age[1]) count = 1;
    const int replaced = count >= 2 && length < last_length / 16 ? 1 : 0;
    last_length = length;
    const int kept = std::min(static_cast<int>(count) - replaced, most - 1);
    for (int i = kept; i > 0; --i) {
      age[i] = age[i - 1 + replaced] + length;
      value[i] = value[i - 1 + replaced];
    }
    age[0] = 0;
    value[0] = x;
    count = kept + 1;
  }

  bool is_possible() const { return count <= most; }
};
ZSPRING_MEMBERS(Samples, count, last_length, age, value)

// Newton's divided differences of the samples, newest first; linear in the values.
class Interpolant {
 public:
  explicit Interpolant(const Samples& s) {
    const int n = static_cast<int>(s.count);
    for (int i = 0; i < n; ++i) t_[i] = -s.age[i], c_[i] = s.value[i];
    for (int k = 1; k < n; ++k)
      for (int i = n - 1; i >= k; --i) c_[i] = (c_[i] - c_[i - 1]) / (t_[i] - t_[i - k]);
  }

  // `tau` s after the newest sample.
  double value(double tau) const {
    double p = c_[Samples::most - 1];
    for (int i = Samples::most - 2; i >= 0; --i) p = c_[i] + (tau - t_[i]) * p;
    return p;
  }
  // At the newest sample: fourth and third order through five samples.
  double slope() const { return c_[1] - t_[1] * (c_[2] - t_[2] * (c_[3] - t_[3] * c_[4])); }
  double curvature() const {
    return 2 * (c_[2] - (t_[1] + t_[2]) * c_[3] + (t_[1] * t_[2] + t_[1] * t_[3] + t_[2] * t_[3]) * c_[4]);
  }

 private:
  double t_[Samples::most] = {}, c_[Samples::most] = {};
};

}  // namespace zspring
