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
};

class Hht {
 public:
  explicit Hht(const Line& line);

  // The factors for steps of h s; h is rounded to 36 bits, so that hosts whose steps differ by rounding alone do
  // not have them computed anew. Keeps the last few.
  const StepFactors& factors(double h);

  // At rest in equilibrium under `loads`; none where no set of slack droppers fits.
  std::optional<LineState> at_rest(const Loads& loads);
  LineState at_rest_variation(const Loads& dloads, const VectorXd& slack);  // slack: of the state at rest
  // From the loads `l0`, at its begin, to `l1`. False, with `s` without meaning, when no set of slack droppers fits.
  // The energies, and the damping forces that they are made of, may be left out: a third of the work.
  [[nodiscard]] bool step(const StepFactors& f, const Loads& l0, const Loads& l1, LineState& s,
                          bool with_energies = true);
  // The same for a variation `d` of the state that the step led to `to` from; what is slack stays slack. Of
  // the energies it knows the kinetic one.
  void step_variation(const StepFactors& f, const Loads& dl1, const LineState& to, LineState& d);
  // The contact forces jump from `l0` to `l1` between two steps; HHT's memory goes with them, else the first step
  // would still feel the old ones.
  void jump(const Loads& l0, const Loads& l1, LineState& s);

 private:
  BlockCholesky static_factor() const;
  LineState at_rest_if_taut(const BlockCholesky& factor, const Loads& loads) const;  // no dropper slack
  void add_slack(const DropperResponse& response, double factor, const VectorXd& slack, VectorXd& x) const;
  void predict(const StepFactors& f, const Loads& l1, LineState& s);
  void correct(const StepFactors& f, LineState& s);
  void trial_forces(const VectorXd& u, const VectorXd& a, double beta_h2);

  const Line& line_;
  const WireOperator wires_, mass_;
  BlockCholesky mass_factor_;
  Slackening slackening_;
  std::unique_ptr<StepFactors> factors_[4];   // the last used first
  VectorXd x_, y_, mv_, ma_, old_v_, trial_;  // workspace
};

}  // namespace zspring::catenary
