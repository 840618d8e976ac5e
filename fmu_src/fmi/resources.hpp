// Files of the FMU's resources, through the location that a host gives.
#pragma once

#include <string>

namespace zspring::fmi {

// The bytes of a file there. `location` is a URI of scheme file, with one, two, three or four slashes, of a folder with
// or without a slash at its end, percent-encoded or not; or a plain path, as some hosts give it.
// Throws Refusal where there is no location, or no such file.
std::string read_resource(const char* location, const char* file);

}  // namespace zspring::fmi
