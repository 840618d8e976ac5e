// One step of HHT-alpha (common/hht.hpp) for the line, which is linear but for its slack droppers.
//
//   M a[n+1] + (1 + hht_alpha) R[n+1] - hht_alpha R[n] = 0,   R = C v + K u + slack droppers - contact forces
#pragma once

#include <memory>
#include <optional>

#include "common/hht.hpp"
#include "droppers.hpp"
#include "line.hpp"
#include "wire_operator.hpp"

namespace zspring::catenary {

// Of one length of step: factorised once for each.
struct StepFactors : HhtCoefficients {
  StepFactors(const Line& line, double h);

  BlockCholesky factor;      // of M + (1 + hht_alpha) (gamma h C + beta h^2 K)
  DropperResponse droppers;  // its compliance is that of u at the end of a step to a dropper's force there
  VectorXd tension;          // N, of the droppers, from which their trial forces are counted
};

class Hht {
 public:
  explicit Hht(const Line& line);

  // The factors for steps of h s; h is rounded to 36 bits, so that hosts whose steps differ by rounding alone do
  // not have them computed anew. Keeps the last few.
  const StepFactors& factors(double h);

  // At rest in equilibrium under `loads`; none where no set of slack droppers fits.
  std::optional<LineState> at_rest(const Loads& loads);
  Variation at_rest_variation(const Loads& dloads, const VectorXd& slack);  // slack: of the state at rest
  // From the state `from` to another object `to`, under the loads `l1` at its end; energies aside. False, with `to`
  // without meaning, when no set of slack droppers fits or the values overflow.
  [[nodiscard]] bool step(const StepFactors& f, const Loads& l1, const LineState& from, LineState& to);
  // The energies of `to`, and the damping forces that they are made of, after that step under loads from `l0` on.
  void account(const StepFactors& f, const Loads& l0, const Loads& l1, const LineState& from, LineState& to);
  // The same step for a variation of the state that it led to `to` from; what is slack stays slack.
  void step_variation(const StepFactors& f, const Loads& dl1, const LineState& to, Variation& v);
  double kinetic_change(const LineState& s, const VectorXd& dv);  // J, with a change of the velocities
  // The contact forces jump from `l0` to `l1` between two steps; HHT's memory goes with them, else the first step
  // would still feel the old ones.
  void jump(const Loads& l0, const Loads& l1, LineState& s);

 private:
  BlockCholesky static_factor() const;
  LineState at_rest_if_taut(const BlockCholesky& factor, const Loads& loads) const;  // no dropper slack
  sweeps::Operators operators() const {
    return {wires_.rows(), mass_.rows(), line_.p.damping.stiffness, line_.p.damping.mass};
  }
  Range all() const { return {0, line_.mesh.stations()}; }
  void trial_forces(const VectorXd& u, const VectorXd& a, double beta_h2);
  double loose_energy(const LineState& s) const;

  const Line& line_;
  const WireOperator wires_, mass_;
  BlockCholesky mass_factor_;
  Slackening slackening_;
  const VectorXd no_slack_;
  std::unique_ptr<StepFactors> factors_[4];  // the last used first
  VectorXd x_, trial_;                       // workspace
};

}  // namespace zspring::catenary
