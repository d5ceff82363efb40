#pragma once
/// Shared parts of reading scene files (internal to the layer).

#include <map>
#include <string>
#include <vector>

#include "snapwing/common/plain_text.h"
#include "snapwing/common/settings_reader.h"
#include "snapwing/scene/scene.h"

namespace snapwing::scene {

using common::SettingsReader;

constexpr double HUGE_LENGTH = 1e6;  // in the file's unit

/// Reads lengths in the file's unit.
struct Reading {
  double unit = 1;  ///< [m]
  std::string unit_name;
  std::map<std::string, int> bodies;
  int dimension = 2;

  double length(SettingsReader& r, const std::string& key, double low = -HUGE_LENGTH) const {
    return unit * r.number(key, {low, HUGE_LENGTH}, unit_name);
  }
  double positive(SettingsReader& r, const std::string& key) const {
    const double value = length(r, key, 0);
    if (!(value > 0)) r.fail(key, "0", "> 0 " + unit_name);
    return value;
  }
  Point3 point(SettingsReader& r, const std::string& key, int count) const {
    Point3 p = Point3::Zero();
    const std::vector<double> values = r.numbers(key, count, {-HUGE_LENGTH, HUGE_LENGTH}, unit_name);
    for (int a = 0; a < count; ++a) p(a) = unit * values[a];
    return p;
  }
  Point3 vector(SettingsReader& r, const std::string& key, const std::string& what) const {
    Point3 p = Point3::Zero();
    const std::vector<double> values = r.numbers(key, dimension, {-1e12, 1e12}, what);
    for (int a = 0; a < dimension; ++a) p(a) = values[a];
    return p;
  }
  Point3 direction(SettingsReader& r) const {
    const Point3 p = vector(r, "direction", "1");
    if (!(p.norm() > 0)) r.fail("direction", "zero", "a direction");
    return p.normalized();
  }
  Box box(SettingsReader& r, const std::string& key, int axes = 3) const {
    SettingsReader m = r.map(key);
    Box result;
    const char* names[] = {"x", "y", "z"};
    for (int a = 0; a < axes; ++a) {
      if (!m.has(names[a])) continue;
      const std::vector<double> ends = m.numbers(names[a], 2, {-HUGE_LENGTH, HUGE_LENGTH}, unit_name);
      if (ends[1] < ends[0])
        m.fail(names[a], "[" + common::toText(ends[0]) + ", " + common::toText(ends[1]) + "]", "[low, high]");
      result.low(a) = unit * ends[0];
      result.high(a) = unit * ends[1];
    }
    m.finish();
    return result;
  }
  int body(SettingsReader& r, const std::string& key = "body") const {
    if (bodies.size() == 1 && !r.has(key)) return 0;
    const std::string name = r.text(key);
    const auto found = bodies.find(name);
    if (found == bodies.end()) r.fail(key, "'" + name + "'", "the name of a body");
    return found->second;
  }
};

/// @param before  the bodies above it
SceneBody readBody(SettingsReader& r, const std::string& name, const Reading& in, const std::vector<SceneBody>& before);

}  // namespace snapwing::scene
