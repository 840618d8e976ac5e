// The line as it is built: what stands where along it. Either like spans, from the parameters, or any line, from a
// table of numbers; the wires themselves are parameters in both.
//
// SI units, upward positive, places from the line's begin. The table's bytes: `magic`, then little-endian IEEE doubles
// in the order of the members below, each list after the number of its entries.
#pragma once

#include <cstddef>
#include <vector>

#include "common/failure.hpp"
#include "parameters.hpp"

namespace zspring::catenary {

enum Wire { Contact, Messenger };

struct Support {         // a span boundary; the first and the last are the anchors, where the last three are not used
  double x;              // m, of the first 0
  double messenger;      // m, height of the messenger over the datum
  double stiffness;      // N/m, under the messenger
  double arm_mass;       // kg, on the contact wire
  double arm_stiffness;  // N/m
};
struct Dropper {
  double x;              // m
  double on_stitch;      // 1: its upper end is on a stitch wire, 0: on the messenger
  double height;         // m, of the contact wire there over the datum
  double stiffness;      // N/m, of any length, where EA is 0
  double EA;             // N
  double mass;           // kg/m
  double clamp_contact;  // kg, on the contact wire
  double clamp_upper;    // kg, at the upper end
  double length;         // m, unstretched; 0: as the height asks for, else the height is what comes out
  double length_error;   // m, added to the unstretched length
};
struct StitchWire {
  double begin, end;  // m, of its clamps on the messenger
  double tension;     // N, which between the clamps the messenger has less
  double mass;        // kg/m
  double clamp;       // kg, of each clamp
};
struct PointMass {
  double x;     // m
  double wire;  // Contact or Messenger
  double mass;  // kg
};
// Irregularity of the contact wire, free of stress: cubic Hermite functions between the points, none outside of them.
struct ProfilePoint {
  double x;       // m
  double height;  // m
  double slope;   // 1
};

struct Irregularity {    // of the contact wire at a place
  double height = 0;     // m
  double slope = 0;      // 1
  double curvature = 0;  // 1/m
};

struct LineTable {
  static constexpr char name[] = "line";  // of the file, line.table
  static constexpr char magic[] = "zspline1";
  // Whether the table stands in for this parameter.
  static bool replaces(const char* parameter);

  // Throws Refusal for what is no table of a line.
  static LineTable of(const char* bytes, std::size_t size);
  // Like spans. Throws Refusal where droppers are not in order within the span.
  static LineTable of(const Parameters& p);

  double length() const { return supports.back().x; }
  bool of_parameters() const { return of_parameters_; }
  // "span 3, dropper 2, at 130.5 m", or the parameters that it comes from.
  Text described(const Dropper& dropper) const;
  Irregularity irregularity(double x) const;

  std::vector<Support> supports;
  double contact_begin = 0, contact_end = 0;  // m, heights of the contact wire at the anchors
  std::vector<Dropper> droppers;
  std::vector<StitchWire> stitches;
  std::vector<PointMass> masses;
  std::vector<ProfilePoint> profile;

 private:
  void check() const;
  Text place(double x) const;  // "span 3, at 130.5 m"

  bool of_parameters_ = false;
};

}  // namespace zspring::catenary
