#include "resources.hpp"

#include <cctype>
#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>

#include "common/failure.hpp"

#ifdef _WIN32
#include <filesystem>
#endif

namespace zspring::fmi {
namespace {

constexpr std::size_t largest = std::size_t{1} << 26;  // bytes

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

#ifdef _WIN32
constexpr bool windows = true;
// In UTF-8 first; some hosts give what the system's code page makes of a path.
File open(const std::string& path) {
  try {
    if (std::FILE* file = _wfopen(std::filesystem::u8path(path).c_str(), L"rb")) return File(file);
  } catch (const std::exception&) {  // it is not UTF-8
  }
  return File(std::fopen(path.c_str(), "rb"));
}
#else
constexpr bool windows = false;
File open(const std::string& path) { return File(std::fopen(path.c_str(), "rb")); }
#endif

bool is_drive(const std::string& text, std::size_t at) {
  return text.size() > at + 1 && std::isalpha(static_cast<unsigned char>(text[at])) && text[at + 1] == ':';
}

int hexadecimal(char c) {
  const char* digits = "0123456789abcdef";
  const char* found = c ? std::strchr(digits, std::tolower(static_cast<unsigned char>(c))) : nullptr;
  return found ? static_cast<int>(found - digits) : -1;
}

// What is no code stays as it is: some hosts encode nothing.
std::string decoded(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const int high = text[i] == '%' && i + 2 < text.size() ? hexadecimal(text[i + 1]) : -1;
    const int low = high >= 0 ? hexadecimal(text[i + 2]) : -1;
    if (low >= 0)
      result += static_cast<char>(16 * high + low), i += 2;
    else
      result += text[i];
  }
  return result;
}

// The path that a URI of scheme file has behind the colon: //HOST/PATH, /PATH, or, of some hosts, DRIVE:PATH.
std::string path_in(std::string rest) {
  if (rest.compare(0, 2, "//") == 0) {
    const std::size_t end = rest.find('/', 2);
    const std::string host = rest.substr(2, end == std::string::npos ? end : end - 2);
    if (host.empty() || host == "localhost") rest.erase(0, 2 + host.size());
    if (windows && is_drive(host, 0)) rest.erase(0, 2);
  }
  std::size_t slashes = rest.find_first_not_of('/');
  if (windows && slashes != std::string::npos && is_drive(rest, slashes)) rest.erase(0, slashes);
  return rest;
}

bool begins_with_scheme(const std::string& location, const char* scheme) {
  for (std::size_t i = 0; scheme[i]; ++i)
    if (i >= location.size() || std::tolower(static_cast<unsigned char>(location[i])) != scheme[i]) return false;
  return true;
}

}  // namespace

std::string read_resource(const char* location, const char* file) {
  if (!location || !*location) refuse("fmuResourceLocation: must be given, as %s in the resources is needed", file);
  std::string given = location;
  if (const std::size_t end = given.find("://");
      end != std::string::npos && end > 1 && !begins_with_scheme(given, "file:"))
    refuse("fmuResourceLocation = %s: must be a URI that begins with file:", location);
  const bool is_uri = begins_with_scheme(given, "file:");
  const std::string written = is_uri ? path_in(given.substr(5)) : given;
  for (std::string path : {is_uri ? decoded(written) : written, written}) {
    if (path.empty() || path.back() != '/') path += '/';
    if (const File opened = open(path + file)) {
      std::string bytes;
      char part[4096];
      while (const std::size_t n = std::fread(part, 1, sizeof part, opened.get())) {
        bytes.append(part, n);
        if (bytes.size() > largest) refuse("%s%s: must be at most %zu bytes", path.c_str(), file, largest);
      }
      return bytes;
    }
  }
  refuse("fmuResourceLocation = %s: there is no %s", location, file);
}

}  // namespace zspring::fmi
