// The wire at the end of the next communication step, as a function of contact forces that nobody knows yet.
//
// A step of the line is affine in them as long as no dropper changes between slack and taut: under a pantograph
//
//   height = free + previous F(begin) + compliance F(end),   the force going straight from F(begin) to F(end)
//
// Both compliances are variations of the step itself. A pantograph that meets this wire and a line that is then told
// its force have solved the step as one system, without a step done twice.
//
//   Sequential   the pantograph steps first: the force input is that at the end of the line's step. F(begin) of the
//                next step is known and in `free`, but for the first.
//   Parallel     both step at once: the force input is that at the begin of the line's step. The line corrects the step
//                before, which it made with a guess, makes this one with a guess, and tells the map of the next.
//
// The step that the map is made of, with forces that stay, is the next step itself but for the forces that were not
// known. Its variations, times these, added to it, it need not be made again (superposition), unless a dropper slackens
// or tightens otherwise, or the pantographs went another way.
//
// What a force does within a step to the wire over the other pantograph is left out of the map: waves need longer.
#pragma once

#include "communication_step.hpp"
#include "hht.hpp"

namespace zspring::catenary {

struct AffineMap {
  double free = 0;                      // m, over the line's datum
  double compliance = 0, previous = 0;  // m/N
};
ZSPRING_MEMBERS(AffineMap, free, compliance, previous)

// Changes of the forces, N, against those that a step was made with.
struct ForceChange {
  double begin[pantographs] = {}, end[pantographs] = {};
};

class Foresight {
 public:
  Foresight(const Line& line, Hht& hht);

  // Leads the line from `from`, which is kept, through a step to `to`; false, with that without meaning, when no set of
  // slack droppers fits. `end_varies`: finds how `to` varies with the forces at its end.
  [[nodiscard]] bool advance(const CommunicationStep& step, const LineState& from, LineState& to, bool end_varies);

  // What the next look() is to take for unknown of the forces at its begin: nothing; those at the end of the last
  // step, one with an end that varies or a foreseen one with what that left of its bounds; those under which the line
  // rests in the state `s`.
  void begin_known();
  void begin_unknown(double room);
  void begin_at_rest(const LineState& s);
  // The maps of the step of `length` s from `s`, with the speeds that it has; the forces are guessed to stay.
  [[nodiscard]] bool look(const LineState& s, double length, AffineMap maps[pantographs]);

  // Whether the last look() was at this step, but for its forces, and no dropper slackens or tightens otherwise. take()
  // then is advance(), once; it returns which share is left of the bounds of the forces at the end.
  bool foresaw(const CommunicationStep& step, const ForceChange& change) const;
  double take(const CommunicationStep& step, const LineState& from, const ForceChange& change, LineState& to);
  // The same for the last step, `step` from `from` to `to` with other forces at its end, which were unknown.
  bool can_correct(const CommunicationStep& step, const ForceChange& change) const;
  void correct(const CommunicationStep& step, const LineState& from, const ForceChange& change, LineState& to);

  // The line is in another state than it was led to.
  void forget() { foreseen_ = 0; }
  bool has_looked() const { return foreseen_ > 0; }

 private:
  // How a state varies with the force on one pantograph at the begin or at the end of a step, and by how much, N, that
  // may change with every dropper as slack or taut as it is.
  struct OfForce : Variation {
    explicit OfForce(const Line& line) : Variation(of_nothing(line)) {}

    bool is_used = false;
    double least = 0, most = 0;

    void begin(bool used);
    double part(double change) const;
  };
  struct OfForces {
    OfForces(const Line& line) : on{OfForce(line), OfForce(line)} {}

    OfForce on[pantographs];

    double part(const double change[pantographs]) const;
    void add_to(LineState& s, const double change[pantographs]) const;
  };
  bool through(const CommunicationStep& step, const LineState& from, LineState& to, bool with_energies, OfForces* begin,
               OfForces* end);
  void bound(const LineState& s, OfForce& v) const;
  bool is_there(const Passage& at, int i) const;
  bool can_superpose(const CommunicationStep& step) const;
  void finish(const CommunicationStep& step, const LineState& from, LineState& to);

  const Line& line_;
  Hht& hht_;
  LineState ahead_, between_, jumped_;
  double foreseen_ = 0;          // s, the length of the step to ahead_; 0 of none
  OfForces last_, begin_, end_;  // of the last step by its end, of the one ahead by both
};

double height_under(const Line& line, const LineState& s, int i);  // m, of the wire over the datum

}  // namespace zspring::catenary
