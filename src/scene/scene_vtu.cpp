#include "scene_vtu.h"

#include <Eigen/LU>
#include <map>
#include <sstream>
#include <vector>

namespace snapwing::scene {

using mpm::Vector;

template <int D>
std::string vtuText(const mpm::Discretisation<D>& solid, const Eigen::VectorXd& u, const std::vector<Frame>& frames) {
  std::map<std::vector<int>, int> number;
  std::ostringstream points, moved, connect, offsets, types, density, det;
  const int order2[] = {0, 1, 3, 2}, order3[] = {0, 1, 3, 2, 4, 5, 7, 6};
  for (int c = 0; c < solid.cellCount(); ++c) {
    const mpm::Grid<D>& grid = solid.grid(solid.cellBody(c));
    for (int k = 0; k < (1 << D); ++k) {
      const int corner = D == 2 ? order2[k] : order3[k];
      std::vector<int> key = {solid.cellBody(c)};
      Vector<D> x = grid.origin, local;
      for (int a = 0; a < D; ++a) {
        const int i = solid.cellAt(c)[a] + (corner >> a & 1);
        key.push_back(i);
        x(a) += grid.cell_size * i;
        local(a) = corner >> a & 1;
      }
      const auto [entry, fresh] = number.emplace(key, static_cast<int>(number.size()));
      connect << entry->second << " ";
      if (!fresh) continue;
      Eigen::VectorXd value;
      Eigen::Matrix<double, D, Eigen::Dynamic> slope;
      grid.weights(local, value, slope);
      Vector<D> d = Vector<D>::Zero();
      for (int a = 0; a < solid.stencil(); ++a) d += value(a) * u.template segment<D>(D * solid.cellNodes(c)[a]);
      Point3 place = Point3::Zero(), way = Point3::Zero();
      place.head<D>() = x;
      way.head<D>() = d;
      const Frame& frame = frames[solid.cellBody(c)];
      place = frame.toWorld(place);
      if (frame.moved()) way = (frame.rotation * way).eval();
      points << place(0) << " " << place(1) << " " << place(2) << "\n";
      moved << way(0) << " " << way(1) << " " << way(2) << "\n";
    }
    offsets << (c + 1) * (1 << D) << " ";
    types << (D == 2 ? 9 : 12) << " ";
    density << solid.cell(c).density << " ";
    det << solid.deformationGradient(c, u).determinant() << " ";
  }
  std::ostringstream text;
  const auto array = [&](const char* type, const char* name, int components, const std::string& values) {
    text << "<DataArray type=\"" << type << "\" Name=\"" << name << "\" NumberOfComponents=\"" << components
         << "\" format=\"ascii\">\n"
         << values << "\n</DataArray>\n";
  };
  text << "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
       << "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" << number.size() << "\" NumberOfCells=\"" << solid.cellCount()
       << "\">\n<PointData Vectors=\"displacement_m\">\n";
  array("Float64", "displacement_m", 3, moved.str());
  text << "</PointData>\n<CellData>\n";
  array("Float64", "density", 1, density.str());
  array("Float64", "det_f", 1, det.str());
  text << "</CellData>\n<Points>\n";
  array("Float64", "rest_position_m", 3, points.str());
  text << "</Points>\n<Cells>\n";
  array("Int32", "connectivity", 1, connect.str());
  array("Int32", "offsets", 1, offsets.str());
  array("UInt8", "types", 1, types.str());
  text << "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  return text.str();
}

template std::string vtuText<2>(const mpm::Discretisation<2>&, const Eigen::VectorXd&, const std::vector<Frame>&);
template std::string vtuText<3>(const mpm::Discretisation<3>&, const Eigen::VectorXd&, const std::vector<Frame>&);

}  // namespace snapwing::scene
