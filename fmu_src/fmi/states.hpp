// The states that an instance has given to its host, which knows them by their addresses.
//
// A host may pass a pointer that it never initialised where a state is to be stored, or one of another instance: what
// is not known here is never written to, read or freed.
#pragma once

#include <memory>
#include <unordered_map>

#include "common/numbers.hpp"

namespace zspring::fmi {

class States {
 public:
  // The address of a state with these numbers: `place` where that is one, else a new one.
  void* keep(Numbers numbers, void* place) {
    const auto found = states_.find(place);
    if (found != states_.end()) return *found->second = std::move(numbers), place;
    auto state = std::make_unique<Numbers>(std::move(numbers));
    void* const address = state.get();
    states_.emplace(address, std::move(state));
    return address;
  }
  // Throw Refusal for what is none.
  const Numbers& of(void* state) const {
    const auto found = states_.find(state);
    if (found == states_.end()) refuse("FMUstate = %p: must be a state that this instance has given", state);
    return *found->second;
  }
  void forget(void* state) { of(state), states_.erase(state); }

 private:
  std::unordered_map<void*, std::unique_ptr<Numbers>> states_;
};

}  // namespace zspring::fmi
