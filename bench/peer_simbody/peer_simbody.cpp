// Ring, centre and both wings' linkages in Simbody: what `snapwing trial` computes with `wings_follow: travel`, by
// another code. Reads the plain numbers that `run` writes, prints one row every millisecond:
//   time, travel, ring's place, left wing's angle, right wing's angle.
//
// The arms are their force curve as a custom force. Their inertia K(u), S(u) is a body that slides by h(u), h' = S/m,
// and a wheel that turns by w(u), w'^2 = (K - S^2/m)/J, both coupled to the travel. A crank's angle is coupled to it as
// well; the linkage is closed by a constraint of Simbody's own.
#include <Simbody.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <vector>

using namespace SimTK;

namespace {

constexpr double FRICTION_RATE = 0.6;  // [rad/s] as in motion/wing_assembly.cpp
constexpr double WHEEL = 0.01;         // J [kg m2], any

struct Input {
  std::map<std::string, std::vector<double>> values;
  double operator[](const std::string& name) const { return values.at(name).at(0); }
  const std::vector<double>& list(const std::string& name) const { return values.at(name); }
  Vec3 point(const std::string& name) const { return {values.at(name).at(0), values.at(name).at(1), 0}; }
};

/// Lines: name count values...
Input readInput(const char* path) {
  std::ifstream file(path);
  Input in;
  std::string name;
  for (std::size_t count = 0; file >> name >> count;) {
    std::vector<double>& values = in.values[name];
    values.resize(count);
    for (double& value : values) file >> value;
  }
  return in;
}

Spline splineOf(const std::vector<double>& x, const std::vector<double>& y) {
  Vector a(static_cast<int>(x.size())), b(static_cast<int>(x.size()));
  for (int k = 0; k < a.size(); ++k) a[k] = x[k], b[k] = y[k];
  return SplineFitter<Real>::fitForSmoothingParameter(5, a, b, 0).getSpline();
}

/// f(u) - q = 0 between two coordinates.
class Follows : public Function {
 public:
  explicit Follows(Spline curve) : curve_(std::move(curve)) {}
  Real calcValue(const Vector& x) const override { return curve_.calcValue(Vector(1, x[0])) - x[1]; }
  Real calcDerivative(const Array_<int>& by, const Vector& x) const override {
    for (const int k : by) {
      if (k == 1) return by.size() == 1 ? -1 : 0;
    }
    return curve_.calcDerivative(Array_<int>(by.size(), 0), Vector(1, x[0]));
  }
  int getArgumentSize() const override { return 2; }
  int getMaxDerivativeOrder() const override { return 2; }

 private:
  Spline curve_;
};

struct Wing {
  MobilizedBody::Pin crank, wing, rocker;
  double friction = 0;
};

/// First-order lag of a rectangular pulse.
double thrustAt(const Input& in, double t) {
  const double idle = in["initial_thrust"], high = in["pulse_thrust"], last = in["final_thrust"];
  const double begin = in["latency"], end = begin + in["duration"];
  const auto lagged = [&](double from, double to, double time) {
    return to + (from - to) * std::exp(-time / (to > from ? in["time_constant_up"] : in["time_constant_down"]));
  };
  if (t <= begin) return idle;
  if (t <= end) return lagged(idle, high, t - begin);
  return lagged(lagged(idle, high, end - begin), last, t - end);
}

class Forces : public Force::Custom::Implementation {
 public:
  Forces(const Input& in, MobilizedBody::Slider ring, MobilizedBody::Slider travel, std::array<Wing, 2> wings,
         Spline force)
      : in_(in), ring_(ring), travel_(travel), wings_(std::move(wings)), force_(std::move(force)) {}
  void calcForce(const State& s, Vector_<SpatialVec>& bodies, Vector_<Vec3>&, Vector& mobility) const override {
    const double v = ring_.getOneU(s, 0), rate = travel_.getOneU(s, 0), centre = v - rate;
    const double drag = in_["centre_drag"] * std::abs(centre) * centre;
    const double arms = force_.calcValue(Vector(1, travel_.getOneQ(s, 0))) + in_["damping_of_travel"] * rate;
    ring_.applyOneMobilityForce(s, 0, thrustAt(in_, s.getTime()) - in_["ring_drag"] * std::abs(v) * v - drag, mobility);
    travel_.applyOneMobilityForce(s, 0, drag - arms, mobility);
    for (const Wing& w : wings_) {
      rub(s, w.crank, w.friction, mobility);
      rub(s, w.wing, w.friction, mobility);
      rub(s, w.rocker, w.friction, mobility);
      const double between = w.wing.getBodyAngularVelocity(s)[2] - w.rocker.getBodyAngularVelocity(s)[2];
      const Vec3 moment(0, 0, -w.friction * between / std::hypot(between, FRICTION_RATE));
      w.wing.applyBodyTorque(s, moment, bodies);
      w.rocker.applyBodyTorque(s, -moment, bodies);
    }
  }
  Real calcPotentialEnergy(const State&) const override { return 0; }

 private:
  static void rub(const State& s, const MobilizedBody::Pin& pin, double moment, Vector& mobility) {
    const double w = pin.getOneU(s, 0);
    pin.applyOneMobilityForce(s, 0, -moment * w / std::hypot(w, FRICTION_RATE), mobility);
  }
  const Input& in_;
  MobilizedBody::Slider ring_, travel_;
  std::array<Wing, 2> wings_;
  Spline force_;
};

/// A plane body from its moments about the axle, its frame's origin at `at`.
Body::Rigid bodyOf(const Input& in, const std::string& name, const Vec3& at) {
  const double mass = in[name + "_mass"], second = in[name + "_second"];
  const Vec3 first = in.point(name + "_first"), centre = first / mass - at;
  // Only the moment about z counts: all turn in the plane.
  const double own = second - dot(first, first) / mass;
  return Body::Rigid(MassProperties(mass, centre, Inertia(own / 2, own / 2, own) + Inertia(centre, mass)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: peer_simbody INPUT\n");
    return 2;
  }
  const Input in = readInput(argv[1]);
  const std::vector<double>& u = in.list("travel");
  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  const Rotation up(Pi / 2, ZAxis), down(-Pi / 2, ZAxis);  // sliders move along x of their frames
  const Body::Rigid ring_body(MassProperties(in["ring_mass"], Vec3(0), Inertia(1e-3)));
  MobilizedBody::Slider ring(matter.Ground(), Transform(up), ring_body, Transform(up));
  const Body::Rigid centre_body(MassProperties(in["centre_mass"], Vec3(0), Inertia(1e-3)));
  MobilizedBody::Slider travel(ring, Transform(down), centre_body, Transform(down));

  const auto couple = [&](const MobilizedBody& follower, const std::vector<double>& values) {
    Constraint::CoordinateCoupler(
        matter, new Follows(splineOf(u, values)),
        Array_<MobilizedBodyIndex>{travel.getMobilizedBodyIndex(), follower.getMobilizedBodyIndex()},
        Array_<MobilizerQIndex>{MobilizerQIndex(0), MobilizerQIndex(0)});
  };
  MobilizedBody::Slider arms(ring, Transform(up), Body::Rigid(MassProperties(in["arms_mass"], Vec3(0), Inertia(1e-3))),
                             Transform(up));
  couple(arms, in.list("arms_height"));
  MobilizedBody::Pin wheel(matter.Ground(), Transform(), Body::Rigid(MassProperties(1, Vec3(0), Inertia(WHEEL))),
                           Transform());
  couple(wheel, in.list("wheel"));

  std::array<Wing, 2> wings;
  for (int side = 0; side < 2; ++side) {
    const Vec3 a = in.point("joint1"), x = in.point("joint2"), b = in.point("auxiliary");
    Wing& w = wings[side];
    w.crank = MobilizedBody::Pin(ring, Transform(), bodyOf(in, "crank", Vec3(0)), Transform());
    w.wing = MobilizedBody::Pin(w.crank, Transform(a), bodyOf(in, "wing", a), Transform());
    w.rocker = MobilizedBody::Pin(ring, Transform(b), bodyOf(in, "rocker", b), Transform());
    Constraint::PointOnLine(w.wing, UnitVec3(0, 0, 1), x - a, w.rocker, x - b);
    couple(w.crank, in.list("rotation"));
    w.friction = in[side == 0 ? "friction_left" : "friction_right"];
  }
  Force::Custom(forces, new Forces(in, ring, travel, wings, splineOf(u, in.list("force"))));

  State state = system.realizeTopology();
  const double start = in["start_travel"];
  travel.setOneQ(state, 0, start);
  for (const Wing& w : wings) {
    w.crank.setOneQ(state, 0, in["start_rotation"]);
    w.wing.setOneQ(state, 0, in["start_wing"] - in["start_rotation"]);
    w.rocker.setOneQ(state, 0, in["start_rocker"]);
  }
  arms.setOneQ(state, 0, in["start_arms"]);
  wheel.setOneQ(state, 0, in["start_wheel"]);
  system.realizeModel(state);
  system.project(state, 1e-10);

  RungeKuttaMersonIntegrator integrator(system);
  integrator.setAccuracy(1e-7);
  integrator.setConstraintTolerance(1e-9);
  TimeStepper stepper(system, integrator);
  stepper.initialize(state);
  for (int k = 0; k * 1e-3 <= in["end"] + 1e-12; ++k) {
    stepper.stepTo(k * 1e-3);
    const State& s = integrator.getState();
    const auto angle = [&](const Wing& w) { return w.crank.getOneQ(s, 0) + w.wing.getOneQ(s, 0); };
    std::printf("%.6f,%.9f,%.9f,%.9f,%.9f\n", s.getTime(), travel.getOneQ(s, 0), ring.getOneQ(s, 0), angle(wings[0]),
                angle(wings[1]));
  }
  return 0;
}
