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
// What a force does within a step to the wire over the other pantograph is left out: waves need longer.
#pragma once

#include "communication_step.hpp"
#include "hht.hpp"

namespace zspring::catenary {

struct AffineMap {
  double free = 0;                      // m, over the line's datum
  double compliance = 0, previous = 0;  // m/N
};
ZSPRING_MEMBERS(AffineMap, free, compliance, previous)

class Foresight {
 public:
  Foresight(const Line& line, Hht& hht);

  // Leads the line through a step; false, with `s` without meaning, when no set of slack droppers fits. With
  // `end_unknown` the next look() does not know the forces at its end.
  [[nodiscard]] bool advance(const CommunicationStep& step, LineState& s, bool end_unknown);
  // At rest, in the static state `s` under forces that the next look() does not know.
  void begin_at_rest(const LineState& s);
  // The maps of the step of `length` s from `s`, with the speeds that it has; the forces are guessed to stay.
  [[nodiscard]] bool look(const LineState& s, double length, AffineMap maps[pantographs]);

 private:
  // How the state varies with the force on one pantograph at the begin or at the end of a step.
  struct Variation {
    LineState d;
    bool is_used;

    void begin(bool used);
  };
  bool through(const CommunicationStep& step, LineState& s, bool with_energies);
  bool is_there(const Passage& at, int i) const;

  const Line& line_;
  Hht& hht_;
  LineState ahead_;
  Variation of_begin_[pantographs], of_end_[pantographs];
};

double height_under(const Line& line, const LineState& s, int i);  // m, of the wire over the datum

}  // namespace zspring::catenary
