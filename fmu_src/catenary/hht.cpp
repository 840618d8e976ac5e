#include "hht.hpp"

#include <algorithm>
#include <cmath>

namespace zspring::catenary {
namespace {

double rounded(double h) {
  int exponent;
  const double mantissa = std::frexp(h, &exponent);
  return std::ldexp(std::round(std::ldexp(mantissa, 36)), exponent - 36);
}

// M + (1 + hht_alpha) (gamma h C + beta h^2 K)
SparseMatrix iteration_matrix(const Line& line, const HhtCoefficients& c) {
  const Parameters& p = line.p;
  return (1 + c.weight * c.gamma_h * p.damping.mass) * line.matrices.mass +
         c.weight * c.gamma_h * p.damping.stiffness * line.matrices.wires + c.weight * c.beta_h2 * line.stiffness();
}

// The droppers' forces where nothing moves and none is slack. Those that hang loose in the static state count there, so
// that slack changes forces by what it has beyond that state's.
VectorXd trial_tension(const StaticShape& shape, const DropperResponse& response) {
  VectorXd tension = shape.tension;
  for (int j = 0; j < static_cast<int>(tension.size()); ++j)
    if (shape.slack[j] > 0) {
      const double pull = shape.stiffness[j] * shape.slack[j];
      response.relieve(j, -pull, shape.stiffness, tension);
      tension[j] += pull;
    }
  return tension;
}

}  // namespace

StepFactors::StepFactors(const Line& line, double step)
    : HhtCoefficients(line.p.solver.hht_alpha, step),
      factor(iteration_matrix(line, *this)),
      droppers(line.mesh, factor, weight * beta_h2),
      tension(trial_tension(line.shape, droppers)) {}

Hht::Hht(const Line& line)
    : line_(line),
      wires_(line.matrices.wires),
      mass_(line.matrices.mass),
      mass_factor_(line.matrices.mass),
      slackening_(line.shape.stiffness),
      no_slack_(VectorXd::Zero(line.shape.slack.size())),
      x_(line.mesh.dofs()),
      trial_(line.shape.stiffness.size()) {
  factors(line.p.solver.step);
}

const StepFactors& Hht::factors(double h) {
  const double wanted = rounded(h);
  auto* const end = std::end(factors_);
  auto* found = std::find_if(factors_, end, [&](const auto& f) { return !f || f->h == wanted; });
  if (found == end) --found;
  if (!*found || (*found)->h != wanted) *found = std::make_unique<StepFactors>(line_, wanted);
  std::rotate(factors_, found, found + 1);
  return *factors_[0];
}

// In trial_: the droppers' forces, N, at u + beta_h2 a if none were slack.
void Hht::trial_forces(const VectorXd& u, const VectorXd& a, double beta_h2) {
  const StaticShape& shape = line_.shape;
  for (int j = 0; j < static_cast<int>(trial_.size()); ++j)
    trial_[j] = shape.stiffness[j] * (stretch(line_.mesh, u, j) + beta_h2 * stretch(line_.mesh, a, j));
}

// u' K u of the droppers less twice their elastic energy, J. A dropper is stretched by e, slack by s, and by s0 in the
// static state: it holds k e^2 / 2 - k s^2 / 2 + k s0^2 / 2 - k s0 e.
double Hht::loose_energy(const LineState& s) const {
  double energy = 0;
  for (int j = 0; j < static_cast<int>(s.slack.size()); ++j) {
    const double slack = s.slack[j], usual = line_.shape.slack[j];
    if (slack != 0 || usual != 0)
      energy += line_.shape.stiffness[j] * (slack * slack - usual * usual + 2 * usual * stretch(line_.mesh, s.u, j));
  }
  return energy;
}

BlockCholesky Hht::static_factor() const {
  SparseMatrix stiffness = line_.stiffness();
  for (int dof = 0; dof < line_.mesh.dofs(); ++dof)
    if (is_anchor(line_.mesh, dof)) stiffness.coeffRef(dof, dof) = 1;
  return BlockCholesky(stiffness);
}

LineState Hht::at_rest_if_taut(const BlockCholesky& factor, const Loads& loads) const {
  LineState s = LineState::at_rest(line_);
  loads.add_to(s.u, 1);
  factor.solve(s.u);
  return s;
}

std::optional<LineState> Hht::at_rest(const Loads& loads) {
  const BlockCholesky factor = static_factor();
  LineState s = at_rest_if_taut(factor, loads);
  trial_forces(s.u, s.a, 0);
  trial_ += line_.shape.tension;
  if (trial_.size() > 0 && trial_.minCoeff() < 0) {
    const DropperResponse response(line_.mesh, factor, 1);
    trial_ += trial_tension(line_.shape, response) - line_.shape.tension;
    if (!slackening_.solve(trial_, response, s.slack)) return std::nullopt;
    response.add(1, line_.shape.stiffness, s.slack, line_.shape.slack, s.u);
  }
  if (!line_.p.solver.energies) return s;
  wires_.multiply(s.u, x_);
  line_.add_springs(1, s.u, x_);
  s.elastic = 0.5 * (s.u.dot(x_) - loose_energy(s));
  return s;
}

Variation Hht::at_rest_variation(const Loads& dloads, const VectorXd& slack) {
  const BlockCholesky factor = static_factor();
  Variation v{at_rest_if_taut(factor, dloads), all()};
  if (slack.size() > 0 && slack.maxCoeff() > 0) {
    const DropperResponse response(line_.mesh, factor, 1);
    trial_forces(v.d.u, v.d.a, 0);
    slackening_.solve_variation(trial_, response, slack, v.d.slack);
    response.add(1, line_.shape.stiffness, v.d.slack, no_slack_, v.d.u);
  }
  return v;
}

void Hht::jump(const Loads& l0, const Loads& l1, LineState& s) {
  if (l0 == l1) return;
  x_.setZero();
  l1.add_to(x_, 1);
  l0.add_to(x_, -1);
  s.internal -= x_;
  mass_factor_.solve(x_);
  s.a += x_;
}

bool Hht::step(const StepFactors& f, const Loads& l1, const LineState& from, LineState& to) {
  const VectorXd* a = &from.a;
  if (from.h > 0 && from.h != f.h) {
    x_ = from.a;
    move_memory(f.hht_alpha, from.h, f.h, from.a_slope, x_);
    a = &x_;
  }
  sweeps::predict(
      operators(), f, all(),
      {from.u.data(), from.v.data(), a->data(), from.internal.data(), to.u.data(), to.v.data(), to.a.data()});
  line_.add_springs(-f.weight, to.u, to.a);
  l1.add_to(to.a, f.weight);
  f.factor.solve(to.a);
  trial_forces(to.u, to.a, f.beta_h2);
  trial_ += f.tension;
  to.slack = from.slack;
  const std::optional<int> solved = slackening_.solve(trial_, f.droppers, to.slack);
  if (!solved) return false;
  f.droppers.add(f.weight, line_.shape.stiffness, to.slack, line_.shape.slack, to.a);
  const bool slope_known = tells_slope(f.h, from.h);
  if (!slope_known) to.a_slope = from.a_slope;
  if (!sweeps::correct(operators(), f, all(),
                       {to.a.data(), from.internal.data(), a->data(), to.u.data(), to.v.data(), to.internal.data(),
                        slope_known ? to.a_slope.data() : nullptr}))
    return false;
  to.h = f.h;
  to.statistics = from.statistics;
  to.statistics.steps += 1;
  to.statistics.add_attempt(*solved);
  return true;
}

// The loss is that at the mean velocity: with hht_alpha = 0 and no change of the slack droppers the energies then
// balance to rounding.
void Hht::account(const StepFactors& f, const Loads& l0, const Loads& l1, const LineState& from, LineState& to) {
  const sweeps::Products p = sweeps::account(
      operators(), all(), {to.u.data(), to.v.data(), to.internal.data(), from.v.data(), to.damping.data()});
  to.kinetic = 0.5 * p.v_mass_v;
  to.loss_power = p.v_damping;
  to.dissipated = from.dissipated + 0.25 * f.h * (from.loss_power + 2 * p.old_v_damping + to.loss_power);
  to.work = from.work + 0.5 * (l0.dot(to.u) + l1.dot(to.u) - l0.dot(from.u) - l1.dot(from.u));
  // u' K u from the internal forces, which hold K u, the slack droppers and less the contact forces.
  double strain = p.u_internal - p.u_damping + l1.dot(to.u);
  for (int j = 0; j < static_cast<int>(to.slack.size()); ++j)
    if (const double more = to.slack[j] - line_.shape.slack[j]; more != 0)
      strain -= line_.shape.stiffness[j] * more * stretch(line_.mesh, to.u, j);
  to.elastic = 0.5 * (strain - loose_energy(to));
}

double Hht::kinetic_change(const LineState& s, const VectorXd& dv) {
  mass_.multiply(dv, x_);
  return s.v.dot(x_);
}

void Hht::step_variation(const StepFactors& f, const Loads& dl1, const LineState& to, Variation& v) {
  LineState& d = v.d;
  const auto one_more = [&](Range on) { return Range{std::max(on.begin - 1, 0), std::min(on.end + 1, all().end)}; };
  const bool slope_known = tells_slope(f.h, d.h);
  Range on = v.on;
  if (!on.empty()) {
    on = one_more(on);
    const auto in = [&](VectorXd& x) { return x.segment(4 * on.begin, 4 * on.count()); };
    auto a = in(d.a);
    move_memory(f.hht_alpha, d.h, f.h, in(d.a_slope), a);
    if (slope_known) in(d.a_slope) = a;
    sweeps::predict(operators(), f, on,
                    {d.u.data(), d.v.data(), d.a.data(), d.internal.data(), d.u.data(), d.v.data(), d.a.data()});
    line_.add_springs(-f.weight, d.u, d.a);
  }
  dl1.add_to(d.a, f.weight);
  for (const PointLoad& l : dl1.on)
    if (!l.value.isZero(0)) on = on.with({l.place.station, l.place.station + 2});
  if (on.empty()) return;
  on = on.with(f.factor.solve(d.a, on));
  if ((to.slack.array() > 0).any()) {
    trial_forces(d.u, d.a, f.beta_h2);
    slackening_.solve_variation(trial_, f.droppers, to.slack, d.slack);
    on = on.with(f.droppers.add(f.weight, line_.shape.stiffness, d.slack, no_slack_, d.a));
  } else {
    d.slack.setZero();
  }
  v.on = on = one_more(on);
  sweeps::correct(operators(), f, on,
                  {d.a.data(), d.internal.data(), d.a_slope.data(), d.u.data(), d.v.data(), d.internal.data(),
                   slope_known ? d.a_slope.data() : nullptr});
  d.h = f.h;
}

}  // namespace zspring::catenary
