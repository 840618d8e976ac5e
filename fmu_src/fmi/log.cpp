#include "log.hpp"

#include <cstring>

namespace zspring::fmi {
namespace {

#define ZSPRING_CATEGORY_NAME(name) #name,
constexpr const char* names_of_categories[] = {ZSPRING_LOG_CATEGORIES(ZSPRING_CATEGORY_NAME)};

constexpr unsigned bit(Category c) { return 1u << static_cast<int>(c); }
constexpr unsigned all = (1u << std::size(names_of_categories)) - 1;
// Why a call was refused is no debug output.
constexpr unsigned always = bit(Category::logStatusError) | bit(Category::logStatusDiscard);

}  // namespace

Log::Log(const fmi2CallbackFunctions& functions, const char* instance_name, bool debug)
    : logger_(functions.logger),
      environment_(functions.componentEnvironment),
      instance_name_(instance_name),
      mask_(debug ? all : always) {}

void Log::write(fmi2Status status, Category category, const Text& message) const {
  if (!logger_ || !enabled(category)) return;
  // Hosts read the message as a printf format (%), and #r1# in it as a variable (section 2.1.5).
  char escaped[2 * sizeof message.chars];
  size_t n = 0;
  for (const char* c = message.chars; *c; ++c) {
    if (*c == '%' || *c == '#') escaped[n++] = *c;
    escaped[n++] = *c;
  }
  escaped[n] = '\0';
  logger_(environment_, instance_name_.c_str(), status, names_of_categories[static_cast<int>(category)], escaped);
}

const char* Log::enable(bool on, size_t n, const fmi2String names[]) {
  unsigned chosen = n == 0 ? all : 0;
  for (size_t i = 0; i < n; ++i) {
    const char* name = names ? names[i] : nullptr;
    unsigned found = 0;
    for (size_t k = 0; name && k < std::size(names_of_categories); ++k)
      if (std::strcmp(name, names_of_categories[k]) == 0) found = bit(static_cast<Category>(k));
    if (!found) return name ? name : "(null)";
    chosen |= found & bit(Category::logAll) ? all : found;
  }
  mask_ = (on ? chosen : mask_ & ~chosen) | always;
  return nullptr;
}

}  // namespace zspring::fmi
