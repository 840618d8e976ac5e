// One instance under test beside what it should be: each call goes to the FMU and is judged.
//
// A fault ends the program (abort), so that libFuzzer and the tests see it.
#pragma once

#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bytes.hpp"
#include "rules.hpp"

namespace fuzz {

// Of a serialised state (fmi/serialization.cpp): magic, GUID, count, checksum.
inline constexpr std::size_t header_size = 64, count_at = 48, checksum_at = 56;

// Which statuses a call may return.
enum Allowed : unsigned { Ok = 1 << fmi2OK, Refused = 1 << fmi2Error, Discarded = 1 << fmi2Discard };

struct Counts {
  unsigned long calls = 0, refused = 0, steps = 0, discarded = 0, states = 0, foreign_states = 0, replays = 0;
  std::set<std::pair<std::string, State>> situations;  // which call was made in which state
};

// What the FMU's state should be.
struct Expected {
  State state = Instantiated;
  double time = 0, stop = 0;
  bool has_stop = false;
  // Holds numbers that were never computed: damaged bytes that the FMU accepted. Statuses are not foretold.
  bool foreign = false;
  std::array<double, variable_count> value{};  // of inputs and parameters
};

struct KeptState {
  fmi2FMUstate state = nullptr;
  Expected expected;
};

class Subject {
 public:
  explicit Subject(Counts& counts) : counts_(counts) {}
  Subject(const Subject&) = delete;
  ~Subject() { free(); }

  bool exists() const { return component_ != nullptr; }
  void instantiate(Bytes& in);
  void free();

  void setup(Bytes& in);
  void enter_initialization();
  void exit_initialization();
  void terminate();
  void reset();
  void get(Bytes& in);
  void set(Bytes& in);
  void set_input(Bytes& in);
  void set_input_derivatives(Bytes& in);
  void get_output_derivatives(Bytes& in);
  void directional_derivative(Bytes& in);
  void step(Bytes& in);
  void never_allowed(Bytes& in);
  void set_debug_logging(Bytes& in);
  void start();  // from wherever it is to the first step

  void keep(KeptState& kept);
  void go_back(const KeptState& kept);
  void refuse(const KeptState& theirs);  // of another instance
  void forget(KeptState& kept);
  std::vector<char> serialize(const KeptState& kept);
  void deserialize(const std::vector<char>& bytes, KeptState& kept, const Expected* original);
  // Steps on twice from a state, and once more from its serialised form: the same bits each time.
  void replay(Bytes& in);

 private:
  struct Log {
    int lines = 0;
    fmi2Status status = fmi2OK;
  };
  static void receive(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...);

  // The instance's whole state, as bytes.
  std::vector<char> snapshot();
  void begin_call();
  fmi2Status judge(const char* function, fmi2Status status, unsigned allowed);
  void set_one(unsigned reference, double x);
  void set_starts();
  void adopt();
  void adopt_time();
  bool step_to(double from, double length);
  std::vector<double> all_values();
  void check_values();
  [[noreturn]] void fault(const char* function, const std::string& what) const;

  Counts& counts_;
  fmi2Component component_ = nullptr;
  fmi2CallbackFunctions callbacks_{};
  Log log_;
  std::string last_message_;
  std::vector<char> before_;  // snapshot before the present call
  Expected expected_;
};

// Bytes of a serialised state with some of them changed; `repair` makes the checksum fit again.
void damage(std::vector<char>& bytes, Bytes& in);

}  // namespace fuzz
