// What a user can set: parameters and inputs of the overhead line; its outputs are in outputs.cpp.
//
// SI units throughout, upward positive. Height 0 is the contact wire's at a dropper without pre-sag; uplifts are
// measured from the unloaded static shape. There are no default values here: the model description holds them.
#pragma once

#include "common/signal.hpp"

namespace zspring::catenary {

constexpr int most_droppers = 20;  // of a span
constexpr int most_points = 8;
constexpr int pantographs = 2;

enum class Travel { Speed = 1, Position };
// What a force input belongs to, and so what the next one is unknown for; affine_map.hpp.
enum class Exchange { Target = 1, Sequential, Parallel };

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

// Named and nested as the variables of the model description are, and in their order: so they find each other.
struct Parameters {
  struct {
    int spans;
    double span;         // m
    double encumbrance;  // m, of the messenger over the contact wire at the supports
  } line;
  WireParameters contact_wire, messenger;
  DropperParameters dropper;
  struct {
    double stiffness;  // N/m, under the messenger
  } support;
  struct {
    double mass;       // kg, on the contact wire at the supports
    double stiffness;  // N/m
  } steady_arm;
  struct {
    double mass;       // 1/s, Rayleigh: C = mass M + stiffness K of the wires
    double stiffness;  // s
  } damping;
  double gravity;  // m/s2
  Travel travel;
  struct {
    double start;         // m, Travel::Speed
    double static_force;  // N, under which its heights are 0 at the start; 0: they are over the line's datum
  } pantograph[pantographs];
  struct {
    double position[most_points];  // m
  } point;
  struct {
    double element;  // m, longest element
  } mesh;
  struct {
    double step;       // s, largest internal step
    double hht_alpha;  // [-1/3, 0]
    bool energies;     // are followed
  } solver;
  Exchange exchange;
  double exchange_step;  // s, the first communication step
};

// Each reaches its value at the end of the communication step, in a straight line from the last one.
struct PantographInputs {
  Signal force;     // N, upward on the contact wire
  Signal speed;     // m/s, Travel::Speed
  Signal position;  // m, Travel::Position
};
ZSPRING_MEMBERS(PantographInputs, force, speed, position)

struct Inputs {
  PantographInputs pantograph[pantographs];
};
ZSPRING_MEMBERS(Inputs, pantograph)

// The calculated parameters.
struct Calculated {
  struct {
    double length = 0;  // m
  } line;
  struct {
    double static_force_min = 0;  // N
  } dropper;
};

}  // namespace zspring::catenary
