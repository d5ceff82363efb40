#include "snapwing/statics/checkpoint.h"

#include <sstream>

#include "snapwing/common/checkpoint_bytes.h"
#include "snapwing/common/program_code.h"
#include "snapwing/common/provenance.h"

namespace snapwing::statics {

namespace {

const std::string MAGIC = "snapwing checkpoint 5\n";

std::string program() { return common::programOf(&MAGIC); }

using common::BytesReader;
using common::BytesWriter;

void put(BytesWriter& writer, const Eigen::VectorXd& values) { writer.numbers(values.data(), values.size()); }

void put(BytesWriter& writer, const PathResult& run) {
  writer.number(static_cast<double>(run.points.size()));
  for (const PathPoint& p : run.points) {
    for (const double value :
         {p.control, p.energy, p.force, p.stiffness, p.min_det_f, 1.0 * p.stable, 1.0 * p.negative_pivots,
          1.0 * p.iterations, 1.0 * p.factorizations, 1.0 * p.by_arc, 1.0 * p.by_series, 1.0 * p.restart}) {
      writer.number(value);
    }
    put(writer, p.solution);
    put(writer, p.slope);
    put(writer, p.multipliers);
  }
}

Eigen::VectorXd vectorFrom(BytesReader& reader) {
  const std::vector<double> values = reader.numbers();
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

PathResult runFrom(BytesReader& reader) {
  PathResult run;
  const std::size_t points = reader.count();
  for (std::size_t k = 0; k < points; ++k) {
    PathPoint p;
    for (double* value : {&p.control, &p.energy, &p.force, &p.stiffness, &p.min_det_f}) *value = reader.number();
    p.stable = reader.integer() != 0;
    p.negative_pivots = reader.integer();
    run.iterations += p.iterations = reader.integer();
    run.factorizations += p.factorizations = reader.integer();
    p.by_arc = reader.integer() != 0;
    p.by_series = reader.integer() != 0;
    p.restart = reader.integer() != 0;
    p.solution = vectorFrom(reader);
    p.slope = vectorFrom(reader);
    p.multipliers = vectorFrom(reader);
    run.points.push_back(std::move(p));
  }
  return run;
}

}  // namespace

std::string traceHash(const scene::Scene& scene, const std::string& more) {
  std::ostringstream text;
  text.precision(17);
  text << scene.sha256 << ";" << scene.dimension << ";" << static_cast<int>(scene.plane) << ";"
       << static_cast<int>(scene.kernel) << ";" << scene.cell_size << ";" << scene.particles << ";" << scene.to << ";"
       << scene.steps << ";" << scene.back << ";" << solver::enforcementName(scene.enforcement) << ";"
       << scene.perturbation << ";" << more;
  for (const scene::SceneBody& body : scene.bodies) {
    for (const double value : body.density.value) text << ";" << value;
  }
  return common::sha256(text.str());
}

void saveCheckpoint(const SceneCurve& sofar, const std::string& hash, const std::string& path) {
  BytesWriter writer;
  put(writer, sofar.path);
  put(writer, sofar.back);
  common::saveCheckpointBytes(writer.bytes(), MAGIC, program(), hash, path);
}

SceneCurve loadCheckpoint(const std::string& path, const std::string& hash) {
  BytesReader reader(common::loadCheckpointBytes(path, MAGIC, program(), hash, "another scene or to other settings"),
                     path);
  SceneCurve curve;
  curve.path = runFrom(reader);
  curve.back = runFrom(reader);
  return curve;
}

}  // namespace snapwing::statics
