#include "serialization.hpp"

#include <cstdint>
#include <cstring>

#include "common/checksum.hpp"
#include "instance.hpp"
#include "variables.inc"

namespace zspring::fmi {
namespace {

constexpr char magic[8] = {'z', 's', 'p', 'r', 'i', 'n', 'g', '1'};

struct Header {
  char magic[8];
  char guid[40];  // of the model description: a state of other variables does not fit
  std::uint64_t count;
  std::uint64_t checksum;
};
static_assert(sizeof(ZSPRING_GUID) <= sizeof(Header::guid) && sizeof(Header) == 64);

Header header_of(const Numbers& numbers) {
  Header h{};
  std::memcpy(h.magic, magic, sizeof magic);
  std::memcpy(h.guid, ZSPRING_GUID, sizeof(ZSPRING_GUID));
  h.count = numbers.size();
  h.checksum = checksum(numbers.data(), numbers.size() * sizeof(double));
  return h;
}

}  // namespace

std::size_t serialized_size(const Numbers& numbers) { return sizeof(Header) + numbers.size() * sizeof(double); }

void serialize(const Numbers& numbers, char* bytes) {
  const Header h = header_of(numbers);
  std::memcpy(bytes, &h, sizeof h);
  std::memcpy(bytes + sizeof h, numbers.data(), numbers.size() * sizeof(double));
}

Numbers deserialize(const char* bytes, std::size_t size) {
  Header h;
  if (size < sizeof h) refuse("serialized state: too short to be one");
  std::memcpy(&h, bytes, sizeof h);
  if (std::memcmp(h.magic, magic, sizeof magic) != 0 || std::memcmp(h.guid, ZSPRING_GUID, sizeof(ZSPRING_GUID)) != 0)
    refuse("serialized state: comes from another FMU or another version of this one; must have GUID " ZSPRING_GUID);
  if (h.count != (size - sizeof h) / sizeof(double) || (size - sizeof h) % sizeof(double) != 0)
    refuse("serialized state: its length is not what its header tells; it was cut or extended");
  Numbers numbers(h.count);
  std::memcpy(numbers.data(), bytes + sizeof h, numbers.size() * sizeof(double));
  const Header expected = header_of(numbers);
  if (std::memcmp(&expected, &h, sizeof h) != 0) refuse("serialized state: damaged, its checksum does not fit");
  return numbers;
}

}  // namespace zspring::fmi
