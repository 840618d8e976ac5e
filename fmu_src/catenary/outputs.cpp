#include <algorithm>

#include "simulation.hpp"

namespace zspring::catenary {
namespace {

// Index of the dropper that is nearest to a place; -1 without droppers.
int nearest_dropper(const Mesh& mesh, double place) {
  const std::vector<int>& stations = mesh.droppers;
  const auto after = std::lower_bound(stations.begin(), stations.end(), place,
                                      [&](int station, double limit) { return mesh.x[station] < limit; });
  const int j = static_cast<int>(after - stations.begin());
  if (j == 0) return stations.empty() ? -1 : 0;
  return after == stations.end() || place - mesh.x[after[-1]] <= mesh.x[*after] - place ? j - 1 : j;
}

// What the definitions are written with.
struct View {
  View(const Line& overhead, const SimulationState& state)
      : line(overhead), s(state.line), map(state.map), datum(state.datum) {
    for (int i = 0; i < pantographs; ++i) contact[i] = line.at(s.passage[i].position);
    for (int i = 0; i < most_points; ++i) {
      point[i] = line.at(line.p.point.position[i]);
      dropper[i] = nearest_dropper(line.mesh, line.p.point.position[i]);
    }
    double least = HUGE_VAL, most = -HUGE_VAL;
    for (int j = 0; j < static_cast<int>(line.mesh.droppers.size()); ++j) {
      const double force = dropper_force(j);
      slack += s.slack[j] > 0;
      if (force < least) least = force, weakest = j;
      if (force > most) most = force, strongest = j;
    }
  }

  bool pulls(int j) const { return !line.mesh.droppers.empty() && !(s.slack[j] > 0); }
  double dropper_force(int j) const {
    return pulls(j) ? line.shape.tension[j] + line.shape.stiffness[j] * stretch(line.mesh, s.u, j) : 0;
  }
  double force(int j) const { return j < 0 ? 0 : dropper_force(j); }
  double force_change(const LineState& d, int j) const { return j < 0 ? 0 : dropper_force_change(d, j); }
  double dropper_force_change(const LineState& d, int j) const {
    return pulls(j) ? line.shape.stiffness[j] * stretch(line.mesh, d.u, j) : 0;
  }

  const Line& line;
  const LineState& s;
  const AffineMap (&map)[pantographs];
  const double (&datum)[pantographs];              // m, of the heights under the pantographs
  Place contact[pantographs], point[most_points];  // under the pantographs; watched
  int dropper[most_points];                        // that is nearest to what is watched; -1: none
  Count slack = 0;                                 // droppers
  int weakest = 0, strongest = 0;                  // droppers
};

// Of the contact wire at a place that moves: its height over the line's datum, its lift from the unloaded shape,
// the rate of its height.
double height(const View& x, const Place& at) { return x.line.course(x.s.u, at).height; }
double uplift(const View& x, const Place& at) { return at.value.dot(at.of(x.s.u)); }
double velocity(const View& x, const Place& at, double speed) {
  return at.value.dot(at.of(x.s.v)) + speed * x.line.course(x.s.u, at).slope;
}

double height_change(const View& x, const Place& at, const LineState& d, const Passage& moved) {
  return at.value.dot(at.of(d.u)) + moved.position * x.line.course(x.s.u, at).slope;
}
double uplift_change(const View& x, const Place& at, const LineState& d, const Passage& moved) {
  return at.value.dot(at.of(d.u)) + moved.position * at.slope.dot(at.of(x.s.u));
}
double velocity_change(const View& x, const Place& at, double speed, const LineState& d, const Passage& moved) {
  const auto course = x.line.course(x.s.u, at);
  return at.value.dot(at.of(d.v)) + moved.position * at.slope.dot(at.of(x.s.v)) + speed * at.slope.dot(at.of(d.u)) +
         moved.speed * course.slope + speed * moved.position * course.curvature;
}

// Of the wires above a point, over the datum or, of a variation, by how much it varies.
double upper(const View& x, const VectorXd& all, int point, bool of_stitch) {
  return x.line.mesh.upper_deflection(all, x.point[point], of_stitch);
}
double upper_height(const View& x, int point, bool of_stitch) {
  return upper(x, x.s.u, point, of_stitch) + upper(x, x.line.shape.height, point, of_stitch);
}

double place_of_dropper(const View& x, int j) { return j < 0 ? 0 : x.line.mesh.x[x.line.mesh.droppers[j]]; }

double at_support(const View& x, const VectorXd& u, int i) {
  const std::vector<int>& supports = x.line.mesh.supports;
  return i < static_cast<int>(supports.size()) ? u[deflection(supports[i], Contact)] : 0;
}

const Passage stays;

}  // namespace
}  // namespace zspring::catenary

namespace zspring {
using namespace catenary;

LINEAR(pantograph_dot_x, passage[i].position)
OUTPUT(pantograph_dot_wire_height, height(x, x.contact[i]) - x.datum[i],
       height_change(x, x.contact[i], d, d.passage[i]))
OUTPUT(pantograph_dot_wire_velocity, velocity(x, x.contact[i], x.s.passage[i].speed),
       velocity_change(x, x.contact[i], x.s.passage[i].speed, d, d.passage[i]))
OUTPUT(pantograph_dot_uplift, uplift(x, x.contact[i]), uplift_change(x, x.contact[i], d, d.passage[i]))
OUTPUT(support_dot_uplift, at_support(x, x.s.u, i), at_support(x, d.u, i))
OUTPUT(point_dot_height, height(x, x.point[i]), height_change(x, x.point[i], d, stays))
OUTPUT(point_dot_uplift, uplift(x, x.point[i]), uplift_change(x, x.point[i], d, stays))
OUTPUT(point_dot_velocity, velocity(x, x.point[i], 0), velocity_change(x, x.point[i], 0, d, stays))
OUTPUT(point_dot_messenger_height, upper_height(x, i, false), upper(x, d.u, i, false))
OUTPUT(point_dot_stitch_height, upper_height(x, i, true), upper(x, d.u, i, true))
DISCRETE(point_dot_dropper_position, place_of_dropper(x, x.dropper[i]))
OUTPUT(point_dot_dropper_force, x.force(x.dropper[i]), x.force_change(d, x.dropper[i]))
DISCRETE(droppers_dot_slack, x.slack)
OUTPUT(droppers_dot_force_min, x.dropper_force(x.weakest), x.dropper_force_change(d, x.weakest))
OUTPUT(droppers_dot_force_max, x.dropper_force(x.strongest), x.dropper_force_change(d, x.strongest))
LINEAR(energy_dot_kinetic, kinetic)
LINEAR(energy_dot_elastic, elastic)
LINEAR(energy_dot_dissipated, dissipated)
LINEAR(energy_dot_work, work)
DISCRETE(solver_dot_steps, x.s.statistics.steps)
DISCRETE(solver_dot_iterations, x.s.statistics.iterations)
DISCRETE(solver_dot_iterations_max, x.s.statistics.iterations_max)
DISCRETE(pantograph_dot_free_height, x.map[i].free - x.datum[i])
DISCRETE(pantograph_dot_compliance, x.map[i].compliance)
DISCRETE(pantograph_dot_compliance_previous, x.map[i].previous)

}  // namespace zspring

namespace zspring::catenary {

Outputs Simulation::present_outputs() const { return output_values(View(line_, state_)); }
Outputs Simulation::change(const LineState& d) const { return output_changes(View(line_, state_), d); }

}  // namespace zspring::catenary
