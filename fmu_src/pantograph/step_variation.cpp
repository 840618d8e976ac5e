#include "hht.hpp"

namespace zspring {
namespace {

double head_force_change(const Parameters& p, bool closed, const Boundary& db, double du, double dv) {
  if (p.drive == Drive::Force) return db.contact_force;
  return closed ? p.contact.k * (du - db.position) + p.contact.c * (dv - db.velocity) : 0;
}

}  // namespace

MechanicalState Hht::step_variation(const MechanicalState& from, const MechanicalState& to,
                                    const MechanicalState& dfrom, const Boundary& db1) const {
  const Boundary &b0 = from.boundary, &b1 = to.boundary, &db0 = dfrom.boundary;
  const Parameters& p = m_.parameters;
  const double h = to.h;
  const StepCoefficients c(m_, h);
  const bool imposed = head_imposed();

  Trial t;
  t.x = to.a;
  t.v = to.v;
  for (int j = 0; j < 2; ++j) t.x[joint_dof[j]] = c.joint[j].rho * to.v[joint_dof[j]] + to.s[j];
  predict(c, from, t);
  (this->*variant_->evaluate)(c, b1, t);
  Matrix4 tangent;
  m_.head_tangent(t.head, tangent);

  // With the unknowns held: the part of the variation that the old state brings.
  MechanicalState d;
  const Vector5 dv_predicted = dfrom.v + c.old_velocity * dfrom.a;
  d.q = dfrom.q + c.h * dfrom.v + c.old_position * dfrom.a;
  d.v = dv_predicted;
  for (int i : joint_dof) {
    d.a[i] = -dv_predicted[i] / c.gamma_h;
    d.q[i] += c.beta_h2 * d.a[i];
    d.v[i] = 0;
  }
  if (imposed) {
    d.q[U1] = db1.position;
    d.v[U1] = db1.velocity;
    d.a[U1] = db1.acceleration;
  }

  Vector5 old = dfrom.internal - on_masses(db0.uplift);
  Vector5 now = m_.spring_force_change(tangent, d.q) + m_.damping_force(d.v) - on_masses(db1.uplift);
  if (!imposed) {
    const bool closed = contact(b0, from.q[U1], from.v[U1]).closed;
    old[U1] += head_force_change(p, closed, db0, dfrom.q[U1], dfrom.v[U1]);
    now[U1] += head_force_change(p, t.contact.closed, db1, d.q[U1], d.v[U1]);
  }
  Vector5 x = m_.mass.cwiseProduct(d.a) + c.weight * now - c.hht_alpha * old;
  if (imposed) x[U1] = 0;
  (this->*variant_->solve)(c, t, x);

  for (int i : mass_dof) {
    if (i == U1 && imposed) continue;
    d.a[i] -= x[i];
    d.v[i] -= c.gamma_h * x[i];
    d.q[i] -= c.beta_h2 * x[i];
  }
  for (int j = 0; j < 2; ++j) {
    const int i = joint_dof[j];
    d.a[i] -= t.acceleration_slope[j] * x[i];
    d.v[i] -= c.gamma_h * t.acceleration_slope[j] * x[i];
    d.q[i] -= t.angle_slope[j] * x[i];
    d.s[j] = -t.moment_slope[j] * x[i];
  }
  d.a_slope = tells_slope(h, from.h) ? Vector5((d.a - dfrom.a) / h) : dfrom.a_slope;
  for (int j = 0; j < 2; ++j)
    if (t.angle_slope[j] == 0) d.a[joint_dof[j]] = d.a_slope[joint_dof[j]] = 0;
  d.internal = m_.spring_force_change(tangent, d.q) + m_.damping_force(d.v);
  joints(d.internal) += m_.moment_bound.cwiseProduct(d.s);
  d.contact_force = imposed ? reaction(db1, d.internal) : head_force_change(p, t.contact.closed, db1, d.q[U1], d.v[U1]);
  d.boundary = db1;

  d.loss_power = 2 * to.v.dot(m_.damping_force(d.v));
  d.loss_power += m_.moment_bound.dot(d.s.cwiseProduct(joints(to.v)) + to.s.cwiseProduct(joints(d.v)));
  d.dissipated = dfrom.dissipated + 0.5 * h * (dfrom.loss_power + d.loss_power);
  const Vector5 mean_push = m_.preload + 0.5 * (push(b0, from.contact_force) + push(b1, to.contact_force));
  const Vector5 d_push = 0.5 * (push(db0, dfrom.contact_force) + push(db1, d.contact_force));
  d.work = dfrom.work + mean_push.dot(d.q - dfrom.q) + d_push.dot(to.q - from.q);
  return d;
}

}  // namespace zspring
