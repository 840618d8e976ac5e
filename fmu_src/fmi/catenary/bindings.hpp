// The overhead line as the FMI layer sees it: each variable of its model description, but the outputs, and what it
// stands for.
#pragma once

#include "catenary/simulation.hpp"

namespace zspring::fmi {
using catenary::Inputs;
using catenary::Parameters;
using catenary::Simulation;
using Calculated = catenary::LineFacts;
}  // namespace zspring::fmi

#include "binding.hpp"

namespace zspring::fmi {

PARAMETER(line_dot_spans, spans)
PARAMETER(line_dot_span, span)
PARAMETER(line_dot_encumbrance, encumbrance)
PARAMETER(contact_wire_dot_mass, contact_wire.mass)
PARAMETER(contact_wire_dot_tension, contact_wire.tension)
PARAMETER(contact_wire_dot_EI, contact_wire.EI)
PARAMETER(messenger_dot_mass, messenger.mass)
PARAMETER(messenger_dot_tension, messenger.tension)
PARAMETER(messenger_dot_EI, messenger.EI)
PARAMETER(dropper_dot_count, dropper.count)
PARAMETER(dropper_dot_position, dropper.position[i])
PARAMETER(dropper_dot_sag, dropper.sag[i])
PARAMETER(dropper_dot_stiffness, dropper.stiffness)
PARAMETER(dropper_dot_EA, dropper.EA)
PARAMETER(dropper_dot_mass, dropper.mass)
PARAMETER(dropper_dot_clamp_contact, dropper.clamp_contact)
PARAMETER(dropper_dot_clamp_messenger, dropper.clamp_messenger)
PARAMETER(support_dot_stiffness, support_stiffness)
PARAMETER(steady_arm_dot_mass, steady_arm_mass)
PARAMETER(steady_arm_dot_stiffness, steady_arm_stiffness)
PARAMETER(damping_dot_mass, damping_mass)
PARAMETER(damping_dot_stiffness, damping_stiffness)
PARAMETER(gravity, gravity)
PARAMETER(travel, travel)
PARAMETER(pantograph_dot_start, start[i])
PARAMETER(point_dot_position, point_position[i])
PARAMETER(mesh_dot_element, element)
PARAMETER(solver_dot_step, step)
PARAMETER(solver_dot_alpha, hht_alpha)

CALCULATED(line_dot_length, length)
CALCULATED(dropper_dot_static_force_min, dropper_force_min)

INPUT(pantograph_dot_force, pantograph[i].force)
INPUT(pantograph_dot_speed, pantograph[i].speed)
INPUT(pantograph_dot_position, pantograph[i].position)

}  // namespace zspring::fmi
