// States that are kept, restored, serialised and damaged.
#include <algorithm>
#include <cstdio>

#include "subject.hpp"

namespace fuzz {
namespace {

double number_at(const std::vector<char>& bytes, std::size_t i) {
  double x;
  std::memcpy(&x, bytes.data() + header_size + i * sizeof x, sizeof x);
  return x;
}

void repair(std::vector<char>& bytes) {
  const std::uint64_t count = (bytes.size() - header_size) / sizeof(double);
  std::memcpy(bytes.data() + count_at, &count, sizeof count);
  std::uint64_t hash = 14695981039346656037u;
  for (std::size_t i = header_size; i < bytes.size(); ++i)
    hash = (hash ^ static_cast<unsigned char>(bytes[i])) * 1099511628211u;
  std::memcpy(bytes.data() + checksum_at, &hash, sizeof hash);
}

}  // namespace

void damage(std::vector<char>& bytes, Bytes& in) {
  if (bytes.size() < header_size + sizeof(double)) return;
  const std::size_t numbers = (bytes.size() - header_size) / sizeof(double);
  const std::size_t at = in.byte() + 256u * in.byte();
  switch (in.below(5)) {
    case 0:
      bytes[at % bytes.size()] = static_cast<char>(bytes[at % bytes.size()] ^ (1 << in.below(8)));
      break;
    case 1:
      bytes.resize(at % bytes.size());
      break;
    case 2:
      bytes.resize(bytes.size() + 1 + at % 100);
      break;
    case 3:
      bytes.resize(header_size + at % numbers * sizeof(double));
      if (bytes.size() > header_size) repair(bytes);
      break;
    default: {
      // Mostly the first numbers and the last: parameters, inputs, times; what the last step held.
      const std::size_t from_end[] = {at % numbers, at % std::min<std::size_t>(numbers, 100),
                                      numbers - 1 - at % std::min<std::size_t>(numbers, 100)};
      const double x = in.number();
      std::memcpy(bytes.data() + header_size + in.pick(from_end) * sizeof x, &x, sizeof x);
      repair(bytes);
    }
  }
}

void Subject::keep(KeptState& kept) {
  begin_call();
  judge("fmi2GetFMUstate", fmi2GetFMUstate(component_, &kept.state), Ok);
  kept.expected = expected_;
  counts_.states += 1;
}

void Subject::go_back(const KeptState& kept) {
  if (!kept.state) return;
  begin_call();
  judge("fmi2SetFMUstate", fmi2SetFMUstate(component_, kept.state), Ok);
  expected_ = kept.expected;
  if (expected_.foreign) adopt();
  if (has_stepped(expected_.state)) check_values();
}

void Subject::refuse(const KeptState& theirs) {
  if (!theirs.state) return;
  begin_call();
  judge("fmi2SetFMUstate", fmi2SetFMUstate(component_, theirs.state), Refused);
}

// From a state of damaged bytes: what can be learnt from it.
void Subject::adopt() {
  const double phase = number_at(snapshot(), 0);
  expected_.state = static_cast<State>(std::lround(std::log2(phase)));
  if (!(phase >= 1 && phase <= 32) || std::ldexp(1, expected_.state) != phase)
    fault("fmi2SetFMUstate", "no state of an FMU");
  expected_.has_stop = false;
  if (has_stepped(expected_.state)) adopt_time();
}

void Subject::adopt_time() {
  begin_call();
  judge("fmi2GetRealStatus", fmi2GetRealStatus(component_, fmi2LastSuccessfulTime, &expected_.time), Ok);
}

void Subject::forget(KeptState& kept) {
  begin_call();
  judge("fmi2FreeFMUstate", fmi2FreeFMUstate(component_, &kept.state), Ok);
  if (kept.state) fault("fmi2FreeFMUstate", "left the pointer");
}

std::vector<char> Subject::serialize(const KeptState& kept) {
  std::size_t size = 0;
  begin_call();
  judge("fmi2SerializedFMUstateSize", fmi2SerializedFMUstateSize(component_, kept.state, &size),
        kept.state ? Ok : Refused);
  std::vector<char> bytes(size);
  if (!kept.state) return bytes;
  begin_call();
  judge("fmi2SerializeFMUstate", fmi2SerializeFMUstate(component_, kept.state, bytes.data(), size - 1), Refused);
  begin_call();
  judge("fmi2SerializeFMUstate", fmi2SerializeFMUstate(component_, kept.state, bytes.data(), size), Ok);
  return bytes;
}

void Subject::deserialize(const std::vector<char>& bytes, KeptState& kept, const Expected* original) {
  begin_call();
  if (judge("fmi2DeSerializeFMUstate", fmi2DeSerializeFMUstate(component_, bytes.data(), bytes.size(), &kept.state),
            bytes.empty() ? Refused
            : original    ? Ok
                          : Ok | Refused) != fmi2OK)
    return;
  kept.expected = original ? *original : Expected{};
  if (!original) {
    kept.expected.foreign = true;
    counts_.foreign_states += 1;
  }
}

void Subject::replay(Bytes& in) {
  if (!is_stepping(expected_.state)) return;
  const Bytes script = in;
  const unsigned n = 1 + in.below(4);
  const double lengths[] = {1e-3, 2e-3, 0.01, 3e-4};
  const auto run = [&](Bytes choices) {
    std::vector<double> record = all_values();
    choices.below(4);
    for (unsigned i = 0; i < n; ++i) {
      set_input(choices);
      record.push_back(step_to(expected_.time, choices.pick(lengths)));
      const std::vector<double> values = all_values();
      record.insert(record.end(), values.begin(), values.end());
    }
    return record;
  };
  const auto compare = [&](const char* function, const std::vector<double>& a, const std::vector<double>& b) {
    const std::size_t row = variable_count + 1;  // after each step whether it was made, then all values
    for (std::size_t k = 0; k < a.size(); ++k) {
      if (std::memcmp(&a[k], &b[k], sizeof a[k]) == 0) continue;
      const std::size_t column = (k + 1) % row;
      char text[200];
      std::snprintf(text, sizeof text, "after %zu steps from it, %s = %.17g, once it was %.17g", (k + 1) / row,
                    column ? variables[column - 1].name : "step made", b[k], a[k]);
      fault(function, text);
    }
  };
  KeptState kept, again;
  keep(kept);
  const std::vector<double> first = run(script);
  go_back(kept);
  compare("fmi2SetFMUstate", first, run(script));
  deserialize(serialize(kept), again, &kept.expected);
  go_back(again);
  compare("fmi2DeSerializeFMUstate", first, run(script));
  forget(kept);
  forget(again);
  for (unsigned used = 0; used < 1 + 4 * n && !in.done(); ++used) in.byte();
  counts_.replays += 1;
}

}  // namespace fuzz
