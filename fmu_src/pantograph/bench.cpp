#include "bench.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <utility>

namespace zspring {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr Count fewest_steps_per_period = 16;

}  // namespace

Count steps_in_period(double frequency, double largest_step) {
  constexpr double most = 1e15;  // whatever a damaged state says
  const double needed = std::min(most, std::ceil(1 / (frequency * largest_step) - 1e-9));
  return std::max(fewest_steps_per_period, static_cast<Count>(needed));
}

Ramp Ramp::to(double target, const Point& from, double length) {
  const double rise = target - from.value, d = from.slope * length, c = 0.5 * from.curvature * length * length;
  return {
      {from.value, d, c, 10 * rise - 6 * d - 3 * c, -15 * rise + 8 * d + 3 * c, 6 * rise - 3 * d - c}, length, target};
}

Ramp::Point Ramp::at(double s) const {
  if (s >= length) return {end};
  const double x = s / length;
  Point p;
  p.value = c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5]))));
  p.slope = (c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5])))) / length;
  p.curvature = (2 * c[2] + x * (6 * c[3] + x * (12 * c[4] + x * 20 * c[5]))) / (length * length);
  return p;
}

double Ramp::integral(double s) const {
  const double x = std::min(s / length, 1.0);
  const double ramp =
      length * x * (c[0] + x * (c[1] / 2 + x * (c[2] / 3 + x * (c[3] / 4 + x * (c[4] / 5 + x * c[5] / 6)))));
  return ramp + (s > length ? (s - length) * end : 0);
}

bool BenchState::is_possible(double largest_step) const {
  const double frequency = programme.frequency;
  if (frequency == 0) return true;
  return frequency > 0 && steps_per_period == steps_in_period(frequency, largest_step) &&
         step == Bench::grid_step(frequency, largest_step) && ramp_steps >= steps_per_period &&
         in_period == std::max<Count>(0, node - ramp_steps) % steps_per_period && offset >= 0 && offset < step &&
         std::abs(carry) < step;
}

double Bench::grid_step(double frequency, double largest_step) {
  return 1 / (frequency * steps_in_period(frequency, largest_step));
}

double Bench::elapsed() const { return b_.node * grid_step() + b_.offset; }

double Bench::to_next_node() const { return grid_step() - b_.offset; }

double Bench::phase_at(double s) const {
  const double ramp_end = b_.ramp_steps * grid_step();
  if (s <= ramp_end) return b_.phase + 2 * pi * b_.speed.integral(s);
  // After the ramp from the node count, so that no rounding grows over many periods. Rounding may put the ramp's end, a
  // step ahead, behind it.
  const Count node = b_.node < b_.ramp_steps ? b_.node - b_.ramp_steps : b_.in_period;
  const double beyond = (s - elapsed() + b_.offset) / grid_step();
  return b_.ramp_phase + 2 * pi * (node + beyond) / b_.steps_per_period;
}

Phasor Bench::motion(double tau, Boundary& b) const {
  const double s = elapsed() + tau;
  const double phase = phase_at(s), sine = std::sin(phase), cosine = std::cos(phase);
  const Ramp::Point X = b_.amplitude.at(s), f = b_.speed.at(s);
  const double w = 2 * pi * f.value, dw = 2 * pi * f.slope;
  b.position = X.value * sine;
  b.velocity = X.slope * sine + X.value * w * cosine;
  b.acceleration = (X.curvature - X.value * w * w) * sine + (2 * X.slope * w + X.value * dw) * cosine;
  return {sine, cosine};
}

void Bench::tune(const BenchParameters& programme, double largest_step) {
  const double frequency = programme.frequency, acceleration = programme.acceleration;
  if (frequency == b_.programme.frequency && acceleration == b_.programme.acceleration) return;
  const double target = acceleration / (4 * pi * pi * frequency * frequency);
  Ramp::Point X, f{frequency};
  double phase = 0;
  if (b_.programme.frequency > 0 && !(b_.programme.acceleration == 0 && b_.node >= b_.ramp_steps)) {
    const double s = elapsed();
    X = b_.amplitude.at(s), f = b_.speed.at(s);
    phase = std::fmod(phase_at(s), 2 * pi);
  }
  const double carry = b_.carry;
  b_ = {};
  b_.carry = carry;
  b_.programme = programme;
  b_.phase = phase;
  b_.steps_per_period = steps_in_period(frequency, largest_step);
  b_.step = grid_step(frequency, largest_step);
  const double slower = std::max(1.0, frequency / std::max(f.value, 1e-3 * frequency));
  // Whole periods: a host that steps by periods then stays on the grid.
  b_.ramp_steps = b_.steps_per_period * std::lround(slower);
  const double length = b_.ramp_steps * grid_step();
  b_.amplitude = Ramp::to(target, X, length);
  b_.speed = Ramp::to(frequency, f, length);
  b_.ramp_phase = phase + 2 * pi * b_.speed.integral(length);
}

void Bench::advance(double h, bool reaches_node, Phasor begin, double force_begin, Phasor end, double force_end) {
  if (b_.node >= b_.ramp_steps) {
    const double weight = h * b_.programme.frequency;
    double f0 = weight * force_begin, g0 = f0 * begin.sine;
    double f1 = weight * force_end, g1 = f1 * end.sine;
    for (double (&moment)[2] : b_.moments) {
      moment[0] += f0 + f1, moment[1] += g0 + g1;
      f0 *= begin.cosine, g0 *= begin.cosine;
      f1 *= end.cosine, g1 *= end.cosine;
    }
  }
  if (!reaches_node) {
    b_.offset += h;
    return;
  }
  b_.offset = 0;
  b_.node += 1;
  if (b_.node <= b_.ramp_steps || ++b_.in_period < b_.steps_per_period) return;
  b_.in_period = 0;
  finish_period();
}

// cos n phase = T_n(cos phase) and sin n phase = sin phase U_{n-1}(cos phase) have the recurrence of Chebyshev's
// polynomials, P_{n+1} = 2 cos P_n - P_{n-1}. So have their means with F cos^k, here as complex numbers.
void Bench::finish_period() {
  std::complex<double> before_last[harmonics], last[harmonics];
  for (int k = 0; k < harmonics; ++k) {
    before_last[k] = b_.moments[k][0];
    last[k] = {b_.moments[k + 1][0], b_.moments[k][1]};
  }
  const std::complex<double> force(last[0].imag(), last[0].real()), before(b_.H_re, b_.H_im);
  for (int n = 0; n < harmonics; ++n) {
    b_.harmonic[n] = std::abs(last[0]);
    for (int k = 0; k < harmonics - 1 - n; ++k)
      before_last[k] = std::exchange(last[k], 2.0 * last[k + 1] - before_last[k]);
  }
  const double X = b_.amplitude.end;
  const std::complex<double> H = X > 0 && std::norm(force) > 0 ? -X / force : 0;
  b_.change = b_.periods > 0 && std::norm(H) > 0 ? std::abs(H - before) / std::abs(H) : 1;
  b_.H_re = H.real();
  b_.H_im = H.imag();
  for (double (&moment)[2] : b_.moments) moment[0] = moment[1] = 0;
  b_.periods += 1;
}

}  // namespace zspring
