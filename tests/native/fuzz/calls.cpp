// Reads bytes as a sequence of FMI calls on a few instances, with a few states and their serialised forms, and
// judges each call (subject.hpp). The target of libFuzzer.
#include "calls.hpp"

#include <algorithm>

namespace fuzz {
namespace {

constexpr int instances = 3, states = 3;

}  // namespace

Counts run(const std::uint8_t* data, std::size_t size) {
  Counts counts;
  Bytes in(data, size);
  KeptState kept[instances][states];  // of each instance its own: they go from one to another as bytes alone
  std::vector<char> bytes;
  bool damaged = false;
  Expected original;
  Subject subjects[instances] = {Subject(counts), Subject(counts), Subject(counts)};
  while (!in.done()) {
    const unsigned which = in.one_in(4) ? in.below(instances) : 0;
    Subject& s = subjects[which];
    if (!s.exists()) {
      s.instantiate(in);
      continue;
    }
    const unsigned place = in.below(states);
    KeptState& state = kept[which][place];
    switch (in.below(32)) {
      case 0:
        s.free();
        std::fill_n(kept[which], states, KeptState());
        break;
      case 1:
        s.setup(in);
        break;
      case 2:
        s.enter_initialization();
        break;
      case 3:
        s.exit_initialization();
        break;
      case 4:
        s.terminate();
        break;
      case 5:
        s.reset();
        break;
      case 6:
        s.get_output_derivatives(in);
        break;
      case 7:
        s.directional_derivative(in);
        break;
      case 8:
        s.never_allowed(in);
        break;
      case 9:
        s.set_debug_logging(in);
        break;
      case 10:
        s.forget(state);
        break;
      case 11:
      case 12:
        s.keep(state);
        break;
      case 13:
      case 14:
        s.refuse(kept[(which + 1) % instances][place]);
        s.go_back(state);
        break;
      case 15:
      case 16:
        bytes = s.serialize(state);
        original = state.expected;
        damaged = original.foreign;
        break;
      case 17:
        damaged = true;
        damage(bytes, in);
        break;
      case 18:
        damaged = true;
        damage(bytes, in);
        s.deserialize(bytes, state, nullptr);
        break;
      case 19:
        s.deserialize(bytes, state, damaged || bytes.empty() ? nullptr : &original);
        break;
      case 20:
        s.replay(in);
        break;
      case 21:
      case 22:
        s.start();
        break;
      case 23:
      case 24:
        s.get(in);
        break;
      case 25:
      case 26:
        s.set(in);
        break;
      case 27:
        s.set_input(in);
        break;
      case 28:
        s.set_input_derivatives(in);
        break;
      default:
        s.step(in);
    }
  }
  for (unsigned i = 0; i < instances; ++i)
    for (KeptState& k : kept[i])
      if (subjects[i].exists()) subjects[i].forget(k);
  return counts;
}

}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::run(data, size);
  return 0;
}
