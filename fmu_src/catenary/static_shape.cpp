#include "static_shape.hpp"

#include <algorithm>

#include "block_cholesky.hpp"
#include "common/failure.hpp"
#include "droppers.hpp"

namespace zspring::catenary {
namespace {

// Deflections of the wires under `load` N, some degrees of freedom held at heights.
VectorXd hang(const SparseMatrix& wires, const VectorXd& load, const std::vector<int>& held, const VectorXd& heights) {
  VectorXd given = VectorXd::Zero(load.size());
  for (size_t i = 0; i < held.size(); ++i) given[held[i]] = heights[static_cast<Eigen::Index>(i)];
  VectorXd x = load - wires * given;
  for (int dof : held) x[dof] = given[dof];
  BlockCholesky(hold(wires, held)).solve(x);
  return x;
}

// The straight line between a wire's anchors, which the matrices hold at 0: heights are counted from it. It adds no
// force.
struct Straight {
  double begin, rise;  // m, 1
  double at(double x) const { return begin + rise * x; }
};

// Droppers get lengths that are not those of the shape as yet: the wires give way.
void settle(const Mesh& mesh, const SparseMatrix& stiffness, const VectorXd& too_long, StaticShape& shape) {
  const BlockCholesky factor(stiffness);
  const DropperResponse response(mesh, factor, 1);
  VectorXd trial = shape.tension, u = VectorXd::Zero(mesh.dofs());
  const int n = static_cast<int>(trial.size());
  for (int j = 0; j < n; ++j)
    if (too_long[j] != 0) response.relieve(j, -shape.stiffness[j] * too_long[j], shape.stiffness, trial);
  if (!Slackening(shape.stiffness).solve(trial, response, shape.slack))
    refuse("line.table: no static state with droppers of these lengths was found");
  response.add(1, shape.stiffness, shape.slack, too_long, u);
  shape.height += u;
  for (int j = 0; j < n; ++j) {
    const double change = stretch(mesh, u, j);
    shape.length[j] += change;
    shape.tension[j] += shape.stiffness[j] * (change - too_long[j]);
    shape.slack[j] = std::max(0.0, -shape.tension[j] / shape.stiffness[j]);
  }
}

}  // namespace

StaticShape static_shape(const Parameters& p, const LineTable& line, const Mesh& mesh, const Matrices& m) {
  const int n = static_cast<int>(mesh.droppers.size()), last = mesh.stations() - 1;
  const std::vector<Dropper>& droppers = line.droppers;
  StaticShape shape;
  shape.tension.resize(n), shape.length.resize(n), shape.stiffness.resize(n);
  shape.slack = VectorXd::Zero(n);
  const auto between = [&](double begin, double end) { return Straight{begin, (end - begin) / line.length()}; };
  const Straight contact = between(line.contact_begin, line.contact_end),
                 messenger = between(line.supports.front().messenger, line.supports.back().messenger);

  std::vector<int> held;
  std::vector<double> heights;
  const auto hold_at = [&](int dof, double height) { held.push_back(dof), heights.push_back(height); };
  const auto hanging = [&](const VectorXd& load) {
    return hang(m.wires, load, held, Eigen::Map<const VectorXd>(heights.data(), static_cast<int>(heights.size())));
  };
  for (int station : {0, last}) hold_at(deflection(station, Contact), 0), hold_at(deflection(station, Messenger), 0);
  for (size_t i = 1; i + 1 < mesh.supports.size(); ++i)
    hold_at(deflection(mesh.supports[i], Messenger), line.supports[i].messenger - messenger.at(line.supports[i].x));
  const std::vector<int> anchors_and_supports = held;
  for (int j = 0; j < n; ++j)
    hold_at(deflection(mesh.droppers[j], Contact), droppers[j].height - contact.at(droppers[j].x));
  const VectorXd contact_wire = hanging(-m.weight);
  const VectorXd carried = m.wires * contact_wire + m.weight;

  // The droppers' own weight depends on their lengths, and these on the messenger's sag under it.
  double half_weight_change = 1;
  VectorXd half_weight = VectorXd::Zero(n);
  for (int pass = 0; pass < 100 && half_weight_change > 1e-12; ++pass) {
    VectorXd load = -m.weight, now(n);
    for (int j = 0; j < n; ++j) {
      shape.tension[j] =
          carried[deflection(mesh.droppers[j], Contact)] + droppers[j].clamp_contact * p.gravity + half_weight[j];
      load[mesh.upper[j]] -= shape.tension[j] + droppers[j].clamp_upper * p.gravity + half_weight[j];
    }
    shape.height = hanging(load);
    for (int station = 0; station <= last; ++station) {
      const double above = messenger.at(mesh.x[station]);
      shape.height[deflection(station, Contact)] += contact.at(mesh.x[station]);
      shape.height[slope(station, Contact)] += contact.rise;
      shape.height[deflection(station, Messenger)] += above;
      shape.height[slope(station, Messenger)] += mesh.has_stitch(station) ? above : messenger.rise;
    }
    for (int j = 0; j < n; ++j) {
      shape.length[j] = stretch(mesh, shape.height, j);
      now[j] = 0.5 * droppers[j].mass * p.gravity * shape.length[j];
    }
    half_weight_change = n > 0 ? (now - half_weight).cwiseAbs().maxCoeff() : 0;
    half_weight = now;
  }

  const bool as_drawn = std::none_of(droppers.begin(), droppers.end(), [](const Dropper& d) { return d.length > 0; });
  const auto check_lengths = [&] {
    for (int j = 0; j < n; ++j)
      if (!(shape.length[j] > 0))
        refuse("%s: the dropper would be %.6g m long; %s must be larger", line.described(droppers[j]).chars,
               shape.length[j], line.of_parameters() ? "line.encumbrance" : "the encumbrance of its span");
  };
  VectorXd too_long = VectorXd::Zero(n);
  if (as_drawn) check_lengths();
  for (int j = 0; j < n; ++j) {
    const Dropper& d = droppers[j];
    if (as_drawn && !(shape.tension[j] >= 0))
      refuse("%s: in the static state the dropper would have to push, with %.6g N", line.described(d).chars,
             -shape.tension[j]);
    const double length = d.length > 0 ? d.length : shape.length[j];
    shape.stiffness[j] = d.EA > 0 ? d.EA / length : d.stiffness;
    if (d.length > 0) too_long[j] = d.length - (shape.length[j] - shape.tension[j] / shape.stiffness[j]);
    too_long[j] += d.length_error;
  }
  if (n > 0 && too_long.cwiseAbs().maxCoeff() > 0) {
    settle(mesh, hold(m.wires + dropper_stiffness(mesh, shape.stiffness), anchors_and_supports), too_long, shape);
    check_lengths();
  }
  return shape;
}

}  // namespace zspring::catenary
