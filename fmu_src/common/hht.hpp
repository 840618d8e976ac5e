// HHT-alpha (Hilber, Hughes, Taylor 1977), what every model integrates with it alike.
//
//   M a[n+1] + (1 + hht_alpha) R[n+1] - hht_alpha R[n] = 0,   R = M a less than what is in equilibrium with it
//   q[n+1] = q + h v + h^2 ((1/2 - beta) a + beta a[n+1]),    v[n+1] = v + h ((1 - gamma) a + gamma a[n+1])
//   beta = (1 - hht_alpha)^2 / 4,   gamma = 1/2 - hht_alpha
//
// `a` belongs to t + hht_alpha h, not to t: it is the integrator's memory, not an output. Where the length of the
// step changes it is moved, along its slope, to where the next step expects it; without that, steps of varying
// size are of first order. A sliver of a step says little of the slope and would have it magnified by the next.
#pragma once

namespace zspring {

struct HhtCoefficients {
  HhtCoefficients(double alpha, double step) : h(step), hht_alpha(alpha), weight(1 + alpha) {
    const double beta = 0.25 * (1 - alpha) * (1 - alpha);
    const double gamma = 0.5 - alpha;
    beta_h2 = beta * h * h;
    gamma_h = gamma * h;
    old_position = (0.5 - beta) * h * h;
    old_velocity = (1 - gamma) * h;
  }

  double h;                           // s
  double hht_alpha, weight;           // weight: 1 + hht_alpha
  double beta_h2, gamma_h;            // s2, s
  double old_position, old_velocity;  // (1/2 - beta) h^2, (1 - gamma) h
};

// From the memory of steps of h_last s, 0 before the first, to that of steps of h s; linear, so of variations too.
template <class Vector>
void move_memory(double hht_alpha, double h_last, double h, const Vector& slope, Vector& a) {
  if (h_last > 0 && h_last != h) a += hht_alpha * (h - h_last) * slope;
}

inline bool tells_slope(double h, double h_last) { return h >= 0.25 * h_last; }

}  // namespace zspring
