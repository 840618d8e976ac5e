#pragma once

#include "subject.hpp"

namespace fuzz {

// Aborts at the first fault.
Counts run(const std::uint8_t* data, std::size_t size);

}  // namespace fuzz
