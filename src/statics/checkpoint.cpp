#include "snapwing/statics/checkpoint.h"

#include <cstdint>
#include <cstring>
#include <sstream>

#include "snapwing/common/error.h"
#include "snapwing/common/provenance.h"

namespace snapwing::statics {

namespace {

const std::string MAGIC = "snapwing checkpoint 2\n";

class Writer {
 public:
  void number(double value) { bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value)); }
  void vector(const Eigen::VectorXd& values) {
    number(static_cast<double>(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), sizeof(double) * values.size());
  }
  void run(const PathResult& run) {
    number(static_cast<double>(run.points.size()));
    for (const PathPoint& p : run.points) {
      for (const double value :
           {p.control, p.energy, p.force, p.stiffness, p.min_det_f, 1.0 * p.stable, 1.0 * p.negative_pivots,
            1.0 * p.iterations, 1.0 * p.factorizations, 1.0 * p.by_arc, 1.0 * p.anchor}) {
        number(value);
      }
      vector(p.solution);
      vector(p.slope);
      vector(p.multipliers);
    }
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class Reader {
 public:
  Reader(const std::string& bytes, const std::string& path) : bytes_(bytes), path_(path) {}
  double number() {
    double value = 0;
    take(&value, sizeof(value));
    return value;
  }
  int integer() { return static_cast<int>(number()); }
  Eigen::VectorXd vector() {
    Eigen::VectorXd values(count());
    take(values.data(), sizeof(double) * values.size());
    return values;
  }
  PathResult run() {
    PathResult run;
    const std::size_t points = count();
    for (std::size_t k = 0; k < points; ++k) {
      PathPoint p;
      for (double* value : {&p.control, &p.energy, &p.force, &p.stiffness, &p.min_det_f}) *value = number();
      p.stable = integer() != 0;
      p.negative_pivots = integer();
      run.iterations += p.iterations = integer();
      run.factorizations += p.factorizations = integer();
      p.by_arc = integer() != 0;
      p.anchor = integer() != 0;
      p.solution = vector();
      p.slope = vector();
      p.multipliers = vector();
      run.points.push_back(std::move(p));
    }
    return run;
  }

 private:
  std::size_t count() {
    const double value = number();
    if (!(value >= 0 && value <= static_cast<double>(bytes_.size()))) damaged();
    return static_cast<std::size_t>(value);
  }
  void take(void* to, std::size_t size) {
    if (at_ + size > bytes_.size()) damaged();
    if (size > 0) std::memcpy(to, bytes_.data() + at_, size);
    at_ += size;
  }
  [[noreturn]] void damaged() const { throw common::FileError(path_, "the checkpoint is damaged"); }

  const std::string& bytes_;
  const std::string& path_;
  std::size_t at_ = 0;
};

}  // namespace

std::string traceHash(const scene::Scene& scene, const std::string& more) {
  std::ostringstream text;
  text.precision(17);
  text << common::version() << ";" << scene.sha256 << ";" << scene.dimension << ";" << static_cast<int>(scene.plane)
       << ";" << static_cast<int>(scene.kernel) << ";" << scene.cell_size << ";" << scene.particles << ";" << scene.to
       << ";" << scene.steps << ";" << scene.back << ";" << solver::driveName(scene.drive) << ";" << scene.perturbation
       << ";" << more;
  for (const scene::SceneBody& body : scene.bodies) {
    for (const double value : body.density.value) text << ";" << value;
  }
  return common::sha256(text.str());
}

void saveCheckpoint(const SceneCurve& sofar, const std::string& hash, const std::string& path) {
  Writer writer;
  writer.run(sofar.path);
  writer.run(sofar.back);
  common::writeFileAtomically(path, MAGIC + hash + common::sha256(writer.bytes()) + writer.bytes());
}

SceneCurve loadCheckpoint(const std::string& path, const std::string& hash) {
  constexpr std::size_t DIGITS = 64;
  const std::string file = common::readFile(path);
  if (file.size() < MAGIC.size() + 2 * DIGITS || file.compare(0, MAGIC.size(), MAGIC) != 0)
    throw common::FileError(path, "no checkpoint of this version");
  if (file.compare(MAGIC.size(), DIGITS, hash) != 0)
    throw common::FileError(path,
                            "the checkpoint belongs to another scene or to other settings; remove it to start anew");
  const std::string bytes = file.substr(MAGIC.size() + 2 * DIGITS);
  if (file.compare(MAGIC.size() + DIGITS, DIGITS, common::sha256(bytes)) != 0)
    throw common::FileError(path, "the checkpoint is damaged");
  Reader reader(bytes, path);
  SceneCurve curve;
  curve.path = reader.run();
  curve.back = reader.run();
  return curve;
}

}  // namespace snapwing::statics
