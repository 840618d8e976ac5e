#include "line_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace zspring::catenary {
namespace {

constexpr double least_distance = 0.001;  // m, of places that are not the same
constexpr double most_supports = 401, most_droppers_of_line = 8000, most_masses = 8000, most_profile = 100000;

// Takes numbers off the front of the bytes.
struct Bytes {
  const char* at;
  std::size_t left;

  void take(void* to, std::size_t n) {
    if (n > left) refuse("line.table: ends before all its values are there");
    std::memcpy(to, at, n);
    at += n, left -= n;
  }
  double number() {
    unsigned char bytes[sizeof(double)];
    take(bytes, sizeof bytes);
    std::uint64_t bits = 0;
    for (int i = 7; i >= 0; --i) bits = bits << 8 | bytes[i];
    double x;
    std::memcpy(&x, &bits, sizeof x);
    if (!std::isfinite(x)) refuse("line.table: holds a value that is not finite");
    return x;
  }
  // A list of structs that hold nothing but doubles.
  template <class Entry>
  void list(const char* of, double most, std::vector<Entry>& entries) {
    const double count = number();
    if (!(count >= 0 && count <= most && count == std::floor(count)))
      refuse("line.table: %.10g %s: must be a whole number up to %.0f", count, of, most);
    if (count * sizeof(Entry) > static_cast<double>(left)) refuse("line.table: ends before all its values are there");
    entries.resize(static_cast<std::size_t>(count));
    for (Entry& entry : entries) {
      double values[sizeof(Entry) / sizeof(double)];
      for (double& value : values) value = number();
      std::memcpy(&entry, values, sizeof entry);
    }
  }
};

bool apart(double a, double b) { return a == b || std::abs(a - b) >= least_distance; }

}  // namespace

bool LineTable::replaces(const char* parameter) {
  for (const char* group : {"line.", "dropper.", "support.", "steady_arm."})
    if (std::strncmp(parameter, group, std::strlen(group)) == 0) return true;
  return false;
}

LineTable LineTable::of(const char* bytes, std::size_t size) {
  Bytes in{bytes, size};
  char found[sizeof magic - 1];
  if (size < sizeof found || (in.take(found, sizeof found), std::memcmp(found, magic, sizeof found) != 0))
    refuse("line.table: is no table of a line, which begins with %s", magic);
  LineTable t;
  in.list("supports", most_supports, t.supports);
  t.contact_begin = in.number();
  t.contact_end = in.number();
  in.list("droppers", most_droppers_of_line, t.droppers);
  in.list("stitch wires", most_supports, t.stitches);
  in.list("point masses", most_masses, t.masses);
  in.list("points of the profile", most_profile, t.profile);
  if (in.left > 0) refuse("line.table: goes on after its last value");
  t.check();
  return t;
}

LineTable LineTable::of(const Parameters& p) {
  double last = 0;
  for (int i = 0; i < p.dropper.count; ++i) {
    const double x = p.dropper.position[i];
    const double low = last + least_distance, high = p.line.span - least_distance;
    if (x < low || x > high)
      refuse(
          "dropper.position[%d] = %.10g m: must be at least %.10g m and at most %.10g m, after the dropper before "
          "it "
          "and within line.span = %.10g m",
          i + 1, x, low, high, p.line.span);
    last = x;
  }
  LineTable t;
  t.of_parameters_ = true;
  const auto support = [&](int i) {
    const bool held = i > 0 && i < p.line.spans;  // the others are the anchors
    t.supports.push_back({i * p.line.span, p.line.encumbrance, held ? p.support.stiffness : 0,
                          held ? p.steady_arm.mass : 0, held ? p.steady_arm.stiffness : 0});
  };
  support(0);
  for (int span = 0; span < p.line.spans; ++span) {
    for (int i = 0; i < p.dropper.count; ++i)
      t.droppers.push_back({span * p.line.span + p.dropper.position[i], 0, -p.dropper.sag[i], p.dropper.stiffness,
                            p.dropper.EA, p.dropper.mass, p.dropper.clamp_contact, p.dropper.clamp_messenger, 0, 0});
    support(span + 1);
  }
  return t;
}

Text LineTable::place(double x) const {
  const auto after = std::find_if(supports.begin(), supports.end() - 1, [&](const Support& s) { return s.x > x; });
  return text("span %d, at %.10g m", std::max(1, static_cast<int>(after - supports.begin())), x);
}

Text LineTable::described(const Dropper& dropper) const {
  const auto j = static_cast<int>(&dropper - droppers.data());
  int span = 0, before = 0;  // supports and droppers before it
  while (supports[span + 1].x <= dropper.x) ++span;
  while (droppers[before].x < supports[span].x) ++before;
  const int i = j - before + 1;
  if (of_parameters_)
    return text("dropper.position[%d] = %.10g m, dropper.sag[%d] = %.10g m", i, droppers[i - 1].x, i, -dropper.height);
  return text("span %d, dropper %d, at %.10g m", span + 1, i, dropper.x);
}

Irregularity LineTable::irregularity(double x) const {
  if (profile.empty() || x < profile.front().x || x > profile.back().x) return {};
  const auto after = std::upper_bound(profile.begin() + 1, profile.end() - 1, x,
                                      [](double place, const ProfilePoint& point) { return place < point.x; });
  const ProfilePoint &a = after[-1], &b = after[0];
  const double l = b.x - a.x, s = (x - a.x) / l, r = 1 - s;
  return {r * r * (1 + 2 * s) * a.height + l * s * r * r * a.slope + s * s * (1 + 2 * r) * b.height -
              l * s * s * r * b.slope,
          6 * s * r * (b.height - a.height) / l + r * (1 - 3 * s) * a.slope + s * (1 - 3 * r) * b.slope,
          (6 * (r - s) * (b.height - a.height) / l + (6 * s - 4) * a.slope + (6 * s - 2) * b.slope) / l};
}

void LineTable::check() const {
  const auto at_least = [&](double x, const char* what, double value, const char* unit, double least) {
    if (!(value >= least))
      refuse("%s: %s = %.10g %s: must be at least %g %s", place(x).chars, what, value, unit, least, unit);
  };
  if (supports.size() < 2) refuse("line.table: %zu supports: must be at least 2, the anchors", supports.size());
  if (supports[0].x != 0) refuse("line.table: begins at %.10g m: must begin at 0", supports[0].x);
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const Support& s = supports[i];
    if (i > 0) at_least(supports[i - 1].x, "length of the span", s.x - supports[i - 1].x, "m", 1);
    at_least(s.x, "stiffness of the support", s.stiffness, "N/m", 0);
    at_least(s.x, "mass of the steady arm", s.arm_mass, "kg", 0);
    at_least(s.x, "stiffness of the steady arm", s.arm_stiffness, "N/m", 0);
  }
  double last = 0;
  for (const Dropper& d : droppers) {
    const bool near_support = std::any_of(supports.begin(), supports.end(),
                                          [&](const Support& s) { return std::abs(s.x - d.x) < least_distance; });
    if (d.x < last + least_distance || d.x > length() - least_distance || near_support)
      refuse("%s: a dropper must be after the one before it, between two supports and %g m from all of these",
             place(d.x).chars, least_distance);
    at_least(d.x, "EA of the dropper", d.EA, "N", 0);
    at_least(d.x, "stiffness of the dropper", d.EA > 0 ? 1 : d.stiffness, "N/m", 1e-3);
    at_least(d.x, "mass of the dropper", d.mass, "kg/m", 0);
    at_least(d.x, "clamp on the contact wire", d.clamp_contact, "kg", 0);
    at_least(d.x, "upper clamp of the dropper", d.clamp_upper, "kg", 0);
    at_least(d.x, "length of the dropper", d.length, "m", 0);
    const bool within = std::any_of(stitches.begin(), stitches.end(),
                                    [&](const StitchWire& s) { return d.x > s.begin && d.x < s.end; });
    if (d.on_stitch != 0 && d.on_stitch != 1)
      refuse("%s: upper end of the dropper = %.10g: must be 0, the messenger, or 1, a stitch wire", place(d.x).chars,
             d.on_stitch);
    if (within != (d.on_stitch == 1))
      refuse("%s: a dropper %s", place(d.x).chars,
             within ? "on the messenger would cross the stitch wire there: it must hang on that"
                    : "on a stitch wire, where there is none");
    last = d.x;
  }
  last = 0;
  for (const StitchWire& s : stitches) {
    if (s.begin < last + least_distance || s.end < s.begin + 0.1 || s.end > length() - least_distance)
      refuse(
          "%s: a stitch wire from %.10g m to %.10g m: must be within the line, after the one before it, and 0.1 m long",
          place(s.begin).chars, s.begin, s.end);
    at_least(s.begin, "tension of the stitch wire", s.tension, "N", 1);
    at_least(s.begin, "mass of the stitch wire", s.mass, "kg/m", 0.01);
    at_least(s.begin, "clamp of the stitch wire", s.clamp, "kg", 0);
    last = s.end;
  }
  for (const PointMass& m : masses) {
    if (m.x < least_distance || m.x > length() - least_distance)
      refuse("%s: a point mass must be between the anchors, within %.10g m", place(m.x).chars, length());
    if (m.wire != Contact && m.wire != Messenger)
      refuse("%s: wire of the point mass = %.10g: must be 0, the contact wire, or 1, the messenger", place(m.x).chars,
             m.wire);
    at_least(m.x, "point mass", m.mass, "kg", 0);
  }
  for (std::size_t i = 1; i < profile.size(); ++i)
    if (!(profile[i].x > profile[i - 1].x))
      refuse("%s: points of the profile must be in the order of their places", place(profile[i].x).chars);
  if (profile.size() == 1) refuse("line.table: 1 point of the profile: must be none, or 2 at least");
  std::vector<double> places;
  for (const Support& s : supports) places.push_back(s.x);
  for (const Dropper& d : droppers) places.push_back(d.x);
  for (const StitchWire& s : stitches) places.insert(places.end(), {s.begin, s.end});
  for (const PointMass& m : masses) places.push_back(m.x);
  std::sort(places.begin(), places.end());
  for (std::size_t i = 1; i < places.size(); ++i)
    if (!apart(places[i - 1], places[i]))
      refuse("%s: two places on the line %.3g m apart: must be the same, or at least %g m apart",
             place(places[i]).chars, places[i] - places[i - 1], least_distance);
}

}  // namespace zspring::catenary
