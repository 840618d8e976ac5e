// What a user can set: parameters and inputs of the overhead line; its outputs are in outputs.cpp.
//
// SI units throughout, upward positive. Height 0 is the contact wire's at a dropper without pre-sag; uplifts are
// measured from the unloaded static shape. There are no default values here: the model description holds them.
#pragma once

#include "common/signal.hpp"

namespace zspring::catenary {

constexpr int most_spans = 40;
constexpr int most_supports = most_spans + 1;
constexpr int most_droppers = 20;  // of a span
constexpr int most_points = 8;
constexpr int pantographs = 2;

enum class Travel { Speed = 1, Position };

struct WireParameters {
  double mass;     // kg/m, > 0
  double tension;  // N, > 0
  double EI;       // N m2, bending stiffness, >= 0
};

struct DropperParameters {
  int count;                       // in each span
  double position[most_droppers];  // m, from the span's begin, ascending
  double sag[most_droppers];       // m, by how much the contact wire hangs lower there
  double stiffness;                // N/m, of a dropper of any length, where EA is 0
  double EA;                       // N
  double mass;                     // kg/m
  double clamp_contact;            // kg, on the contact wire
  double clamp_messenger;          // kg, on the messenger
};

struct Parameters {
  int spans;
  double span;         // m
  double encumbrance;  // m, of the messenger over the contact wire at the supports
  WireParameters contact_wire, messenger;
  DropperParameters dropper;
  double support_stiffness;     // N/m, under the messenger
  double steady_arm_mass;       // kg, on the contact wire at the supports
  double steady_arm_stiffness;  // N/m
  double damping_mass;          // 1/s, Rayleigh: C = damping_mass M + damping_stiffness K of the wires
  double damping_stiffness;     // s
  double gravity;               // m/s2
  Travel travel;
  double start[pantographs];           // m, Travel::Speed
  double point_position[most_points];  // m
  double element;                      // m, longest element
  double step;                         // s, largest internal step
  double hht_alpha;                    // [-1/3, 0]
};

// Each reaches its value at the end of the communication step, in a straight line from the last one.
struct PantographInputs {
  Signal force;     // N, upward on the contact wire
  Signal speed;     // m/s, Travel::Speed
  Signal position;  // m, Travel::Position
};

struct Inputs {
  PantographInputs pantograph[pantographs];
};

template <class Visitor>
void visit(Inputs& u, Visitor&& f) {
  for (PantographInputs& p : u.pantograph)
    zspring::visit(p.force, f), zspring::visit(p.speed, f), zspring::visit(p.position, f);
}

// The calculated parameters.
struct LineFacts {
  double length = 0;             // m
  double dropper_force_min = 0;  // N, in the static state
};

}  // namespace zspring::catenary
